"""`giraff map make`: a floor plan by driving round."""

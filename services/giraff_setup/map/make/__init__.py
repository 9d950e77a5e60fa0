"""`giraff map make`: a floor plan, by driving the robot round with its laser scanner."""

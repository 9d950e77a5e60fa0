"""`giraff map`: floor plans."""

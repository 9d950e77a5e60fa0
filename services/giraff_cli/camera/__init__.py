"""`giraff camera`: list, view, board."""

"""`giraff camera`: list, view."""

"""`giraff node`: list, info."""

"""`giraff frames`: the tree of coordinate frames."""

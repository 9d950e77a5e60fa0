"""`giraff keys`: the certificates of a secured network."""

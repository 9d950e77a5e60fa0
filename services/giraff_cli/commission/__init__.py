"""`giraff commission`: what a new robot needs before it drives, in order, and what is left of it."""

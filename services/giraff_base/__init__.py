"""Motors and encoders of a Giraff, through its base board."""

"""Floor plans: drawn in a terminal, and written in another format."""

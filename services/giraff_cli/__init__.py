"""The `giraff` command: what a person types."""

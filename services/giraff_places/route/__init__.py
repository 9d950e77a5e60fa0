"""A way over the floor plan, as straight legs. Pure."""

"""Certificates of the machines of a secured robot."""

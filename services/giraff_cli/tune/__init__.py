"""Finds gains of a robot from its physics."""

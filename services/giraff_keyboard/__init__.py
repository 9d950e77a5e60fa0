"""Operator's laptop: keys pressed in a terminal become a wish to drive."""

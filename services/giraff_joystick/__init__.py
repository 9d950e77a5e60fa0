"""Operator's laptop: the tilt of an accelerometer in the hand becomes a wish to drive."""

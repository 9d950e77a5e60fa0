"""Wheels of a robot: how they are wired, how far they roll, and the gains that hold their speeds."""

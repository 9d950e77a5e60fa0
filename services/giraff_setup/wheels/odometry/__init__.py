"""Scales of wheels and track, from lines, turns and squares that a person drives and measures."""

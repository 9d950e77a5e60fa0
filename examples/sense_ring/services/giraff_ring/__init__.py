"""Reads a ring of infrared distance sensors."""

"""Reads a laser scanner."""

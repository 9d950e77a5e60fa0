"""Gains by which a board holds the speeds of two wheels."""

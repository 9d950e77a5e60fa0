"""What wheels do to a robot: its drive, and where it is."""

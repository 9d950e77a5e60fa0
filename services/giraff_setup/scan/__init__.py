"""Measures where a laser scanner sits on the robot, and which of its rays the robot's own parts hide."""

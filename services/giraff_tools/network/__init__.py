"""Find a robot, listen to it, count its samples."""

"""What a camera of the robot sees, for those who have asked for it."""

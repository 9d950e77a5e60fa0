"""The world: walls, the robot's body, its sensors, and the hands that drive it."""

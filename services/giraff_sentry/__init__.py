"""Says in the robot's log who was refused on a secured network."""

"""Motion of the robot over the floor, as its camera sees it."""

"""Has the robot go along a route: what is in its way, when it waits, and why it ends."""

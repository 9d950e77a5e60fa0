"""`giraff localize`: where the robot is on a floor plan, live or by a recording."""

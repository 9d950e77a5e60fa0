"""`giraff why`: why the robot does not drive."""

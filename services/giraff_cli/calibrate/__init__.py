"""`giraff calibrate`: what a robot file says of the robot, measured."""

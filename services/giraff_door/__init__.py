"""The process of the robot that other hosts find; it has nothing to do but to be there."""

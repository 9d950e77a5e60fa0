"""The latest state of a robot, in words and in panels. It draws with rich."""

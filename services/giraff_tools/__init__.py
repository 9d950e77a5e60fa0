"""Shared by commands: what a terminal shows and reads, the network of a robot, its robot file."""

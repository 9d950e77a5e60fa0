"""Faults by kind: of machines, of the network, of the robot."""

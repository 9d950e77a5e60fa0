"""Deterministic simulation: the whole command path with faults, in one process and simulated time, from one seed."""

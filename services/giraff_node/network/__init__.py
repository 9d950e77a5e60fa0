"""Zenoh: open a session, find a robot, ask, keep links alive."""

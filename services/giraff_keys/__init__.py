"""Certificates of hosts, and their keys on disk: for who has the library `cryptography`, which the robot has not."""

"""What every process agrees on: the robot, freshness, lease, emergency stop, parameters.

Pure: no Zenoh, thread, clock or file.
"""

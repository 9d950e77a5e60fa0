"""Patrol: drive round a square of one metre. Usage: python patrol.py [ROUNDS]"""

import sys

from giraff_client import MotionBlockedError, Robot

with Robot() as robot:
    start = robot.odom()
    corners = [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)] * int([*sys.argv, "1"][1])
    while corners:
        x, y = corners[0]
        try:
            robot.go_to(start.x + x, start.y + y)
        except MotionBlockedError as blocked:  # somebody stands there, and will have passed
            print(blocked, flush=True)
            continue
        corners.pop(0)
        print(f"at {x:g}, {y:g}; the guard says: {robot.guard().reason or 'go on'}", flush=True)

"""Patrol: drive round a square of one metre. Usage: python patrol.py [ROUNDS]"""

import math
import sys

from giraff_client import Robot


def go_to(robot: Robot, x: float, y: float) -> None:
    while math.hypot(x - (at := robot.odom()).x, y - at.y) > 0.05:
        turn = math.remainder(math.atan2(y - at.y, x - at.x) - at.yaw, math.tau)
        robot.drive(0.3 if abs(turn) < 0.2 else 0.0, max(-0.8, min(0.8, 2.0 * turn)))


with Robot() as robot:
    start = robot.odom()
    for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else 1):
        for x, y in ((1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)):
            go_to(robot, start.x + x, start.y + y)
            print(f"at {x:g}, {y:g}; the guard says: {robot.guard().reason or 'go on'}", flush=True)

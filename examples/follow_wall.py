"""Follow the wall on the left at 0.5 m: look, correct the course, drive on. Usage: python follow_wall.py [STEPS]"""

import math
import sys

from giraff_client import Robot


def turn_to(robot: Robot, yaw: float) -> None:
    while abs(off := math.remainder(yaw - robot.odom().yaw, math.tau)) > 0.03:
        robot.drive(0.0, max(-0.6, min(0.6, 1.5 * off + math.copysign(0.1, off))))
    robot.rest(0.6)  # until each sensor has looked again


with Robot() as robot:
    along = robot.odom().yaw  # the robot starts beside the wall
    for _ in range(int(sys.argv[1]) if len(sys.argv) > 1 else 5):
        turn_to(robot, along + math.pi / 2)
        left, right = (robot.ranges()[f"front_{side}"].range or 0.5 for side in ("left", "right"))
        along -= math.atan2(left - right, 0.3)  # the two sensors are 0.3 m apart
        turn_to(robot, along + math.atan2((left + right) / 2 - 0.5, 0.4))
        path = robot.odom().path
        while robot.odom().path < path + 0.4:
            robot.drive(0.25, 0.0)
        print(f"{(left + right) / 2:.2f} m from the wall", flush=True)

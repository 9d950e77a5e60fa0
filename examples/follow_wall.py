"""Follow the wall on the left at 0.5 m: look, correct the course, drive on. Usage: python follow_wall.py [STEPS]"""

import math
import sys

from giraff_client import Robot

with Robot() as robot:
    along, aside = robot.odom().yaw, 0.0  # the robot starts beside the wall
    for look in [True, False] * int([*sys.argv, "5"][1]):  # at the wall, and then go on
        while abs(off := math.remainder(along + (math.pi / 2 if look else aside) - robot.odom().yaw, math.tau)) > 0.03:
            robot.drive(0.0, max(-0.6, min(0.6, 1.5 * off + math.copysign(0.1, off))))
        robot.rest(0.6)  # until each sensor has looked again
        if look:
            left, right = (robot.ranges()[f"front_{side}"].range or 0.5 for side in ("left", "right"))
            along -= math.atan2(left - right, 0.3)  # the two sensors are 0.3 m apart
            aside = math.atan2((left + right) / 2 - 0.5, 0.4)
            print(f"{(left + right) / 2:.2f} m from the wall", flush=True)
        for _ in range(0 if look else 50):
            robot.drive(0.25, 0.0)

"""Follow the wall on the left at 0.5 m: look, correct the course, drive on. Usage: python follow_wall.py [STEPS]"""

import math
import sys
import time

from giraff_client import Robot

with Robot() as robot:
    robot.turn(math.pi / 2)  # it starts beside the wall, and along it
    for _ in range(int([*sys.argv, "5"][1])):
        time.sleep(0.6)  # until each sensor has looked again
        left, right = (robot.ranges()[f"front_{side}"].range or 0.5 for side in ("left", "right"))
        print(f"{(left + right) / 2:.2f} m from the wall", flush=True)
        slant = math.atan2(left - right, 0.3)  # the two sensors are 0.3 m apart
        aside = math.atan2((left + right) / 2 - 0.5, 0.4)
        robot.turn(aside - slant - math.pi / 2)
        robot.move(0.3)
        robot.turn(math.pi / 2 - aside)

"""Go to a place on the map, once the robot knows where it is. Usage: python go_to_place.py X,Y, in metres"""

import sys
import time

from giraff_client import MotionError, Robot

x, y = map(float, sys.argv[1].split(","))
with Robot() as robot:
    while (pose := robot.map_pose()).state != "localized":
        print(f"{pose.state}: {pose.reason}", flush=True)
        time.sleep(2.0)  # drive it about meanwhile, or say where it is
    print(f"from {pose.x:.2f}, {pose.y:.2f}", flush=True)
    try:
        robot.go_to(x, y, frame="map")
    except MotionError as error:  # blocked, or it is not known any more where it is
        sys.exit(str(error))
    print(f"at {robot.map_pose().x:.2f}, {robot.map_pose().y:.2f}", flush=True)

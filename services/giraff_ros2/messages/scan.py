"""Turns of a laser scanner as ROS messages."""

import math

import numpy as np
from rosbags.typesys.stores.ros2_kilted import sensor_msgs__msg__LaserScan as RosLaserScan

from giraff_core.senses import LaserScanner
from giraff_ros2.messages.header import header, single
from giraff_schemas.scan import NEAREST, NO_ECHO, OWN, RAYS, LaserScan, scan_frame


def laser_scan(sample: LaserScan, scanner: LaserScanner) -> RosLaserScan:
    """Return a turn, counter-clockwise: +inf where nothing answered, NaN where a ray tells nothing of the room.

    REP-117 says so. The stamp is of the middle of the turn: programs of ROS expect rays that go on in time where they
    go on in angle, and this scanner turns clockwise.
    """
    mm = np.frombuffer(sample.ranges, dtype="<u2")
    metres = np.where(mm == NO_ECHO, np.inf, np.where(mm >= OWN, np.nan, mm / 1000.0))
    first = math.remainder(sample.bearing - scanner.yaw, math.tau)
    if sample.step < 0.0:
        metres, first = metres[::-1], first + (RAYS - 1) * sample.step
    step = abs(sample.step)
    return RosLaserScan(
        header(sample.stamp_ns - round(sample.duration * 0.5e9), scan_frame(sample.sensor)),
        angle_min=single(first),
        angle_max=single(first + (RAYS - 1) * step),
        angle_increment=single(step),
        time_increment=0.0,
        scan_time=single(sample.duration),
        range_min=NEAREST / 1000,
        range_max=scanner.reach,
        ranges=metres.astype(np.float32),
        intensities=np.zeros(0, dtype=np.float32),
    )

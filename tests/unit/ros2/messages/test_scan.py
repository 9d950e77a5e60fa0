"""Turns of a laser scanner in ROS: values worked out by hand, read back by a decoder of somebody else."""

import math
from array import array

import pytest

from giraff_core.senses import LaserScanner
from giraff_ros2.messages.scan import laser_scan
from giraff_schemas.scan import NOT_MEASURED, OWN, RAYS, LaserScan, packed
from tests.unit.ros2.messages.test_messages import AT, TICK, decoded

DEGREE = math.radians(1.0)


@pytest.mark.parametrize("upside_down", [False, True])
def test_a_scan_goes_on_counter_clockwise_in_the_scanners_frame(upside_down: bool) -> None:
    rays = array("H", [0] * RAYS)
    rays[100], rays[101], rays[102] = 1500, OWN | 140, NOT_MEASURED  # 80 degrees and on, clockwise unless upside down
    sample = LaserScan(
        stamp_ns=AT,
        sensor="laser",
        ranges=packed(rays),
        bearing=0.5,
        step=math.tau / RAYS * (1.0 if upside_down else -1.0),
        duration=0.1,
        since_tick=0.0,
        tick=TICK,
    )
    scanner = LaserScanner(x=0.1, y=0.0, yaw=0.5, upside_down=upside_down)
    read = decoded(laser_scan(sample, scanner), "sensor_msgs/msg/LaserScan")
    assert (read.header.frame_id, read.header.stamp.nanosec) == ("scan_laser_link", 123_456_789 - 50_000_000)
    assert (read.angle_increment, read.time_increment) == (pytest.approx(0.8 * DEGREE), 0.0)
    assert read.angle_max == pytest.approx(read.angle_min + (RAYS - 1) * read.angle_increment, abs=1e-5)
    at = 100 if upside_down else RAYS - 1 - 100
    way = 1 if upside_down else -1
    bearing = math.remainder(read.angle_min + at * read.angle_increment, math.tau)
    assert bearing == pytest.approx(way * 80.0 * DEGREE, abs=1e-5)
    assert read.ranges[at] == 1.5
    assert math.isnan(read.ranges[at + way])
    assert math.isnan(read.ranges[at + 2 * way])
    assert read.ranges[0] == math.inf

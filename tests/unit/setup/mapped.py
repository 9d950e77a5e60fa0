"""A drive through a drawn room, as the scans of a laser scanner tell it."""

import math
from array import array
from collections.abc import Iterator
from typing import Any, Final

import msgspec
import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import LaserScanner
from giraff_schemas.messages import RobotTime
from giraff_schemas.scan import RAYS, LaserScan, packed
from giraff_sim.world.ld19 import walls_met
from tests.support.robots import ROBOT
from tests.unit.setup.scans import box

ROOM: Final = [
    *box(-2.5, -2.0, 3.0, 2.5),
    *box(-1.8, 1.9, 0.2, 2.5),
    *box(2.3, -2.0, 3.0, -0.9),
    *box(-0.3, 0.0, 0.6, 0.7),
]
"""Round a table in the middle."""
SCANNER: Final = LaserScanner(x=0.1, y=0.0, yaw=0.0, own=())
MAPPED: Final = msgspec.structs.replace(ROBOT, sensors={**ROBOT.sensors, "laser": SCANNER})
_RADIUS: Final = 1.15
_MIDDLE: Final = (0.15, 0.25)
_STEP: Final = 0.1  # m a scan


def drive(metres: float = 13.0, **told: Any) -> Iterator[LaserScan]:
    """Go round the table. The robot stands while the scanner turns, ten times a second. `told`: by each scan."""
    chance = np.random.default_rng(7)
    angles = -math.tau / RAYS * np.arange(RAYS)
    odom_begin = Pose(3.0, -1.0, 0.7)
    for number in range(round(metres / _STEP)):
        round_by = number * _STEP / _RADIUS
        robot = Pose(
            _MIDDLE[0] + _RADIUS * math.cos(round_by), _MIDDLE[1] + _RADIUS * math.sin(round_by), round_by + math.pi / 2
        )
        at = Pose(SCANNER.x, 0.0, 0.0).placed_in(robot)
        directions = angles + at.yaw
        met = walls_met(np.array(ROOM).T, at.x, at.y, np.cos(directions)[:, None], np.sin(directions)[:, None])[0]
        ranges = met.min(axis=1) + chance.normal(0.0, 0.008, RAYS)
        odom = robot.placed_in(odom_begin)
        scan = LaserScan(
            sensor="laser",
            ranges=packed(array("H", np.round(ranges * 1000.0).astype(int).tolist())),
            bearing=0.0,
            step=-math.tau / RAYS,
            duration=0.0,
            since_tick=0.0,
            odom=(odom.x, odom.y, odom.yaw),
            tick=RobotTime(1, number * 100_000_000 + 1),
        )
        yield msgspec.structs.replace(scan, **told)

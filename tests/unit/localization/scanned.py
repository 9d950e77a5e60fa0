"""Drives of a robot with a laser scanner, and what localization says of them."""

import math
from collections.abc import Sequence
from functools import cache
from typing import Final, NamedTuple

import msgspec
import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_core.robot import RobotConfig
from giraff_localization.floor import Floor
from giraff_localization.policy import LocalizationPolicy
from giraff_maps.floor_plan import FloorPlan
from giraff_maps.room_file import Point
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import Odometry, RobotTime
from giraff_schemas.scan import LaserScan
from tests.support.robots import ROBOT
from tests.support.scan_drives import SCANNER, ScannedDrive, drive
from tests.support.scan_worlds import home
from tests.unit.localization.rooms import CONFIG, odometry

SCANNED: Final = msgspec.structs.replace(ROBOT, sensors=ROBOT.sensors | {"laser": SCANNER})
"""A robot with sonars and a scanner."""
FLAT: Final = ((2.5, 3.2), (2.5, 1.3), (3.75, 1.2), (3.65, 2.6), (3.6, 4.3))
"""A way through the living room of the flat."""


@cache
def scanned_floor(name: str, off: float = 0.03) -> Floor:
    """Return the plan of a home, built, whose walls are so many m (standard deviation) off."""
    chance = np.random.default_rng(1)
    walls = home(name).segments + np.tile(chance.normal(0.0, off, (len(home(name).segments), 2)), 2)
    return built(FloorPlan(name, tuple((x, y, to_x, to_y) for x, y, to_x, to_y in walls.tolist())))


def built(plan: FloorPlan) -> Floor:
    """Return a plan for the robot with a scanner, built."""
    made = Floor(plan, CONFIG, SCANNED)
    assert list(made.build())[-1] == 1.0
    return made


@cache
def driven(name: str, route: Sequence[Point] = (), *, seed: int = 1, carried: bool = False) -> ScannedDrive:
    """Return a drive through a home."""
    return drive(home(name), seed, route=route, carried=carried)


class Said(NamedTuple):
    """Answer of localization, and the truth."""

    pose: MapPose
    true: Pose
    way: float
    """m since the begin."""
    has_transform: bool

    @property
    def error(self) -> float:
        return math.dist((self.pose.x, self.pose.y), self.true[:2])

    @property
    def is_listed(self) -> bool:
        """Tells whether the true place is among the candidates."""
        return any(math.dist((each.x, each.y), self.true[:2]) < 0.3 for each in self.pose.candidates)


class Follower:
    """Gives localization the samples of a drive."""

    def __init__(self, floor: Floor, robot: RobotConfig = SCANNED) -> None:
        self.policy = LocalizationPolicy(CONFIG, robot, floor)
        self.way, self.parts = 0.0, 0
        self._true: Pose | None = None
        self.work()

    def work(self) -> None:
        while self.policy.work():
            self.parts += 1

    def follow(self, found: ScannedDrive, first: int = 0, last: int | None = None) -> list[Said]:
        """Return what it says at the begin of each scan."""
        said = []
        for scan, true in zip(found.scans[first:last], found.truth[first:last], strict=True):
            self.way += 0.0 if self._true is None else math.dist(true[:2], self._true[:2])
            self._true = true
            self.policy.on_odometry(moved(scan))
            self.policy.on_sample(scan)
            self.work()
            said.append(Said(self.policy.pose(), true, self.way, self.policy.transform() is not None))
        return said


def moved(scan: LaserScan, *, instance: str = "one", jumps: int = 0) -> Odometry:
    """Return what odometry says at the begin of a scan."""
    assert scan.tick is not None
    assert scan.odom is not None
    at_ns = scan.tick.robot_ns + round(scan.since_tick * 1e9)
    said = odometry(at_ns * 1e-9, *scan.odom, instance=instance, jumps=jumps)
    return msgspec.structs.replace(said, tick=RobotTime(epoch=scan.tick.epoch, robot_ns=at_ns))

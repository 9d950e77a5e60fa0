"""What a guided calibration makes of one drawn robot: how near its scales come, and how near odometry is then."""

import math
from collections.abc import Callable
from typing import NamedTuple

import msgspec

from giraff_core.kinematics.calibration import Calibration, Scales
from giraff_core.kinematics.pose import ELLIPSE_95, mahalanobis
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_setup.wheels.odometry.fit import Fit, fit
from giraff_setup.wheels.odometry.plan import PLAN
from giraff_setup.wheels.odometry.procedure import Procedure
from giraff_setup.wheels.odometry.runs import Geometry
from giraff_sim.world.room import Pose
from tests.support.floor_robot import FloorRobot
from tests.unit.setup.person import Person
from tests.unit.setup.taped import TapedRobot

Path = Callable[[FloorRobot], None]


def line(robot: FloorRobot) -> None:
    robot.go(3.0)


def bend(robot: FloorRobot) -> None:
    robot.go(2.0)
    robot.turn(1.2)
    robot.go(2.0)
    robot.turn(-0.7)
    robot.go(1.0)


OPEN: tuple[Path, ...] = (line, bend)
"""They end elsewhere than they begin."""


class Outcome(NamedTuple):
    """Of one robot."""

    off: tuple[float, ...]
    """By which the left wheel, the right wheel and the track were missed."""
    sd: tuple[float, ...]
    """What the fit says of that."""
    distances: tuple[float, ...]
    """Mahalanobis's, of odometry's place at the end of each open path."""
    areas: tuple[float, ...]
    """m², of its ellipse of 95 % there."""


def calibrated(seed: int) -> Outcome:
    """From a robot that nobody has calibrated."""
    taped = TapedRobot(seed)
    robot = taped.robot.robot
    geometry = Geometry(robot.ticks_per_metre, robot.track_width)
    measured = Procedure(Person(taped), taped, geometry).measure([leg for leg in PLAN if not leg.is_check])
    found = fit(measured.fitted, geometry)
    off = tuple(a - b for a, b in zip(found.scales, taped.true_scales, strict=True))
    known = msgspec.structs.replace(robot, calibration=_as_filed(found))
    distances, areas = zip(*(_ellipse(taped.robot, known, path) for path in OPEN), strict=True)
    return Outcome(off, found.sd, distances, areas)


def _as_filed(found: Fit) -> Calibration:
    scales: Scales = found.scales
    return Calibration(
        left_wheel_scale=scales.left_wheel,
        right_wheel_scale=scales.right_wheel,
        track_scale=scales.track,
        covariance=found.covariance,
    )


def _ellipse(robot: FloorRobot, known: RobotConfig, path: Path) -> tuple[float, float]:
    """How far odometry is off, in standard deviations, and how large its ellipse is, m²."""
    begin, start = len(robot.heard) - 1, robot.pose
    path(robot)
    odometry = OdometryPolicy(Live(OdometryConfig()), known)
    answers = [odometry.on_wheels(sample) for sample in robot.heard[begin:]]
    odom = answers[-1]
    assert odom is not None
    x, y = _seen_from(start, robot.pose)
    xx, xy, _, yy, _, _ = odom.covariance
    area = math.pi * ELLIPSE_95**2 * math.sqrt(xx * yy - xy * xy)
    return mahalanobis(odom.x - x, odom.y - y, xx, xy, yy), area


def _seen_from(start: Pose, end: Pose) -> tuple[float, float]:
    cos, sin = math.cos(start.yaw), math.sin(start.yaw)
    x, y = end.x - start.x, end.y - start.y
    return cos * x + sin * y, cos * y - sin * x

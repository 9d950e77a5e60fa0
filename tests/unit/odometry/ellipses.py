"""The ellipses that odometry claims for drawn robots that nobody has calibrated, and where these truly are."""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

from giraff_core.kinematics.pose import ELLIPSE_95, mahalanobis
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_schemas.messages import Odometry
from giraff_sim.config import SimConfig
from giraff_sim.truth import draw_truth
from tests.support.floor_robot import FloorRobot

Path = Callable[[FloorRobot], None]


def line(robot: FloorRobot) -> None:
    robot.go(3.0)


def there_and_back(robot: FloorRobot) -> None:
    robot.go(3.0)
    robot.turn(math.pi)
    robot.go(3.0)


def square(robot: FloorRobot) -> None:
    for _ in range(4):
        robot.go(1.5)
        robot.turn(math.pi / 2.0)


PATHS: tuple[Path, ...] = (line, there_and_back, square)


class Held(NamedTuple):
    """Of many robots on one path."""

    share: float
    """Whose true place is within the ellipse of 95 %."""
    area: float
    """m², of the ellipse, on average."""
    least: float
    """m²; the same of ellipses so much smaller or larger that they hold just 95 %."""


def held(path: Path, seeds: Iterable[int]) -> Held:
    """A robot for each seed."""
    distances, areas = [], []
    for seed in seeds:
        robot = FloorRobot(draw_truth("uncalibrated", SimConfig().truth, seed), seed)
        path(robot)
        odom = odometry_of(robot, robot.robot)
        xx, xy, _, yy, _, _ = odom.covariance
        distances.append(mahalanobis(odom.x - robot.pose.x, odom.y - robot.pose.y, xx, xy, yy))
        areas.append(math.pi * ELLIPSE_95**2 * math.sqrt(xx * yy - xy * xy))
    share = sum(distance <= ELLIPSE_95 for distance in distances) / len(distances)
    enough = sorted(distances)[math.ceil(0.95 * len(distances)) - 1] / ELLIPSE_95
    area = sum(areas) / len(areas)
    return Held(share, area, area * enough**2)


def odometry_of(robot: FloorRobot, known: RobotConfig) -> Odometry:
    """The last word of odometry on all that it has heard."""
    policy = OdometryPolicy(Live(OdometryConfig()), known)
    answers = [policy.on_wheels(sample) for sample in robot.heard]
    assert answers[-1] is not None
    assert policy.breaks == 0
    return answers[-1]

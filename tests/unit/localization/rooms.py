"""Small plans, computed once, and what a robot says in them."""

from functools import cache
from itertools import pairwise
from typing import Final

from giraff_localization.config import LocalizationConfig
from giraff_localization.floor import Floor
from giraff_maps.floor_plan import FloorPlan, Wall
from giraff_schemas.messages import Odometry, Range, RobotTime
from tests.support.robots import ROBOT

CONFIG: Final = LocalizationConfig(least_particles=300, most_particles=2000)
EPOCH: Final = 7


def outline(*points: tuple[float, float]) -> tuple[Wall, ...]:
    """Walls from point to point, and back to the first."""
    return tuple((*one, *other) for one, other in pairwise([*points, points[0]]))


ROOM: Final = FloorPlan("room", outline((0.0, 0.0), (5.0, 0.0), (5.0, 3.0), (0.0, 3.0)))
"""5 m by 3 m, with nothing in it."""


@cache
def floor(plan: FloorPlan = ROOM) -> Floor:
    """With its table."""
    made = Floor(plan, CONFIG, ROBOT)
    for _ in made.build():
        pass
    return made


def odometry(
    seconds: float, x: float = 0.0, y: float = 0.0, yaw: float = 0.0, *, jumps: int = 0, instance: str = "one"
) -> Odometry:
    """What odometry says then."""
    return Odometry(
        x=x,
        y=y,
        yaw=yaw,
        linear_x=0.0,
        angular_z=0.0,
        covariance=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        path=0.0,
        board_us=0,
        boot_id=1,
        tick=moment(seconds),
        jumps=jumps,
        instance=instance,
        seq=round(seconds * 100.0),
    )


def moment(seconds: float) -> RobotTime:
    return RobotTime(epoch=EPOCH, robot_ns=round(seconds * 1e9))


def echo(sensor: str, seconds: float, distance: float | None) -> Range:
    """A reading; None: nothing answers."""
    return Range(
        sensor=sensor,
        state="clear" if distance is None else "echo",
        range=distance,
        echo_us=0,
        tick=moment(seconds),
    )

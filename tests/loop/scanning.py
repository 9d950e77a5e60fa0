"""A robot with a laser scanner in furnished rooms, and how it is driven there: all is drawn from seeds."""

import math
import random
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Final, NamedTuple

import msgspec

from giraff_core.senses import LaserScanner, Sense
from giraff_scan.config import ScanConfig
from giraff_scan.service import Scan
from giraff_schemas.scan import LaserScan
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.config import SimConfig
from giraff_sim.hosts.cable import Cable
from giraff_sim.hosts.process import Observer, Process
from giraff_sim.truth import Truth
from giraff_sim.world.body import Plant
from giraff_sim.world.ld19 import Ld19
from giraff_sim.world.room import Pose, Room
from tests.loop.loops import FULL_TILT, SETTINGS, arm, closed_loop, drawn, hold
from tests.sim.robots import EXACT, empty_room
from tests.support.robots import ROBOT

LASER: Final = LaserScanner(x=0.05, y=0.0, yaw=0.4, own=())
MOUNTS: Final = (LASER, LaserScanner(x=-0.12, y=0.08, yaw=-2.0, upside_down=True, own=()))
GENTLE: Final = 0.15
"""m/s: a faster touch is a failure."""
LEGS: Final = (0.012, 0.03)
"""m, radii of thin and of thick legs."""
_BIAS: Final = 0.015  # m, either way
_CABLE: Final = "scan"

Box = tuple[float, float, float, float]


class _Room(NamedTuple):
    """A room whose south wall has a door of 0.9 m."""

    size: tuple[float, float, float]
    """m: width, depth, and where the door begins."""
    start: tuple[float, float]
    boxes: tuple[Box, ...]
    """Left, lower, right and upper edge of each."""
    legs: tuple[tuple[float, float, float], ...]
    """x, y, radius."""
    lines: tuple[tuple[tuple[float, float], ...], ...] = ()


def _four(x: float, y: float, width: float, depth: float, radius: float) -> tuple[tuple[float, float, float], ...]:
    return tuple((x + i * width, y + k * depth, radius) for i in (0, 1) for k in (0, 1))


_ROOMS: Final = {
    "parlour": _Room(
        (5.2, 4.4, 0.6),
        (1.3, 1.6),
        ((1.0, 3.5, 3.1, 4.4), (0.0, 1.9, 0.3, 3.3), (4.7, 0.0, 5.2, 1.0)),
        (*_four(3.3, 1.6, 1.0, 0.7, 0.03), *_four(2.8, 0.5, 0.4, 0.4, 0.012), (4.8, 4.0, 0.012)),
    ),
    "kitchen": _Room(
        (4.6, 3.8, 3.2),
        (2.0, 2.2),
        ((0.0, 0.0, 0.6, 3.8), (0.6, 3.2, 2.8, 3.8)),
        ((3.0, 1.9, 0.03), *_four(3.45, 2.5, 0.35, 0.35, 0.012), (1.3, 0.6, 0.012), (1.65, 0.6, 0.012)),
        (((4.6, 1.3), (4.0, 1.3), (4.0, 1.45), (4.6, 1.45)),),
    ),
    "study": _Room(
        (5.6, 5.0, 2.2),
        (2.6, 2.4),
        ((0.0, 3.0, 2.0, 5.0), (5.0, 1.5, 5.6, 3.9), (2.9, 4.7, 4.4, 5.0)),
        (*_four(3.6, 0.5, 1.3, 0.6, 0.03), *_four(0.5, 0.8, 0.45, 0.45, 0.012), (2.4, 3.5, 0.012)),
        (((3.1, 0.0), (3.4, 0.85)), ((0.0, 2.0), (0.8, 2.3), (0.6, 2.7), (0.0, 2.6))),
    ),
}
ROOMS: Final = tuple(_ROOMS)


def furnished(name: str, yaw: float = 0.0) -> Room:
    """One of ROOMS, with the robot at its start, which looks to `yaw`."""
    plan = _ROOMS[name]
    room = Room(name, Pose(*plan.start, yaw))
    width, depth, door = plan.size
    room.add_wall("walls", [(door + 0.9, 0.0), (width, 0.0), (width, depth), (0.0, depth), (0.0, 0.0), (door, 0.0)])
    room.add_wall("hall", [(door, 0.0), (door, -1.3), (door + 0.9, -1.3), (door + 0.9, 0.0)])
    for left, lower, right, upper in plan.boxes:
        room.add_wall("box", [(left, lower), (right, lower), (right, upper), (left, upper)], closed=True)
    for leg in plan.legs:
        room.add_post("leg", *leg)
    for line in plan.lines:
        room.add_wall("line", [*line])
    return room


class _Turns(Observer):
    def __init__(self) -> None:
        self.turns: list[LaserScan] = []

    def said(self, process: Process, sample: Any) -> None:
        del process
        if isinstance(sample, LaserScan):
            self.turns.append(sample)


class Scanned(NamedTuple):
    """A robot that is armed."""

    loop: ClosedLoop
    laser: Ld19
    turns: list[LaserScan]
    """All that were published."""
    plant: Plant


@contextmanager
def scanned(
    room: Room,
    seed: int = 1,
    sensors: dict[str, Sense] | None = None,
    sim: SimConfig = EXACT,
    truth: Truth | None = None,
    mount: LaserScanner = LASER,
) -> Iterator[Scanned]:
    """A robot that is armed, with a scanner and these sensors beside it."""
    robot, heard = msgspec.structs.replace(ROBOT, sensors={"laser": mount} | (sensors or {})), _Turns()
    settings, config = msgspec.structs.replace(SETTINGS, robot=robot), ScanConfig(port=_CABLE)
    with closed_loop(room, settings, sim=sim, seed=seed, truth=truth, observer=heard) as loop:
        bias = random.Random(f"{seed}/bias").uniform(-_BIAS, _BIAS)
        laser = Ld19(mount, loop.simulation.world, f"{seed}/laser", bias=bias)
        loop.cables[_CABLE] = Cable(laser, loop.simulation)
        loop.launch("scan", lambda io: Scan(io, config, robot), loop.hosts["robot"])
        arm(loop)
        yield Scanned(loop, laser, heard.turns, loop.simulation.world.plant)


def touches(robot: Scanned, seconds: float) -> Iterator[float]:
    """Run for so long, and yield of each touch how fast the robot was just before, m/s."""
    simulation, plant = robot.loop.simulation, robot.plant
    end = simulation.now_us + round(seconds * 1e6)
    while simulation.now_us < end:
        contacts, speed = plant.contacts, abs(plant.speed)
        robot.loop.step()
        if plant.contacts > contacts:
            yield speed


class Drive(NamedTuple):
    """Outcome of a drive."""

    touches: list[float]
    """Speed of each, m/s."""
    way: float
    """m the robot came."""
    nearest: float
    """m to what was nearest on that way."""

    @property
    def is_hard(self) -> bool:
        return max(self.touches, default=0.0) > GENTLE


def drive_wildly(seed: int, seconds: float) -> Drive:
    """Drive through one of the rooms at full tilt, another way each 0.5 to 2 s."""
    choose = random.Random(f"{seed}/wild")
    room = furnished(ROOMS[seed % len(ROOMS)], choose.uniform(-math.pi, math.pi))
    holds = []
    while seconds > 0.0:
        bend = choose.choice((0.0, 2.0, 5.0)) * choose.uniform(-1.0, 1.0)
        holds.append((choose.choice((FULL_TILT, FULL_TILT, -FULL_TILT)), bend, min(seconds, choose.uniform(0.5, 2.0))))
        seconds -= holds[-1][-1]
    return _driven(room, seed, holds)


def drive_at_post(seed: int, seconds: float, farthest: float = 2.2) -> Drive:
    """Drive straight at full tilt at a post, past it where it stands beside the way: half of the drives backward."""
    choose = random.Random(f"{seed}/post")
    sign = 1.0 if seed % 4 < 2 else -1.0
    room = empty_room()
    room.add_post("post", sign * choose.uniform(0.9, farthest), choose.uniform(-0.5, 0.5), LEGS[seed % 2])
    room.add_wall("walls", [(6.0, -4.0), (6.0, 4.0), (-6.0, 4.0), (-6.0, -4.0)], closed=True)
    return _driven(room, seed, [(sign * FULL_TILT, 0.0, seconds)])


def _driven(room: Room, seed: int, holds: Sequence[tuple[float, float, float]]) -> Drive:
    """Hold the joystick like that along its axes, m/s², for so many s each."""
    with scanned(room, seed, sim=SimConfig(), truth=drawn(seed), mount=MOUNTS[seed // 3 % 2]) as robot:
        found: list[float] = []
        for x, y, lasts in holds:
            hold(robot.loop, x, y)
            found += touches(robot, lasts)
        return Drive(found, robot.plant.path_length, robot.plant.closest)

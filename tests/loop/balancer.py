"""A drawn robot that balances, with all its services, in rooms: tours, walls, and faults on the way."""

import math
import random
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Final, NamedTuple

import msgspec

from giraff_schemas.wire import BoardKind
from giraff_sim.board import ROOT, Board
from giraff_sim.bodies.balancer.body import BalancerBody
from giraff_sim.bodies.balancer.plant import Plant
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.settings import Settings
from giraff_sim.truth import draw_truth
from giraff_sim.world.demo_hand import DemoHand
from giraff_sim.world.room import Room, read_room
from tests.loop.loops import FULL_TILT, closed_loop, hold
from tests.sim.robots import proving_room
from tests.support.balancer_file import BALANCER, SIM

AT_0_3: Final = msgspec.structs.replace(BALANCER, robot=msgspec.structs.replace(BALANCER.robot, max_wheel_speed=0.3))
"""A hand asks it for 0.3 m/s at full tilt."""
_STEP_US: Final = 1000  # a board that reads its sensors each 5 ms takes slower ones for frozen
_GETS_UP: Final = 4.0  # s
_COASTS: Final = 0.1  # rad
_PATIENCE_US: Final = 60_000_000
_DRIVES: Final = 0.15  # m/s
_STANDS: Final = 0.08  # m in a second: it sways


class Drive(NamedTuple):
    """True values of a drive."""

    contacts: int
    falls: int
    path: float
    """m."""
    closest: float
    """m between the robot and what was nearest to it."""
    fastest: float
    """m/s."""


@contextmanager
def balancing(room: Room, seed: int, settings: Settings = BALANCER) -> Iterator[tuple[ClosedLoop, Plant]]:
    """Begin with a robot that has just got up."""
    truth = draw_truth("calibrated", SIM.truth, seed)
    with closed_loop(room, settings, sim=SIM, seed=seed, truth=truth, step_us=_STEP_US) as loop:
        hold(loop)
        loop.run(_GETS_UP)
        assert loop.newest["attitude"].posture == "stands", loop.newest["base"].reason
        yield loop, body_of(loop).plant


def body_of(loop: ClosedLoop) -> BalancerBody:
    body = loop.simulation.world.body
    assert isinstance(body, BalancerBody)
    return body


def run(loop: ClosedLoop, seconds: float) -> float:
    """Let time pass and return the largest speed, m/s."""
    plant, fastest = body_of(loop).plant, 0.0
    end_us = loop.simulation.now_us + round(seconds * 1e6)
    while loop.simulation.now_us < end_us:
        loop.step()
        fastest = max(fastest, abs(plant.speed))
    return fastest


def tour(seed: int, seconds: float = 60.0, settings: Settings = AT_0_3) -> Drive:
    """Drive round the furnished room as the demonstration does."""
    room = read_room(ROOT / "deploy" / "worlds" / "living_room.toml")
    with balancing(room, seed, settings) as (loop, plant):
        loop.simulation.world.hand = DemoHand(room.waypoints, seed, begin=_GETS_UP)
        fastest = run(loop, seconds)
        return Drive(plant.contacts, plant.falls, plant.path_length, plant.closest, fastest)


class Walls(NamedTuple):
    """What it did between two walls."""

    drive: Drive
    before: float
    """m between the robot and the first wall, where it stopped."""
    turned: float
    """rad by which it turned in place."""
    astray: float
    """m that it went meanwhile."""


def no_other_margin(settings: Settings = BALANCER) -> Settings:
    """Return a robot that only the stopping distance keeps off a wall: no margin, and no doubt of where it is heard."""
    guard = msgspec.structs.replace(settings.guard, margin=0.01, incidence=0.001, half_cone=0.001)
    return msgspec.structs.replace(settings, guard=guard)


def against_wall(seed: int, way: float, settings: Settings = BALANCER) -> Drive:
    """Drive at full tilt against a wall that is `way` m before the robot, until it stands."""
    room = proving_room(half=settings.robot.footprint_radius + way)
    with balancing(room, seed, settings) as (loop, plant):
        fastest = _against_wall(loop, plant)
        return Drive(plant.contacts, plant.falls, plant.path_length, plant.closest, fastest)


def between_walls(seed: int, settings: Settings = BALANCER) -> Walls:
    """Drive against a wall, turn round in place there, and drive against the wall on the other side."""
    chance = random.Random(f"{seed}/walls")
    room = proving_room(half=settings.robot.footprint_radius + chance.uniform(0.6, 4.0))
    with balancing(room, seed, settings) as (loop, plant):
        fastest = _against_wall(loop, plant)
        hold(loop)
        loop.run(1.5)
        before, place, heading = plant.clearance, plant.pose, plant.turned
        hold(loop, 0.0, FULL_TILT)
        while plant.turned - heading < math.pi - _COASTS and loop.simulation.now_us < _PATIENCE_US:
            loop.step()
        hold(loop)
        loop.run(1.5)
        turned, astray = plant.turned - heading, math.dist(plant.pose[:2], place[:2])
        fastest = max(fastest, _against_wall(loop, plant))
        drive = Drive(plant.contacts, plant.falls, plant.path_length, plant.closest, fastest)
        return Walls(drive, before, turned, astray)


def _against_wall(loop: ClosedLoop, plant: Plant) -> float:
    """Hold full tilt until it has stood for a second, and return the largest speed, m/s."""
    hold(loop, FULL_TILT)
    fastest, place = run(loop, 1.5), plant.path_length
    while loop.simulation.now_us < _PATIENCE_US:
        fastest = max(fastest, run(loop, 1.0))
        if plant.path_length - place < _STANDS:
            break
        place = plant.path_length
    return fastest


class Broken(NamedTuple):
    """What became of a robot on whose tour something failed."""

    contacts: int
    gone: float
    """m from where it was."""
    drives: bool
    """Whether it goes anywhere after 5 s, though the hand goes on."""


class Parts(NamedTuple):
    """What a fault needs of a robot: see tests/support/balancing.py."""

    board: Board
    body: BalancerBody
    plant: Plant
    drive_config: Any
    before_each_ms: Callable[[], None]


def breaks_on_tour(seed: int, fault: Callable[[Any], None], settings: Settings = AT_0_3) -> Broken:
    """Break something on a tour, and let the hand go on."""
    room = read_room(ROOT / "deploy" / "worlds" / "living_room.toml")
    chance = random.Random(f"{seed}/breaks")
    with balancing(room, seed, settings) as (loop, plant):
        loop.simulation.world.hand = DemoHand(room.waypoints, seed, begin=_GETS_UP)
        loop.run(chance.uniform(4.0, 20.0))
        while abs(plant.speed) < _DRIVES:
            loop.step()
        body = body_of(loop)
        place = plant.pose
        fault(Parts(loop.simulation.boards[BoardKind.BASE], body, plant, body.drive, lambda: None))
        loop.run(5.0)
        stopped = plant.pose
        loop.run(2.0)
        drives = math.dist(plant.pose[:2], stopped[:2]) > 0.10
        return Broken(plant.contacts, math.dist(plant.pose[:2], place[:2]), drives)

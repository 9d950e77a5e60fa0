"""Drives with wild readings, and people who step in front of the robot: what the guard makes of them, in figures."""

import math
import random
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import groupby
from typing import Any, Final

import msgspec

from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.config import SimConfig
from giraff_sim.truth import Truth, draw_truth
from giraff_sim.world.hand import StillHand
from giraff_sim.world.room import Pose
from giraff_sim.world.sonar import SonarFault
from tests.loop.loops import GRAVITY, SETTINGS, arm, closed_loop, spare_time
from tests.sim.robots import proving_room
from tests.support.robots import ROBOT

WILD_SHARE: Final = 0.05
_SENSOR_X: Final = 0.25  # m, of both front sensors
_HALF_ROOM: Final = 3.6  # m: the robot circles in its middle
_SPEEDS: Final = (0.25, 0.45)  # m/s
_CURVATURE: Final = 0.85  # 1/m
_STEPS_IN: Final = (0.30, 0.34)
"""m from the sensors: a stop at any speed, and none that ends so near that the echo is lost by touch."""
_BRIEF: Final = 0.25  # s; a longer stop is a confirmed one
_SETTLED: Final = 1.5  # s after which somebody who stepped in has been heard


class Turn(msgspec.Struct, frozen=True):
    """A turn of the guard while the hand asks to drive forward."""

    now_us: int
    linear_x: float


class Reading(msgspec.Struct, frozen=True):
    """A reading of a front sensor, when it was published."""

    now_us: int
    range: float | None


class Watcher:
    """Steps the robot and notes what the guard hears and lets through."""

    def __init__(self, loop: ClosedLoop) -> None:
        self.loop = loop
        self.turns: list[Turn] = []
        self.readings: list[Reading] = []
        self._seen: dict[str, Any] = {}

    def run(self, seconds: float) -> None:
        end = self.now_us + round(seconds * 1e6)
        while self.now_us < end:
            self.step()

    def step(self) -> None:
        self.loop.step()
        if (command := self._new("cmd_vel")) is not None:
            self.turns.append(Turn(self.now_us, command.linear_x))
        for sensor in ("range/front_left", "range/front_right"):
            if (reading := self._new(sensor)) is not None:
                self.readings.append(Reading(self.now_us, reading.range))

    @property
    def now_us(self) -> int:
        return self.loop.simulation.now_us

    def forget(self) -> None:
        self.turns.clear()
        self.readings.clear()

    def _new(self, key: str) -> Any:
        sample = self.loop.newest.get(key)
        if sample is None or sample is self._seen.get(key):
            return None
        self._seen[key] = sample
        return sample


def tilted(linear: float, angular: float) -> StillHand:
    """A hand that asks for this twist by the default curve."""
    joystick = SETTINGS.joystick

    def deflection(share: float) -> float:
        if share == 0.0:
            return 0.0
        way = joystick.full_tilt_deg - joystick.dead_zone_deg
        degrees = joystick.dead_zone_deg + way * min(1.0, abs(share))
        return GRAVITY * math.copysign(math.sin(math.radians(degrees)), share)

    x, y = deflection(linear / ROBOT.max_wheel_speed), deflection(angular / ROBOT.max_angular_speed)
    return StillHand((x, y, math.sqrt(GRAVITY**2 - x * x - y * y)))


def stops(turns: Sequence[Turn]) -> list[float]:
    """s of each time that forward was at zero."""
    found = []
    for stopped, group in groupby(enumerate(turns), key=lambda item: item[1].linear_x == 0.0):
        members = list(group)
        after = members[-1][0] + 1
        if stopped and after < len(turns):
            found.append((turns[after].now_us - members[0][1].now_us) * 1e-6)
    return found


def on_its_circle(seed: int) -> Truth:
    """A calibrated robot with like motors and a tilt sensor without offset: another leaves the middle of the room."""
    truth = draw_truth("calibrated", SimConfig().truth, seed)
    left, right = (msgspec.structs.replace(wheel, strength=1.0) for wheel in (truth.left, truth.right))
    return msgspec.structs.replace(truth, left=left, right=right, accelerometer_offset=(0.0, 0.0, 0.0))


@contextmanager
def circling(seed: int, wild_share: float) -> Iterator[tuple[Watcher, random.Random]]:
    """A robot that circles in the middle of a room, with nothing in its way."""
    choose = random.Random(f"{seed}/reaction")
    room = proving_room(Pose(0.0, 0.0, choose.uniform(-math.pi, math.pi)), _HALF_ROOM)
    with closed_loop(room, sim=SimConfig(), seed=seed, truth=on_its_circle(seed)) as loop:
        spare_time(loop)
        arm(loop)
        for sonar in loop.simulation.world.sonars.values():
            sonar.fault, sonar.wild_share = SonarFault.WILD_SOME, wild_share
        speed = choose.uniform(*_SPEEDS)
        loop.simulation.world.hand = tilted(speed, speed * _CURVATURE * choose.choice((-1.0, 1.0)))
        watcher = Watcher(loop)
        watcher.run(2.0)
        watcher.forget()
        yield watcher, choose


class DriveFigures(msgspec.Struct, frozen=True):
    """One minute with nothing in the way."""

    confirmed: int
    brief: int
    longest: float
    path: float


def drive(seed: int, wild_share: float = WILD_SHARE, seconds: float = 60.0) -> DriveFigures:
    with circling(seed, wild_share) as (watcher, _):
        plant = watcher.loop.simulation.world.plant
        before = plant.path_length
        watcher.run(seconds)
        found = stops(watcher.turns)
        return DriveFigures(
            confirmed=sum(seconds > _BRIEF for seconds in found),
            brief=sum(seconds <= _BRIEF for seconds in found),
            longest=max(found, default=0.0),
            path=plant.path_length - before,
        )


class Intrusion(msgspec.Struct, frozen=True):
    """Somebody steps in front of the driving robot, stands, and goes. s."""

    reaction: float
    """From the first short reading to forward at zero."""
    turns: int
    """While somebody stood there and had been heard."""
    blocked_turns: int
    fastest_release: float
    """m/s let through at the most in the others."""
    resume: float
    """From the going to first motion."""
    contacts: int


def intrude(seed: int, wild_share: float = WILD_SHARE) -> Intrusion:
    with circling(seed, wild_share) as (watcher, choose):
        world = watcher.loop.simulation.world
        watcher.run(choose.uniform(0.0, 6.0))
        distance = choose.uniform(*_STEPS_IN)
        _step_in(watcher, choose, distance)
        world.hand = tilted(0.5, 0.0)
        watcher.forget()
        watcher.run(choose.uniform(4.0, 8.0))
        came = watcher.turns[0].now_us
        # What is heard for certain: a wild reading may be as short, and stops the robot as well.
        short = next(reading for reading in watcher.readings if reading.range is not None and reading.range <= distance)
        zero = next(turn for turn in watcher.turns if turn.now_us >= short.now_us and turn.linear_x == 0.0)
        standing = [turn for turn in watcher.turns if turn.now_us > came + _SETTLED * 1e6]
        world.room.remove("person")
        gone_us = watcher.now_us
        while world.plant.left.speed + world.plant.right.speed < 0.01:
            watcher.step()
            assert watcher.now_us < gone_us + 5_000_000, f"intrusion {seed}: {watcher.loop.newest['guard']}"
        return Intrusion(
            reaction=(zero.now_us - short.now_us) * 1e-6,
            turns=len(standing),
            blocked_turns=sum(turn.linear_x == 0.0 for turn in standing),
            fastest_release=max(turn.linear_x for turn in standing),
            resume=(watcher.now_us - gone_us) * 1e-6,
            contacts=world.plant.contacts,
        )


def _step_in(watcher: Watcher, choose: random.Random, distance: float) -> None:
    """Somebody, 0.5 m wide, before both front sensors or one of them."""
    world = watcher.loop.simulation.world
    pose = world.plant.pose
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    x, middle = _SENSOR_X + distance, choose.uniform(-0.25, 0.25)
    ends = [(x, middle - 0.25), (x, middle + 0.25)]
    points = [(pose.x + cos * ahead - sin * left, pose.y + sin * ahead + cos * left) for ahead, left in ends]
    world.room.add_wall("person", points)


def quantile(values: Sequence[float], share: float) -> float:
    """The value that this share of them does not exceed."""
    return sorted(values)[min(len(values) - 1, math.ceil(share * len(values)) - 1)]

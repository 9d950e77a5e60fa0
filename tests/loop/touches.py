"""What the robot touches, how fast, and what its sensors have heard of it or would have: by the truth alone."""

import math
from collections import deque
from enum import StrEnum
from itertools import pairwise
from typing import Final, NamedTuple

import msgspec

from giraff_maps.room_file import Point
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.world.room import Pose
from giraff_sim.world.sonar import Sonar
from tests.loop.rooms import NEARLY
from tests.support.robots import ROBOT, ULTRASONIC

_HEARD_US: Final = 10_000_000
_BESIDE: Final = 0.5  # m along a wall between what was heard of it and what is touched
_NEAR_PINGS: Final = 3  # before an echo, of which one is to be an echo too
_WAY: Final = 2.0  # m
_SHARE: Final = 0.9  # of the pings on that way
_TOUCHES: Final = 1e-4  # m
_LEFT: Final = 0.01  # m: nearer, a robot that is pushed along something has not left it
_MOVED: Final = 1e-3  # m between two pings of a robot that drives
_BACK: Final = 0.05  # m: less, as in turning on the spot, is not driving back
_STEPS: Final = 3  # before the touch, for its speed


class Kind(StrEnum):
    """Which bound a touch has to keep."""

    HEARD = "heard within 10 s"
    """A sensor that looks the way the robot drives got two true echoes of it, with at most two pings between them."""
    WOULD = "would have been heard"
    """Not so, but with all sensors sound one of them would have heard it for 2 m of way."""
    REST = "the rest"
    """Beside the cones, too slanted, or come upon sooner: sound sensors miss it as well."""
    OTHER = "no deaf sensor that way"
    """Before a sensor was deaf, or the other way."""


class Touch(msgspec.Struct, frozen=True):
    """The robot has come to touch something."""

    kind: Kind
    speed: float
    """m/s, truly, along the robot's x, just before."""
    surface: str
    point: Point
    bearing: float
    """rad from the robot's x, left positive."""
    seconds: float
    """Simulated s since power-on."""
    is_audible: bool
    """At the last ping before, a sound sensor of that way would have heard it for certain."""


class _Ping(NamedTuple):
    at_us: int
    path: float
    """m the robot had come."""
    pose: Pose
    measured: float | None
    """m; None where it was deaf, wild or without an echo."""


class Touches:
    """Steps with the loop and notes each touch."""

    def __init__(self, loop: ClosedLoop, deaf: tuple[str, ...]) -> None:
        """`deaf`: the sensors that are to be deaf, from `is_deaf` on."""
        self.noted: list[Touch] = []
        self.is_deaf = False
        self._deaf = deaf
        self._loop = loop
        self._world = loop.simulation.world
        self._pings: dict[str, list[_Ping]] = {name: [] for name in ULTRASONIC}
        self._counted = {name: self._sonar(name).pings for name in ULTRASONIC}
        self._poses: deque[Pose] = deque([self._world.plant.pose], maxlen=_STEPS + 1)
        self._touching: set[int] = set()
        self._free_to = 0.0  # m of path before which nothing can be touched
        self._sign = 1.0
        self._along = self._farthest = 0.0  # m along x, and how far on that got
        self._farthest_path = self._turned_back = 0.0  # m the robot had come there, and where it turned back last

    def note(self) -> None:
        """Look at the world; after each step of the loop."""
        for name in ULTRASONIC:
            self._note_ping(name)
        self._note_way()
        if self._world.plant.path_length >= self._free_to:
            self._note_touches()
        self._poses.append(self._world.plant.pose)

    def _note_touches(self) -> None:
        plant = self._world.plant
        clear = plant.clearance
        self._free_to = plant.path_length + clear - _LEFT
        near: dict[int, float] = {}
        if clear < _LEFT:
            near = {surface: self._clearance(surface) for surface in self._world.room.surfaces}
        if begun := {surface for surface, away in near.items() if away < _TOUCHES} - self._touching:
            self.noted.append(self._touch(begun))
        self._touching = {surface for surface in self._touching | begun if near.get(surface, math.inf) < _LEFT}

    def _note_ping(self, name: str) -> None:
        sonar = self._sonar(name)
        if sonar.pings == self._counted[name]:
            return
        self._counted[name] = sonar.pings
        plant = self._world.plant
        self._pings[name].append(_Ping(self._loop.simulation.now_us, plant.path_length, plant.pose, sonar.measured))

    def _note_way(self) -> None:
        """Where on its way the robot began to drive as it does."""
        plant, before = self._world.plant, self._poses[-1]
        self._along += _along(before, plant.pose)
        if (self._along - self._farthest) * self._sign >= 0.0:
            self._farthest, self._farthest_path = self._along, plant.path_length
        elif abs(self._along - self._farthest) > _BACK:
            self._sign, self._turned_back = -self._sign, self._farthest_path
            self._farthest, self._farthest_path = self._along, plant.path_length

    def _touch(self, surfaces: set[int]) -> Touch:
        room, pose = self._world.room, self._world.plant.pose
        point = min((room.nearest_of(surface, *pose[:2]) for surface in surfaces), key=lambda p: math.dist(p, pose[:2]))
        speed = self._speed()
        sign = math.copysign(1.0, speed)
        sensors = [name for name, mount in ULTRASONIC.items() if math.cos(mount.yaw) * sign > 0.0]
        return Touch(
            kind=self._kind(surfaces, point, sensors, sign),
            speed=abs(speed),
            surface=room.name_of(min(surfaces)),
            point=point,
            bearing=math.remainder(math.atan2(point[1] - pose.y, point[0] - pose.x) - pose.yaw, math.tau),
            seconds=self._loop.simulation.now_us * 1e-6,
            is_audible=any(
                self._would_hear(name, self._pings[name][-1].pose, surfaces) for name in sensors if self._pings[name]
            ),
        )

    def _kind(self, surfaces: set[int], point: Point, sensors: list[str], sign: float) -> Kind:
        if not self.is_deaf or not set(sensors) & set(self._deaf):
            return Kind.OTHER
        if any(self._has_heard(name, surfaces, point) for name in sensors):
            return Kind.HEARD
        return Kind.WOULD if self._would_have_heard(sensors, surfaces, sign) else Kind.REST

    def _has_heard(self, name: str, surfaces: set[int], point: Point) -> bool:
        since_us = self._loop.simulation.now_us - _HEARD_US
        echoes = deque([False], maxlen=_NEAR_PINGS)
        for ping in self._pings[name]:
            if ping.at_us < since_us:
                continue
            now = self._is_echo_of(name, ping, surfaces, point)
            if now and any(echoes):
                return True
            echoes.append(now)
        return False

    def _is_echo_of(self, name: str, ping: _Ping, surfaces: set[int], point: Point) -> bool:
        """Whether the sensor has truly heard that place of one of these surfaces, as it must have."""
        if ping.measured is None:
            return False
        sonar = self._sonar(name)
        hit = sonar.sure_echo(ping.pose)
        if hit is None or hit.surface not in surfaces or abs(hit.distance - ping.measured) > NEARLY:
            return False
        return math.dist(sonar.echo_point(ping.pose, hit), point) <= _BESIDE

    def _would_have_heard(self, sensors: list[str], surfaces: set[int], sign: float) -> bool:
        end = self._world.plant.path_length
        if sign != self._sign or end - self._turned_back < _WAY:
            return False
        pings = sorted(ping for name in sensors for ping in self._pings[name] if ping.path >= end - _WAY)
        moving = [ping for before, ping in pairwise(pings) if ping.path - before.path > _MOVED]
        heard = sum(any(self._would_hear(name, ping.pose, surfaces) for name in sensors) for ping in moving)
        return bool(moving) and heard >= _SHARE * len(moving)

    def _would_hear(self, name: str, pose: Pose, surfaces: set[int]) -> bool:
        hit = self._sonar(name).sure_echo(pose)
        return hit is not None and hit.surface in surfaces

    def _speed(self) -> float:
        """m/s along x over the last steps before this one, in which the touch has stopped the robot."""
        return _along(self._poses[0], self._poses[-1]) / ((len(self._poses) - 1) * self._world.step_us * 1e-6)

    def _clearance(self, surface: int) -> float:
        x, y, _ = self._world.plant.pose
        return self._world.room.distance(surface, x, y) - ROBOT.footprint_radius

    def _sonar(self, name: str) -> Sonar:
        return self._world.sonars[ULTRASONIC[name].index]


def _along(first: Pose, last: Pose) -> float:
    """m from one pose to the other along its x."""
    return (last.x - first.x) * math.cos(last.yaw) + (last.y - first.y) * math.sin(last.yaw)

"""What has echoed lately and may lie where no sensor looks now: beside the robot, or in the strip between the cones."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import msgspec

from giraff_guard.config import GuardConfig
from giraff_guard.motion import Place
from giraff_guard.sensor import Ping, Sensor

_MOST: Final = 64
"""Echoes kept, whatever comes."""
_SURE: Final = 3
"""Echoes from one place: neither something that moves, nor two wild readings."""


class _Echo(msgspec.Struct):
    """A surface, as a point in the frame of `Place`."""

    x: float
    y: float
    sensor: str
    ends: tuple[tuple[float, float], tuple[float, float]]
    """Where else it may be: at either edge of the cone that it was seen in."""
    robot_ns: int
    travel: float
    seen: int = 1
    contradicted: int = 0


class Obstruction(NamedTuple):
    """A remembered echo in the way."""

    distance: float
    """m along the path until the footprint would touch it."""
    sensor: str
    """Which has heard it."""
    bearing: float
    """rad from the robot's heading, left positive."""


class Echoes:
    """Remembers, merges and forgets."""

    def __init__(self, config: GuardConfig, footprint_radius: float) -> None:
        self._footprint_radius = footprint_radius
        self.reconfigure(config)
        self._echoes: list[_Echo] = []

    def reconfigure(self, config: GuardConfig) -> None:
        """Judge by this from now on."""
        self._config = config
        self._reach = self._footprint_radius + config.memory_margin

    def clear(self) -> None:
        self._echoes.clear()

    def take(self, sensor: Sensor, ping: Ping, travel: float) -> None:
        """A reading; `travel`: m the robot has come since the beginning.

        An echo is remembered, and counts once two more came from the same place.
        What the sensor would hear now, wherever in its cone it was, and does not, is gone at the second reading.
        """
        view = _View(sensor, ping.place)
        half_cone = self._config.half_cone
        for echo in self._echoes:
            if all(view.holds(x, y, 1.02 * half_cone, ping.distance - self._config.agreement) for x, y in echo.ends):
                echo.contradicted += 1
        self._echoes = [echo for echo in self._echoes if echo.contradicted < 2][-_MOST:]
        if not ping.echo or ping.distance > self._config.memory_range:
            return
        x, y = view.point(ping.distance, 0.0)
        ends = (view.point(ping.distance, -half_cone), view.point(ping.distance, half_cone))
        seen = 1
        for echo in self._echoes:
            if echo.sensor == sensor.name and math.hypot(echo.x - x, echo.y - y) < self._config.agreement:
                seen = echo.seen + 1
                self._echoes.remove(echo)
                break
        self._echoes.append(
            _Echo(x=x, y=y, sensor=sensor.name, ends=ends, robot_ns=ping.robot_ns, travel=travel, seen=seen)
        )

    def forget(self, robot_ns: int, travel: float) -> None:
        """Drop what is too old, or too far back on the way for odometry."""
        self._echoes = [
            echo
            for echo in self._echoes
            if (robot_ns - echo.robot_ns) * 1e-9 <= self._config.memory_time
            and travel - echo.travel <= self._config.memory_travel
        ]

    def first_in_the_way(self, place: Place, sign: float, curvature: float = 0.0) -> Obstruction | None:
        """What a footprint driving forward (1) or backward (-1) meets first.

        `curvature`: angular_z / linear_x, 1/m: the arc's centre lies 1/curvature to the left, whichever way it goes.
        """
        found: Obstruction | None = None
        for echo in self._echoes:
            if echo.seen < _SURE:
                continue
            x, y = _seen_from(place, echo)
            distance = _until_touch(x * sign, y, curvature, self._reach)
            if distance is not None and (found is None or distance < found.distance):
                found = Obstruction(distance, echo.sensor, math.atan2(y, x))
        return found

    def touching(self, place: Place) -> str:
        """The sensor whose echo lies within the footprint and its margin; empty where none does."""
        for echo in self._echoes:
            if echo.seen >= _SURE and math.hypot(*_seen_from(place, echo)) < self._reach:
                return echo.sensor
        return ""


class _View:
    """What a sensor looks at, with the robot at `place`."""

    def __init__(self, sensor: Sensor, place: Place) -> None:
        cos, sin = math.cos(place.yaw), math.sin(place.yaw)
        self._x = place.x + cos * sensor.pose.x - sin * sensor.pose.y
        self._y = place.y + sin * sensor.pose.x + cos * sensor.pose.y
        self._axis = place.yaw + sensor.pose.yaw

    def point(self, distance: float, off: float) -> tuple[float, float]:
        """The point `distance` m away, `off` rad beside the axis."""
        return self._x + distance * math.cos(self._axis + off), self._y + distance * math.sin(self._axis + off)

    def holds(self, x: float, y: float, half_cone: float, distance: float) -> bool:
        """Whether a point lies within the cone and nearer than `distance` m."""
        off = math.remainder(math.atan2(y - self._y, x - self._x) - self._axis, math.tau)
        return abs(off) <= half_cone and math.hypot(x - self._x, y - self._y) < distance


def _seen_from(place: Place, echo: _Echo) -> tuple[float, float]:
    """An echo in the robot's frame."""
    cos, sin = math.cos(place.yaw), math.sin(place.yaw)
    x, y = echo.x - place.x, echo.y - place.y
    return cos * x + sin * y, cos * y - sin * x


def _until_touch(x: float, y: float, curvature: float, radius: float) -> float | None:
    """m that a disc at the origin goes along x, or on the arc about (0, 1/curvature), until it touches (x, y).

    None when it never does. What it already covers is in the way of going nearer, and only of that.
    """
    if math.hypot(x, y) < radius:
        return 0.0 if x > 0.0 else None
    if abs(curvature) < 1e-3:
        if x <= 0.0 or abs(y) >= radius:
            return None
        return x - math.sqrt(radius * radius - y * y)
    turn = 1.0 / curvature
    to_centre = math.hypot(x, y - turn)
    if to_centre < 1e-9:
        return None  # the arc goes round it
    cos = (turn * turn + to_centre * to_centre - radius * radius) / (2.0 * abs(turn) * to_centre)
    if cos >= 1.0:
        return None
    if cos <= -1.0:
        return 0.0  # on the rim, and every way round leads over it
    # Angles about the arc's centre, in the direction of travel.
    angle = math.atan2(x, turn - y) if turn > 0.0 else math.atan2(x, y - turn)
    turned = (angle - math.acos(cos)) % math.tau
    return abs(turn) * turned if turned < math.tau - 1e-6 else 0.0  # it touches already, but for rounding

"""What has echoed lately and may lie where no sensor looks now: beside the robot, or in the strip between the cones."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

import msgspec

from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_guard.config import GuardConfig
from giraff_guard.geometry import Point, View, until_touch
from giraff_guard.sensor import Ping, Sensor

_MOST: Final = 64
"""Echoes kept, whatever comes."""
_SURE: Final = 3
"""Echoes from one place: neither something that moves, nor two wild readings."""


class _Echo(msgspec.Struct):
    """A surface, as a point in the frame of `Pose`."""

    x: float
    y: float
    sensor: str
    ends: tuple[Point, Point]
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
    is_old: bool
    """Whether it was heard so long ago that it may have gone."""


class Echoes:
    """Remembers, merges and forgets."""

    def __init__(self, live: Live[GuardConfig], footprint_radius: float) -> None:
        self._footprint_radius = footprint_radius
        self._live = live
        self._echoes: list[_Echo] = []

    def clear(self) -> None:
        self._echoes.clear()

    def take(self, sensor: Sensor, ping: Ping, travel: float) -> None:
        """A reading; `travel`: m the robot has come since the beginning.

        An echo is remembered, and counts once two more came from the same place.
        What the sensor would hear now, wherever in its cone it was, and does not, is gone at the second reading.
        """
        view = View(sensor.pose, ping.place)
        config = self._live.config
        half_cone = config.half_cone
        for echo in self._echoes:
            if all(view.holds(x, y, 1.02 * half_cone, ping.distance - config.agreement) for x, y in echo.ends):
                echo.contradicted += 1
        self._echoes = [echo for echo in self._echoes if echo.contradicted < 2][-_MOST:]
        if not ping.echo or ping.distance > config.memory_range:
            return
        x, y = view.point(ping.distance, 0.0)
        ends = (view.point(ping.distance, -half_cone), view.point(ping.distance, half_cone))
        seen = 1
        for echo in self._echoes:
            if echo.sensor == sensor.name and math.hypot(echo.x - x, echo.y - y) < config.agreement:
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
            if (robot_ns - echo.robot_ns) * 1e-9 <= self._live.config.memory_time
            and travel - echo.travel <= self._live.config.memory_travel
        ]

    def in_the_way(self, place: Pose, sign: float, robot_ns: int, curvature: float = 0.0) -> Iterator[Obstruction]:
        """What a footprint driving forward (1) or backward (-1) meets.

        `curvature`: angular_z / linear_x, 1/m: the arc's centre lies 1/curvature to the left, whichever way it goes.
        """
        reach = self._reach
        for echo in self._echoes:
            if echo.seen < _SURE:
                continue
            x, y = place.sees(echo.x, echo.y)
            distance = until_touch(x * sign, y, curvature, reach)
            if distance is not None:
                is_old = (robot_ns - echo.robot_ns) * 1e-9 > self._live.config.memory_block
                yield Obstruction(distance, echo.sensor, math.atan2(y, x), is_old)

    def touching(self, place: Pose) -> str:
        """The sensor whose echo lies within the footprint and its margin; empty where none does."""
        for echo in self._echoes:
            if echo.seen >= _SURE and math.hypot(*place.sees(echo.x, echo.y)) < self._reach:
                return echo.sensor
        return ""

    @property
    def _reach(self) -> float:
        """m from the robot's middle, within which an echo is in its way."""
        return self._footprint_radius + self._live.config.memory_margin

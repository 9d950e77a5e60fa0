"""What the sensors of one way have surely heard, and may only have ceased to hear."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_guard.config import GuardConfig
from giraff_guard.geometry import Point, View, until_touch
from giraff_guard.sensor import Ping, Sensor

_MOST: Final = 128
"""Spots kept, whatever comes."""


class _Spot(NamedTuple):
    """Where an echo came from, in the frame of `Pose`."""

    points: tuple[Point, ...]
    """Ahead of the sensor, and at either edge of its cone: a slanted wall answers from there."""
    sensor: str
    robot_ns: int
    is_sure: bool


class Heard(NamedTuple):
    """A spot in the way."""

    distance: float
    """m until the footprint would touch what stands there."""
    sensor: str
    """Which has heard it."""


class RecentObstacles:
    """Spots where something was heard, for `held_time`.

    Nothing else ends one. What is heard elsewhere does not say that it has gone, and neither does a farther echo from
    there: the robot may have moved, and heard it past its edge. Where the wheels' counters break off, the robot has
    stood, or nearly.
    """

    def __init__(self, live: Live[GuardConfig], footprint_radius: float) -> None:
        self._footprint_radius = footprint_radius
        self._live = live
        self._spots: list[_Spot] = []

    def take(self, sensor: Sensor, ping: Ping, *, is_sure: bool) -> None:
        """An echo that its sensor has heard twice. `is_sure`: at one ping and the next."""
        if ping.distance > self._live.config.held_range:
            return
        view, half_cone = View(sensor.pose, ping.place), self._live.config.half_cone
        points = tuple(view.point(ping.distance, off) for off in (0.0, -half_cone, half_cone))
        near = self._live.config.agreement
        kept = [spot for spot in self._spots if spot.is_sure > is_sure or math.dist(spot.points[0], points[0]) >= near]
        self._spots = [*kept[1 - _MOST :], _Spot(points, sensor.name, ping.robot_ns, is_sure)]

    def forget(self, robot_ns: int) -> None:
        """Drop what is too old."""
        oldest_ns = robot_ns - round(self._live.config.held_time * 1e9)
        self._spots = [spot for spot in self._spots if spot.robot_ns >= oldest_ns]

    def ahead(self, place: Pose, sign: float) -> Heard | None:
        """What a footprint that drives straight forward (1) or backward (-1) meets first."""
        return self._first(self._spots, place, sign, self._live.config.held_radius, 0.0)

    def beside(self, place: Pose, sign: float) -> Heard | None:
        """What it comes to, or is, close beside: the surface goes on there, and one driven along may be grazed.

        Only what is sure: a slanted wall that answers now and then, far beside the way, would slow at every turn.
        """
        sure = [spot for spot in self._spots if spot.is_sure]
        return self._first(sure, place, sign, self._live.config.held_beside, self._footprint_radius)

    def _first(self, spots: list[_Spot], place: Pose, sign: float, margin: float, behind: float) -> Heard | None:
        """What the footprint and `margin` m around it meet first, or cover from `behind` m behind its middle on."""
        reach = self._footprint_radius + margin
        found: Heard | None = None
        for spot in spots:
            for point in spot.points:
                x, y = place.sees(*point)
                is_covered = math.hypot(x, y) < reach and x * sign > -behind
                distance = 0.0 if is_covered else until_touch(x * sign, y, 0.0, reach)
                if distance is not None and (found is None or distance < found.distance):
                    found = Heard(distance, spot.sensor)
        return found

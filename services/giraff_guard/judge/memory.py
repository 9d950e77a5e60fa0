"""What has echoed lately and may lie where no sensor looks now: beside the robot, or in the strip between the cones."""

import math
from collections.abc import Iterator
from typing import Final, NamedTuple

import msgspec

from giraff_core.kinematics.pose import Pose
from giraff_guard.geometry import Point, View, until_touch
from giraff_guard.limits import SIGN, DriveDirection, Limits
from giraff_guard.source import Beam
from giraff_schemas.messages import DirectionLimit
from giraff_schemas.trouble import Trouble

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
    """The sensor that has seen it."""
    bearing: float
    """rad from the robot's heading, left positive."""
    is_old: bool
    """Whether it was heard so long ago that it may have gone."""


class Echoes:
    """Remembers, merges and forgets."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._echoes: list[_Echo] = []

    def clear(self) -> None:
        self._echoes.clear()

    def on_beam(self, beam: Beam, travel: float) -> None:
        """Take a look of a sensor. `travel`: m the robot has come since the beginning.

        An echo is remembered, and counts once two more came from the same place. Two looks that should have met it,
        wherever in its cone it was, and did not, delete it.
        """
        view = View(beam.mount, beam.place)
        config, half_cone = self._limits.config, beam.half_cone
        for echo in self._echoes:
            if all(view.holds(x, y, 1.02 * half_cone, beam.distance - config.range_tolerance) for x, y in echo.ends):
                echo.contradicted += 1
        self._echoes = [echo for echo in self._echoes if echo.contradicted < 2][-_MOST:]
        if not beam.is_echo or beam.distance > config.memory_range:
            return
        x, y = view.point(beam.distance, 0.0)
        ends = (view.point(beam.distance, -half_cone), view.point(beam.distance, half_cone))
        seen = 1
        for echo in self._echoes:
            if echo.sensor == beam.sensor and math.hypot(echo.x - x, echo.y - y) < config.range_tolerance:
                seen = echo.seen + 1
                self._echoes.remove(echo)
                break
        self._echoes.append(
            _Echo(x=x, y=y, sensor=beam.sensor, ends=ends, robot_ns=beam.robot_ns, travel=travel, seen=seen)
        )

    def forget(self, robot_ns: int, travel: float) -> None:
        """Drop what is too old, or too far back on the way for odometry."""
        self._echoes = [
            echo
            for echo in self._echoes
            if (robot_ns - echo.robot_ns) * 1e-9 <= self._limits.config.memory_time
            and travel - echo.travel <= self._limits.config.memory_travel
        ]

    def verdicts(self, place: Pose, way: DriveDirection, robot_ns: int) -> list[DirectionLimit]:
        """The verdict of what limits most, straight on; empty: nothing does."""
        obstruction = min(self.in_the_way(place, way, robot_ns), key=self.speed_towards, default=None)
        if obstruction is None:
            return []
        limits, allowed = self._limits, self.speed_towards(obstruction)
        side = "left" if obstruction.bearing > 0.0 else "right"
        reason = Trouble(f"{obstruction.sensor} has seen something to the {side}, where no sensor looks now")
        if allowed < limits.config.min_speed:
            return [limits.block(obstruction.sensor, reason)]
        return [limits.allow(allowed, obstruction.sensor, reason)]

    def speed_towards(self, obstruction: Obstruction) -> float:
        """m/s from which the robot stops `margin` before what is remembered; slow at least where that is old.

        Of that margin the strip that is swept already holds `memory_margin`; beside it, no more is kept: a way past
        what was heard stays one.
        """
        config = self._limits.config
        room = obstruction.distance - max(0.0, config.margin - config.memory_margin)
        allowed = self._limits.fastest(room)
        return max(allowed, config.untrusted_speed) if obstruction.is_old else allowed

    def in_the_way(
        self, place: Pose, way: DriveDirection, robot_ns: int, curvature: float = 0.0
    ) -> Iterator[Obstruction]:
        """What a footprint driving this way meets.

        `curvature`: angular_z / linear_x, 1/m: the arc's centre lies 1/curvature to the left, whichever way it goes.
        """
        sign, reach = SIGN[way], self._limits.swept_radius
        for echo in self._echoes:
            if echo.seen < _SURE:
                continue
            x, y = place.sees(echo.x, echo.y)
            distance = until_touch(x * sign, y, curvature, reach)
            if distance is not None:
                is_old = (robot_ns - echo.robot_ns) * 1e-9 > self._limits.config.memory_block
                yield Obstruction(distance, echo.sensor, math.atan2(y, x), is_old)

    def touching(self, place: Pose) -> str:
        """The sensor whose echo lies within the footprint and its margin; empty where none does."""
        for echo in self._echoes:
            if echo.seen >= _SURE and math.hypot(*place.sees(echo.x, echo.y)) < self._limits.swept_radius:
                return echo.sensor
        return ""

"""What the sensors of one way have surely heard, and may only have ceased to hear."""

import math
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_guard.geometry import Point, View, until_touch
from giraff_guard.limits import SIGN, DriveDirection, Limits
from giraff_guard.motion import RecentTravel
from giraff_guard.source import Beam, Sight
from giraff_schemas.messages import DirectionLimit
from giraff_schemas.trouble import Trouble

_MOST: Final = 128
"""Spots kept, whatever comes."""
_STUTTER: Final = 1.5
"""Times the speed that is allowed: a robot that is hardly too fast is slowed by its level, not braked in turns."""


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
    """Spots where something was heard, for `silent_time`.

    Nothing else ends one. What is heard elsewhere does not say that it has gone, and neither does a farther echo from
    there: the robot may have moved, and heard it past its edge. Where the wheels' counters break off, the robot has
    stood, or nearly.
    """

    def __init__(self, way: DriveDirection, limits: Limits) -> None:
        self._sign = SIGN[way]
        self._limits = limits
        self._spots: list[_Spot] = []

    def on_beam(self, beam: Beam) -> None:
        """Keep where an echo came from that its sensor has heard twice."""
        config = self._limits.config
        if not beam.is_repeated or beam.distance > config.silent_range:
            return
        view, half_cone, is_sure = View(beam.mount, beam.place), beam.half_cone, beam.is_sure
        points = tuple(view.point(beam.distance, off) for off in (0.0, -half_cone, half_cone))
        near = config.range_tolerance
        kept = [spot for spot in self._spots if spot.is_sure > is_sure or math.dist(spot.points[0], points[0]) >= near]
        self._spots = [*kept[1 - _MOST :], _Spot(points, beam.sensor, beam.robot_ns, is_sure)]

    def forget(self, robot_ns: int) -> None:
        """Drop what is too old."""
        oldest_ns = robot_ns - round(self._limits.config.silent_time * 1e9)
        self._spots = [spot for spot in self._spots if spot.robot_ns >= oldest_ns]

    def verdicts(self, silent: list[Sight], motion: RecentTravel) -> list[DirectionLimit]:
        """Limit the speed towards recent echoes. A sensor that no longer hears them may be deaf.

        It blocks for a moment, and says so; then it may be approached as slowly as what no sensor has proved.
        """
        limits, config, names = self._limits, self._limits.config, " and ".join(sight.sensor for sight in silent)
        silence_s = min((sight.silent_s for sight in silent if sight.silent_s is not None), default=math.inf)
        slow = config.untrusted_speed
        verdicts = []
        if heard := self.ahead(motion.place):
            room, speed = heard.distance - config.margin, motion.speed(self._sign)
            reason = Trouble(f"{names}: silent where {heard.sensor} heard something until lately")
            if limits.stops_within(speed) > room and (speed > _STUTTER * slow or silence_s < config.silent_block):
                verdicts.append(limits.block(silent[0].sensor, reason))
            else:
                allowed = max(slow, limits.fastest(room))
                verdicts.append(limits.allow(allowed, silent[0].sensor, reason))
        if heard := self.beside(motion.place):
            reason = Trouble(f"{names}: silent beside where {heard.sensor} heard something until lately")
            verdicts.append(limits.allow(max(slow, limits.fastest(heard.distance)), silent[0].sensor, reason))
        return verdicts

    def ahead(self, place: Pose) -> Heard | None:
        """What a footprint that drives straight on meets first."""
        return self._first(self._spots, place, self._limits.config.silent_radius, 0.0)

    def beside(self, place: Pose) -> Heard | None:
        """What it comes to, or is, close beside: the surface goes on there, and one driven along may be grazed.

        Only what is sure: a slanted wall that answers now and then, far beside the way, would slow at every turn.
        """
        sure = [spot for spot in self._spots if spot.is_sure]
        return self._first(sure, place, self._limits.config.silent_beside, self._limits.footprint_radius)

    def _first(self, spots: list[_Spot], place: Pose, margin: float, behind: float) -> Heard | None:
        """What the footprint and `margin` m around it meet first, or cover from `behind` m behind its middle on."""
        sign, reach = self._sign, self._limits.footprint_radius + margin
        found: Heard | None = None
        for spot in spots:
            for point in spot.points:
                x, y = place.sees(*point)
                is_covered = math.hypot(x, y) < reach and x * sign > -behind
                distance = 0.0 if is_covered else until_touch(x * sign, y, 0.0, reach)
                if distance is not None and (found is None or distance < found.distance):
                    found = Heard(distance, spot.sensor)
        return found

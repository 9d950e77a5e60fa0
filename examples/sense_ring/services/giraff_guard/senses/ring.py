"""Infrared rings as a sense of the guard: points all round, of the last two looks."""

import math
from collections.abc import Sequence

from giraff_core.freshness import age
from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses.ring import IrRing
from giraff_guard.config import GuardConfig
from giraff_guard.geometry import Point, View
from giraff_guard.limits import DriveDirection
from giraff_guard.motion import RecentTravel
from giraff_guard.source import Beam, Points, Sight, Source
from giraff_schemas.messages import RobotTime
from giraff_schemas.ring import RingLook
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_ONE_LOOK = Trouble("has told one look, and needs two", "wait")
_Look = tuple[RobotTime, Pose, list[Point]]
"""Its moment, the robot's place then, and the points that were seen."""


class RingSource(Source):
    """All rings of one robot. Of each sensor the nearer of two looks counts, so that one wild look opens nothing."""

    sense, sees_ahead = IrRing, True

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig) -> None:
        super().__init__(live, robot)
        self._rings = robot.of(IrRing)
        self._looks: dict[str, list[_Look]] = {name: [] for name in self._rings}

    def covers(self, way: DriveDirection) -> Sequence[str]:
        """Return all rings: each looks all round."""
        del way
        return list(self._rings)

    def on_sample(self, sample: RingLook, motion: RecentTravel, now: RobotTime) -> Sequence[Beam]:
        """Keep a look and the one before it, unless the ring was silent between them."""
        name, ring, at = sample.sensor, self._rings[sample.sensor], sample.tick or now
        place = motion.place_at(at.robot_ns)
        view, budget = View(Pose(ring.x, ring.y, ring.yaw), place), self.live.config.range_budget
        last = [look for look in self._looks[name][-1:] if age(look[0], at) <= budget]
        self._looks[name] = [*last, (at, place, [view.point(far, off) for far, off in ring.seen(sample)])]
        return ()

    def sight(self, sensor: str, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> Sight:
        """Return the points of two looks. After a silence the ring is blind until there are two."""
        del way, motion, now
        looks = self._looks[sensor]
        if len(looks) < 2:
            return Sight(sensor, blind=_ONE_LOOK.of(sensor))
        points, ring = [point for _, _, seen in looks for point in seen], self._rings[sensor]
        reach = ring.radius + ring.reach - math.hypot(ring.x, ring.y)
        return Sight(sensor, points=Points(points, 0.0, reach, looks[-1][1]))

    def trouble(self, sensor: str, motion: RecentTravel, now: RobotTime) -> Trouble:
        """Return that one that is heard is trusted."""
        del sensor, motion, now
        return NO_TROUBLE

    def forget(self) -> None:
        """Begin anew."""
        self._looks = {name: [] for name in self._rings}

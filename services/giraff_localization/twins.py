"""Places that were candidates once, and explain what is heard as well as the best one does.

Particles forget them: of two rooms that are equal, one has none left after some metres. So they are carried along by
the best one's motion, and dropped only when they explain less.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Final

from giraff_core.kinematics.pose import Pose
from giraff_localization.cloud import Beam
from giraff_localization.clusters import are_near
from giraff_localization.fit import Fit, compare
from giraff_localization.floor import Floor
from giraff_localization.way import Stride

_WORSE: Final = 0.08
"""Of the readings, that a twin explains less than the best: it is none."""
_YOUNG: Final = 1.0
"""m, in which nothing is said of a twin yet."""
_MOST: Final = 8
_LEAP: Final = 0.5
"""m or rad beside odometry's: the best place is another one now."""


class _Twin:
    def __init__(self, pose: Pose, fit: Fit) -> None:
        self.pose, self.fit, self.age = pose, fit, 0.0


class Twins:
    """Of one search."""

    def __init__(self, floor: Floor) -> None:
        self._floor = floor
        self._twins: list[_Twin] = []
        self._best: Pose | None = None
        self._fit = Fit()
        """Of the best place, whichever it is."""

    @property
    def poses(self) -> list[Pose]:
        return [twin.pose for twin in self._twins]

    def follow(
        self, best: Pose | None, stride: Stride, beams: Sequence[Beam], candidates: Iterable[Pose], *, known: bool
    ) -> None:
        """Go along with the robot. `candidates`: other places that particles have; `known`: of the best place before,
        something was known already."""
        before, self._best = self._best, best if best is not None else self._best
        if before is None or self._best is None or not beams:
            return
        step = self._best.seen_from(before)
        raw = Pose(stride.x, stride.y, stride.turn)
        if math.dist(step[:2], raw[:2]) > _LEAP or abs(math.remainder(step.yaw - raw.yaw, math.tau)) > _LEAP:
            if known:
                self._twins.append(_Twin(before, self._fit.copy()))
            step = raw
        self._fit.add(compare(self._floor, self._best, beams), stride.effort)
        for twin in self._twins:
            twin.pose = step.placed_in(twin.pose)
            twin.fit.add(compare(self._floor, twin.pose, beams), stride.effort)
            twin.age += stride.effort
        here = self._best
        self._twins = [
            twin
            for twin in self._twins
            if not are_near(twin.pose, here) and (twin.age < _YOUNG or twin.fit.share > self._fit.share - _WORSE)
        ][-_MOST:]
        for pose in candidates:
            if not any(are_near(pose, other) for other in (here, *self.poses)):
                self._twins.append(_Twin(pose, self._fit.copy()))

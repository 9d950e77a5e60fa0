"""The way a robot has gone, in as many points as a picture needs: however long it drives, their number is bounded."""

from __future__ import annotations

import math
from typing import Final

Point = tuple[float, float]

_STEP: Final = 0.02  # m between two points at first
_MOST: Final = 1000  # points; then every other one is dropped, and the step is doubled


class Trail:
    """Of one robot, in `odom`."""

    def __init__(self) -> None:
        self.points: list[Point] = []
        self.unseen: list[bool] = []
        """For each point, whether no camera has seen the step to it."""
        self._step = _STEP
        self._segment: object = None

    def go_on(self, x: float, y: float, segment: object, *, unseen: bool = False) -> bool:
        """Whether the trail has changed. `segment`: `Odometry.segment`; where it is another, no robot has gone that
        way, and a new trail begins."""
        if self._segment != segment:
            self.points, self.unseen, self._step, self._segment = [(x, y)], [unseen], _STEP, segment
            return True
        if math.dist(self.points[-1], (x, y)) < self._step:
            return False
        self.points.append((x, y))
        self.unseen.append(unseen)
        if len(self.points) > _MOST:
            self.points, self.unseen = self.points[::2], self.unseen[::2]
            self._step *= 2.0
        return True

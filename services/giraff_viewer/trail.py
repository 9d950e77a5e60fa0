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
        self._step = _STEP
        self._origin: tuple[str, int] | None = None

    def go_on(self, x: float, y: float, origin: tuple[str, int]) -> bool:
        """Whether the trail has changed. `origin`: `Odometry.origin`; where it is another, no robot has gone that way,
        and a new trail begins."""
        if self._origin != origin:
            self.points, self._step, self._origin = [(x, y)], _STEP, origin
            return True
        if math.dist(self.points[-1], (x, y)) < self._step:
            return False
        self.points.append((x, y))
        if len(self.points) > _MOST:
            self.points = self.points[::2]
            self._step *= 2.0
        return True

"""The way a robot has gone, in as many points as a picture needs: however long it drives, their number is bounded."""

from __future__ import annotations

import math
from typing import Final

Point = tuple[float, float]

_STEP: Final = 0.02  # m between two points at first
_MOST: Final = 1000  # points; then every other one is dropped, and the step is doubled
_JUMP: Final = 0.5  # m within one sample: odometry has begun anew


class Trail:
    """Of one robot, in `odom`."""

    def __init__(self) -> None:
        self.points: list[Point] = []
        self._step = _STEP
        self._maker = ""

    def go_on(self, x: float, y: float, maker: str) -> bool:
        """Whether the trail has changed. `maker`: the odometry's instance; another one begins at its own origin."""
        jumped = self.points and math.dist(self.points[-1], (x, y)) > max(_JUMP, 2 * self._step)
        if maker != self._maker or not self.points or jumped:
            self.points, self._step, self._maker = [(x, y)], _STEP, maker
            return True
        if math.dist(self.points[-1], (x, y)) < self._step:
            return False
        self.points.append((x, y))
        if len(self.points) > _MOST:
            self.points = self.points[::2]
            self._step *= 2.0
        return True

"""Lines of the floor plan, in metres, each in its own frame (REP-103: x forward, y left)."""

import math
from typing import Final

from giraff_core.kinematics.pose import ELLIPSE_95

Point = tuple[float, float]
Strip = list[Point]

NORMAL_95: Final = 1.96
"""Standard deviations to either side within which 95 of 100 numbers lie."""

_FARTHEST: Final = 1000.0  # m: whoever is less sure than that of where a robot is draws a circle as large as any floor
_NUMBERED: Final = 8
"""m across, over which each line may have its number."""
_STEP: Final = 0.02  # m between two points of a trail at first
_MOST: Final = 1000  # points of a trail; then every other one is dropped, and the step is doubled


class Trail:
    """The way a robot has gone, in `odom`. The number of its points is bounded, however long the robot drives."""

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


def outline(radius: float, track_width: float) -> list[Strip]:
    """The robot seen from above: its footprint, its wheels, and a nose that points forward."""
    half, wheel = track_width / 2.0, min(0.1, radius / 3.0)
    wheels: list[Strip] = [[(-wheel, side * half), (wheel, side * half)] for side in (1.0, -1.0)]
    nose: Strip = [(radius * 0.5, radius * 0.3), (radius * 0.95, 0.0), (radius * 0.5, -radius * 0.3)]
    return [arc(radius, math.tau, 48), nose, *wheels]


def ellipse(xx: float, xy: float, yy: float) -> Strip:
    """Within which the origin lies with 95 %, by the covariance of its place, m²; closed."""
    middle, off = (xx + yy) / 2.0, math.hypot((xx - yy) / 2.0, xy)
    # The eigenvalues are middle ± off; rounding makes the smaller one of a line negative.
    long, short = (min(ELLIPSE_95 * math.sqrt(max(0.0, value)), _FARTHEST) for value in (middle + off, middle - off))
    along = math.atan2(2.0 * xy, xx - yy) / 2.0
    return placed([(long * x, short * y) for x, y in arc(1.0, math.tau, 48)], 0.0, 0.0, along)


def headings(variance: float, length: float) -> list[Strip]:
    """Between which a heading along the x axis lies with 95 %, by its variance, rad²."""
    half = min(NORMAL_95 * math.sqrt(max(0.0, variance)), math.pi)
    return [[(0.0, 0.0), _at(length, bearing)] for bearing in (half, -half)]


def grid(west: int, south: int, east: int, north: int) -> tuple[list[Strip], dict[Point, str]]:
    """Return lines a metre apart over a piece of floor, and the numbers along its southern and western edge.

    On a large piece only every second one has its number, or fewer have: there is no room for more.
    """
    step = 1 + (east - west) // _NUMBERED
    across: list[Strip] = [[(west, y), (east, y)] for y in range(south, north + 1)]
    along: list[Strip] = [[(x, south), (x, north)] for x in range(west, east + 1)]
    numbers = {(float(x), float(south)): f"x {x} m" for x in range(west + 1, east, step)}
    return across + along, numbers | {(float(west), float(y)): f"y {y} m" for y in range(south + 1, north, step)}


def placed(strip: Strip, x: float, y: float, yaw: float) -> Strip:
    """Of a thing at this pose, in the frame of the pose."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    return [(x + cos * ahead - sin * left, y + sin * ahead + cos * left) for ahead, left in strip]


def arc(radius: float, angle: float, pieces: int) -> Strip:
    """About the origin and the x axis."""
    return [_at(radius, angle * (piece / pieces - 0.5)) for piece in range(pieces + 1)]


def _at(distance: float, bearing: float) -> Point:
    return distance * math.cos(bearing), distance * math.sin(bearing)

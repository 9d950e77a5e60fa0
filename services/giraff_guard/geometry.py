"""What a sensor looks at, and what the footprint sweeps."""

import math

from giraff_core.kinematics.pose import Pose

Point = tuple[float, float]
"""x, y in m."""


class View:
    """The field of a sensor, with the robot at `place`."""

    def __init__(self, mount: Pose, place: Pose) -> None:
        """`mount`: place and axis of the sensor in `base_link`."""
        cos, sin = math.cos(place.yaw), math.sin(place.yaw)
        self._x = place.x + cos * mount.x - sin * mount.y
        self._y = place.y + sin * mount.x + cos * mount.y
        self._axis = place.yaw + mount.yaw

    def point(self, distance: float, off: float) -> Point:
        """The point `distance` m away, `off` rad beside the axis."""
        return self._x + distance * math.cos(self._axis + off), self._y + distance * math.sin(self._axis + off)

    def holds(self, x: float, y: float, half_cone: float, distance: float) -> bool:
        """Whether a point lies within the cone and nearer than `distance` m."""
        off = math.remainder(math.atan2(y - self._y, x - self._x) - self._axis, math.tau)
        return abs(off) <= half_cone and math.hypot(x - self._x, y - self._y) < distance


def until_touch(x: float, y: float, curvature: float, radius: float) -> float | None:
    """m that a disc at the origin goes along x, or on the arc about (0, 1/curvature), until it touches (x, y).

    None when it never does. What it already covers is in the way of going nearer, and only of that.
    """
    if math.hypot(x, y) < radius:
        return 0.0 if x > 0.0 else None
    if abs(curvature) < 1e-3:
        if x <= 0.0 or abs(y) >= radius:
            return None
        return x - math.sqrt(radius * radius - y * y)
    turn = 1.0 / curvature
    to_centre = math.hypot(x, y - turn)
    if to_centre < 1e-9:
        return None  # the arc goes round it
    cos = (turn * turn + to_centre * to_centre - radius * radius) / (2.0 * abs(turn) * to_centre)
    if cos >= 1.0:
        return None
    if cos <= -1.0:
        return 0.0  # on the rim, and every way round leads over it
    # Angles about the arc's centre, in the direction of travel.
    angle = math.atan2(x, turn - y) if turn > 0.0 else math.atan2(x, y - turn)
    turned = (angle - math.acos(cos)) % math.tau
    return abs(turn) * turned if turned < math.tau - 1e-6 else 0.0  # it touches already, but for rounding

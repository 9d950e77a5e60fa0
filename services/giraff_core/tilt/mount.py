"""The attitude of a tilt sensor in its joystick. Axes of both: x grows when tilted forward, y to the left, z is up."""

import math
from typing import Final

from giraff_core.tilt.clutch import Vector

Rows = tuple[Vector, Vector, Vector]
"""Axes of the joystick in the sensor: what a reading is multiplied by to be in the joystick's axes."""

_UPRIGHT: Final = 1e-9
"""Cosine of the pitch below which roll and yaw turn about the same axis."""


class Mount:
    """A sensor's attitude: rad, about the joystick's fixed axes, first roll, then pitch, then yaw (REP-103)."""

    def __init__(self, roll: float, pitch: float, yaw: float) -> None:
        self._rows = rows_of(roll, pitch, yaw) if roll or pitch or yaw else None

    def in_joystick(self, vector: Vector) -> Vector:
        """Return what the sensor reads in the joystick's axes. A sensor that is not turned: exactly what it reads."""
        if self._rows is None:
            return vector
        x, y, z = (dot(row, vector) for row in self._rows)
        return x, y, z


def rows_of(roll: float, pitch: float, yaw: float) -> Rows:
    """Return the rotation of these angles, rad."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(angle), math.sin(angle)) for angle in (roll, pitch, yaw))
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def angles_of(rows: Rows) -> Vector:
    """Return roll, pitch and yaw of a rotation, rad."""
    (xx, xy, _), (yx, yy, _), (zx, zy, zz) = rows
    upright = math.hypot(zy, zz)
    pitch = math.atan2(-zx, upright)
    if upright < _UPRIGHT:
        return 0.0, pitch, math.atan2(-xy, yy)
    return math.atan2(zy, zz), pitch, math.atan2(yx, xx)


def dot(one: Vector, other: Vector) -> float:
    """Return the sum of the products."""
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


def cross(one: Vector, other: Vector) -> Vector:
    """Return the vector that is square to both, by the right hand."""
    (a, b, c), (x, y, z) = one, other
    return b * z - c * y, c * x - a * z, a * y - b * x

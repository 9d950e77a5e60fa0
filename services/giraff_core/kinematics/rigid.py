"""Where one thing is in another, in space: composition and inverse of rigid transforms.

Angles are REP-103's roll, pitch and yaw about fixed axes: R = Rz(yaw) Ry(pitch) Rx(roll).
"""

import math
from typing import Final, NamedTuple

Row = tuple[float, float, float]


class Rigid(NamedTuple):
    """A rotation, by rows, and then a translation, m."""

    rotation: tuple[Row, Row, Row]
    translation: Row

    @property
    def inverse(self) -> "Rigid":
        """Where the outer frame is in the inner one."""
        columns = _transposed(self.rotation)
        x, y, z = (_dot(column, self.translation) for column in columns)
        return Rigid(columns, (-x, -y, -z))

    def then(self, inner: "Rigid") -> "Rigid":
        """Where `inner`, which is given in this frame, is in the frame in which this one is given."""
        columns = _transposed(inner.rotation)
        first, second, third = (
            (_dot(row, columns[0]), _dot(row, columns[1]), _dot(row, columns[2])) for row in self.rotation
        )
        return Rigid((first, second, third), self.moved(inner.translation))

    def moved(self, point: Row) -> Row:
        """A point of this frame, in the frame in which this one is given; m."""
        x, y, z = (_dot(row, point) + offset for row, offset in zip(self.rotation, self.translation, strict=True))
        return x, y, z

    @property
    def angles(self) -> tuple[float, float, float]:
        """Roll, pitch and yaw, rad: pitch in [-π/2, π/2], the others in [-π, π].

        Roll is what is left once yaw is taken back. So they make this very rotation where it looks straight up or down,
        too, and only the difference of roll and yaw, or their sum, can be told.
        """
        (ahead, across, up), (aside, upright, over), (down, _, _) = self.rotation
        yaw = math.atan2(aside, ahead)
        cos, sin = math.cos(yaw), math.sin(yaw)
        roll = math.atan2(sin * up - cos * over, cos * upright - sin * across)
        return roll, math.atan2(-down, math.hypot(ahead, aside)), yaw


def rigid(x: float, y: float, z: float, roll: float, pitch: float, yaw: float) -> Rigid:
    """Of m and rad."""
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    rotation = (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )
    return Rigid(rotation, (x, y, z))


HERE: Final = rigid(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""Nothing moved, nothing turned."""


def _dot(a: Row, b: Row) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _transposed(rows: tuple[Row, Row, Row]) -> tuple[Row, Row, Row]:
    a, b, c = rows
    return (a[0], b[0], c[0]), (a[1], b[1], c[1]), (a[2], b[2], c[2])

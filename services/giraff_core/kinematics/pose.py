"""Place and heading in a plane, and the ellipse of a place that is not sure."""

import math
from typing import Final, NamedTuple

ELLIPSE_95: Final = math.sqrt(-2.0 * math.log(0.05))
"""The Mahalanobis distance of the edge of the ellipse within which a place that is not exactly known lies with 95 %.

Chi-square of two degrees of freedom is below its square, 5.991, with 95 %."""
_RESOLUTION: Final = 1e-3  # m, standard deviation on either axis: encoders count no finer than half of it


class Pose(NamedTuple):
    """m, m, rad, in a frame that its user names. Axes are REP-103's: x ahead, y to the left."""

    x: float
    y: float
    yaw: float

    def moved(self, distance: float, turn: float) -> "Pose":
        """After an arc of `distance` m that turns by `turn` rad, a small one: the arc is taken for its chord."""
        middle = self.yaw + turn / 2.0
        return Pose(self.x + distance * math.cos(middle), self.y + distance * math.sin(middle), self.yaw + turn)

    def ahead(self, other: "Pose", axis: float) -> float:
        """m that `other` lies ahead of here, along a direction that is `axis` rad off this heading."""
        direction = self.yaw + axis
        return (other.x - self.x) * math.cos(direction) + (other.y - self.y) * math.sin(direction)

    def towards(self, other: "Pose", share: float) -> "Pose":
        """Return the pose at this share of the way to `other`, 0..1, the shorter turn there."""
        turn = math.remainder(other.yaw - self.yaw, math.tau)
        return Pose(
            self.x + share * (other.x - self.x),
            self.y + share * (other.y - self.y),
            math.remainder(self.yaw + share * turn, math.tau),
        )

    def sees(self, x: float, y: float) -> tuple[float, float]:
        """A point of the frame, as m ahead of here and m to the left."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        x, y = x - self.x, y - self.y
        return cos * x + sin * y, cos * y - sin * x

    def seen_from(self, origin: "Pose") -> "Pose":
        """This pose in the frame whose origin is `origin`."""
        x, y = self.x - origin.x, self.y - origin.y
        cos, sin = math.cos(origin.yaw), math.sin(origin.yaw)
        return Pose(x * cos + y * sin, y * cos - x * sin, math.remainder(self.yaw - origin.yaw, math.tau))

    def placed_in(self, frame: "Pose") -> "Pose":
        """The inverse of `seen_from`: this pose, given in `frame`, where `frame` itself is given."""
        cos, sin = math.cos(frame.yaw), math.sin(frame.yaw)
        x, y = self.x * cos - self.y * sin, self.x * sin + self.y * cos
        return Pose(frame.x + x, frame.y + y, math.remainder(self.yaw + frame.yaw, math.tau))


def mahalanobis(x: float, y: float, xx: float, xy: float, yy: float) -> float:
    """How far (x, y), m, is off by a covariance, m², in standard deviations: what is finer than 1 mm is no error.

    P. C. Mahalanobis, On the generalised distance in statistics, Proceedings of the National Institute of Sciences of
    India 2 (1936).
    """
    xx, yy = xx + _RESOLUTION**2, yy + _RESOLUTION**2
    return math.sqrt(max(0.0, (yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy)))

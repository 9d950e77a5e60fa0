"""Of a place on the plane that is not exactly known: the ellipse within which it lies with 95 %."""

from __future__ import annotations

import math
from typing import Final

ELLIPSE_95: Final = math.sqrt(-2.0 * math.log(0.05))
"""The Mahalanobis distance of its edge: chi-square of two degrees of freedom is below its square, 5.991, with 95 %."""

_RESOLUTION: Final = 1e-3  # m, standard deviation on either axis: encoders count no finer than half of it


def mahalanobis(x: float, y: float, xx: float, xy: float, yy: float) -> float:
    """How far (x, y), m, is off by a covariance, m², in standard deviations: what is finer than 1 mm is no error.

    P. C. Mahalanobis, On the generalised distance in statistics, Proceedings of the National Institute of Sciences of
    India 2 (1936).
    """
    xx, yy = xx + _RESOLUTION**2, yy + _RESOLUTION**2
    return math.sqrt(max(0.0, (yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy)))

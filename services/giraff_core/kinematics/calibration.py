"""What a calibration has found of wheels and track, and how sure it is: the table `[robot.calibration]`."""

import math
from typing import Annotated, Final, NamedTuple

import msgspec

from giraff_core.bounds import Bounds, check_bounds

Covariance = tuple[float, float, float, float, float, float]
"""Of three values a, b, c: aa, ab, ac, bb, bc, cc."""

EXACTLY: Final[Covariance] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""Of what nobody doubts."""
_SCALE: Final = Bounds(0.5, 2.0, "", "is this a percentage?")
_WHEEL_SD: Final = 0.012
_TRACK_SD: Final = 0.018
"""Of a robot that nobody has calibrated: wheels within 2 % of their file, track within 3 %, up to 1 % lost in turns."""
_MOST_SD: Final = 0.1
"""Of each scale. Whoever is less sure than that has measured nothing, and six robots drawn by it would be none."""
_SURE: Final = 1e-10
"""Variance below which a combination of the three counts as known: rounding makes as much."""


class Scales(NamedTuple):
    """Factors on what the robot file says of wheels and track."""

    left_wheel: float
    right_wheel: float
    track: float


class Calibration(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Written by `giraff calibrate odometry`. The defaults are those of a robot that was never calibrated."""

    date: str = ""
    """Of the calibration, as 2026-11-25; empty: there was none."""
    left_wheel_scale: Annotated[float, _SCALE] = 1.0
    """m truly rolled for each metre that `ticks_per_metre` makes of the encoder's counts."""
    right_wheel_scale: Annotated[float, _SCALE] = 1.0
    track_scale: Annotated[float, _SCALE] = 1.0
    """Of `track_width`; what the wheels lose by scrubbing in each turn is in it."""
    covariance: Covariance = (_WHEEL_SD**2, 0.0, 0.0, _WHEEL_SD**2, 0.0, _TRACK_SD**2)
    """Of (left_wheel_scale, right_wheel_scale, track_scale)."""
    end_error_before: Annotated[float, Bounds(0.0, 100.0, "m")] = 0.0
    """m; mean error of the end of the runs that the fit did not see, by the values before it."""
    end_error_after: Annotated[float, Bounds(0.0, 100.0, "m")] = 0.0
    """m; the same by these values."""

    def __post_init__(self) -> None:
        check_bounds(self)
        cholesky(self.covariance)
        aa, _, _, bb, _, cc = self.covariance
        if (most := max(aa, bb, cc)) > _MOST_SD**2:
            raise ValueError(
                f"covariance has a variance of {most:g}: it must be {_MOST_SD**2:g} at most, a deviation of "
                f"{_MOST_SD:.0%}; are these percentages, or deviations?"
            )

    @property
    def scales(self) -> Scales:
        """What was found."""
        return Scales(self.left_wheel_scale, self.right_wheel_scale, self.track_scale)

    def sigma_points(self) -> tuple[Scales, ...]:
        """Six equally likely robots whose scales have the mean and the covariance that were found.

        The third-degree spherical-radial points: I. Arasaratnam, S. Haykin, Cubature Kalman Filters, IEEE Transactions
        on Automatic Control 54 (2009), equation 32: a standard deviation times √3 along each column of the root.
        """
        root, mean = cholesky(self.covariance), self.scales
        columns = [tuple(math.sqrt(3.0) * row[column] for row in root) for column in range(3)]
        return tuple(
            Scales(*(middle + sign * off for middle, off in zip(mean, column, strict=True)))
            for column in columns
            for sign in (1.0, -1.0)
        )


def cholesky(covariance: Covariance) -> tuple[tuple[float, float, float], ...]:
    """Rows of the lower triangle L with L Lᵀ = covariance, of what may be known exactly, too.

    Raises ValueError where it is none: where some combination would have a negative variance.
    """
    aa, ab, ac, bb, bc, cc = covariance
    full = ((aa, ab, ac), (ab, bb, bc), (ac, bc, cc))
    if not all(math.isfinite(value) for value in covariance):
        raise ValueError(f"covariance {covariance} has no number in it where one belongs")
    root = [[0.0] * 3 for _ in range(3)]
    for row in range(3):
        for column in range(row + 1):
            rest = full[row][column] - sum(root[row][k] * root[column][k] for k in range(column))
            if row == column:
                if rest < -_SURE:
                    raise ValueError(f"covariance {covariance} is none: a variance in it is negative")
                root[row][row] = math.sqrt(rest) if rest > _SURE else 0.0
            elif root[column][column]:
                root[row][column] = rest / root[column][column]
            elif abs(rest) > math.sqrt(_SURE):
                raise ValueError(f"covariance {covariance} is none: what is known exactly varies with the rest")
    return tuple((row[0], row[1], row[2]) for row in root)

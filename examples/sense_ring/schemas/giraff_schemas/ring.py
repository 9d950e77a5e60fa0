"""Samples of the infrared ring."""

from typing import Final

from giraff_schemas.checks import require_finite
from giraff_schemas.messages import RobotTime, Sample

SENSORS: Final = 16
"""Number 0 looks ahead; the others follow counter-clockwise."""

_M = float | None
Distances = tuple[_M, _M, _M, _M, _M, _M, _M, _M, _M, _M, _M, _M, _M, _M, _M, _M]


class RingLook(Sample, frozen=True, kw_only=True):
    """One look of all sensors of a ring."""

    sensor: str
    """Name in the robot file, as in the key."""
    distances: Distances
    """m from each sensor; None: nothing is within its reach."""
    tick: RobotTime | None
    """Newest moment that the service held before the sensors measured."""

    def __post_init__(self) -> None:
        require_finite(self, *(each for each in self.distances if each is not None))

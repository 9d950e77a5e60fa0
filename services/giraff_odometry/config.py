"""The table `[odometry]` of the robot file. Track width and counts per metre are in `[robot]`."""

import math
from typing import Annotated

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.tuning import Tuning


class OdometryConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the wheels can do, and how far they are trusted."""

    max_wheel_speed: Annotated[float, Tuning.FREE, Bounds(0.05, 20.0, "m/s")] = 1.5
    """m/s beyond which a wheel's travel between two samples is not believed: above anything the motors can do."""
    max_gap: Annotated[float, Tuning.FREE, Bounds(0.02, 10.0, "s")] = 0.5
    """s of the board's time between two samples above which the way between them is a guess."""
    lost_position: Annotated[float, Tuning.FREE, Bounds(0.0, 10.0, "m")] = 0.2
    """m: standard deviation, on either axis, of what was missed when the counters could not be followed."""
    lost_yaw: Annotated[float, Tuning.FREE, Bounds(0.0, math.tau, "rad")] = 0.35
    """rad: the same of the heading."""

    def __post_init__(self) -> None:
        check_bounds(self)

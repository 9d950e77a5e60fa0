"""The table `[recorder]` of the robot file."""

from typing import Annotated, ClassVar

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.tuning import Tuning


class RecorderConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How far back it remembers, and how much of a disk it may fill."""

    LIVE: ClassVar = Tuning.READ_ONLY

    before: Annotated[float, Bounds(0.1, 3600.0, "s")] = 60.0
    """s before an event that are kept."""
    after: Annotated[float, Bounds(0.1, 3600.0, "s")] = 5.0
    """s after it that are."""
    memory: Annotated[int, Bounds(1000, 10**11, "bytes")] = 32_000_000
    """bytes that samples in memory may take; beyond them the oldest are forgotten early. A minute of a whole robot
    takes half of it. Samples of keys that are not the robot's go first while they have more than a quarter."""
    files: Annotated[int, Bounds(1, 100_000)] = 20
    """Files that are kept; then the oldest goes. The first of each kind in the past week goes last."""
    disk: Annotated[int, Bounds(100, 10**15, "bytes")] = 100_000_000
    """bytes that all files together may have; beyond them the oldest goes. A minute takes 3 million."""
    health_period: Annotated[float, Bounds(0.1, 3600.0, "s")] = 5.0
    """s between two questions to the robot's services how they are."""

    def __post_init__(self) -> None:
        check_bounds(self)

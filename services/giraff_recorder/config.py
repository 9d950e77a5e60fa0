"""The table `[recorder]` of the robot file."""

from __future__ import annotations

from typing import ClassVar

import msgspec

from giraff_node.config import require_positive
from giraff_node.live import Live


class RecorderConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How far back it remembers, and how much of a disk it may fill."""

    LIVE: ClassVar = Live.FIXED

    before: float = 60.0
    """s before an event that are kept."""
    after: float = 5.0
    """s after it that are."""
    memory: int = 32_000_000
    """bytes that what is remembered may take; beyond them the oldest is forgotten early. A minute of a whole robot
    takes half of it."""
    files: int = 20
    """Files that are kept; then the oldest goes."""
    disk: int = 100_000_000
    """bytes that all files together may have; beyond them the oldest goes. A minute takes 3 million."""
    health_period: float = 5.0
    """s between two questions to the robot's services how they are."""

    def __post_init__(self) -> None:
        require_positive(self, *self.__struct_fields__)

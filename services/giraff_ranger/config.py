"""The table `[ranger]` of the robot file. Names, numbers and poses of the sensors are in `[robot]`."""

from typing import ClassVar

import msgspec

from giraff_core.tuning import Tuning


class RangerConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where the ranger board is."""

    LIVE: ClassVar = Tuning.READ_ONLY

    port: str = "/dev/giraff-ranger"
    """Path of the board's serial port."""

    def __post_init__(self) -> None:
        if not self.port:
            raise ValueError("port is empty: give the path of the ranger board's serial port")

"""The table `[ring]` of the robot file. Its place on the robot is in `[robot]`."""

from typing import ClassVar

import msgspec

from giraff_core.tuning import Tuning


class RingConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Which device it is."""

    LIVE: ClassVar = Tuning.READ_ONLY

    port: str = "/dev/giraff-ring"
    """Path of the Arduino's serial port."""
    name: str = "ring"
    """Name of the sensor in the robot file."""

"""The table `[vision]` of the robot file."""

from typing import ClassVar

import msgspec

from giraff_core.tuning import Tuning


class VisionConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Which camera is looked through. Where it is, and its lens: `[robot.sensors.<name>]`."""

    LIVE: ClassVar = Tuning.READ_ONLY

    camera: str = ""
    """Name of its table in [robot.sensors]. Empty: the robot's only camera."""

"""The table `[scan]` of the robot file. The scanner's place on the robot is in `[robot]`."""

from typing import ClassVar

import msgspec

from giraff_core.robot import RobotConfig
from giraff_core.senses import LaserScanner
from giraff_core.tuning import Tuning
from giraff_schemas.topics import require_chunk


class ScanConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Port and name of the scanner."""

    LIVE: ClassVar = Tuning.READ_ONLY

    port: str = "/dev/giraff-scan"
    """Path of its serial port."""
    name: str = "laser"
    """Name of the sensor in the robot file."""

    def __post_init__(self) -> None:
        require_chunk(self.name)
        if not self.port:
            raise ValueError("port is empty: give the path of the scanner's serial port")


def scanner_of(config: ScanConfig, robot: RobotConfig) -> LaserScanner:
    """Return the scanner that the table means. Raises ValueError: the robot has none of that name."""
    scanners = robot.of(LaserScanner)
    if config.name not in scanners:
        there = ", ".join(scanners) or "none"
        raise ValueError(
            f"[scan] name is {config.name!r}, and the robot's laser scanners are: {there}; "
            f'add [robot.sensors.{config.name}] with type = "{LaserScanner.type_name()}", or give another name'
        )
    return scanners[config.name]

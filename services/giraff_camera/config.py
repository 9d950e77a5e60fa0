"""The table `[camera]` of the robot file."""

from typing import Annotated, ClassVar

import msgspec

from giraff_core.bounds import Bounds, check_bounds
from giraff_core.robot import RobotConfig
from giraff_core.senses import Camera as CameraModel
from giraff_core.tuning import Tuning


class CameraConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Which camera it is, and how its pictures are sent. Where it is and its size: `[robot.sensors.<name>]`."""

    LIVE: ClassVar = Tuning.READ_ONLY

    name: str = ""
    """Name of its table in [robot.sensors]. Empty: the robot's only camera."""
    device: str = "/dev/video0"
    """Path of the camera; one below /dev/v4l/by-id names the same one wherever it is plugged in. A Unix socket there is
    the simulated camera's."""
    rate: Annotated[float, Bounds(0.5, 60.0, "Hz")] = 15.0
    """Hz at most."""
    quality: Annotated[int, Bounds(10, 95)] = 80
    """JPEG quality, 0 to 100, of a picture that is not too large."""
    max_bytes: Annotated[int, Bounds(2_000, 60_000, "bytes")] = 40_000
    """Bytes of a picture at most. Zenoh carries 65 536 bytes here."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if not self.device:
            raise ValueError("device is empty: give the path of the camera, like /dev/video0")


def camera_of(config: CameraConfig, robot: RobotConfig) -> tuple[str, CameraModel]:
    """Return the name and the table of the camera that the robot file means. Raises ValueError."""
    return robot.camera(config.name, "[camera] name")

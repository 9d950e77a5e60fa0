"""Pictures of a camera, and who sees them: it sends none unless somebody has asked for it and is still there."""

from __future__ import annotations

from typing import Final, Literal

import msgspec

from giraff_schemas.checks import require_finite
from giraff_schemas.messages import RobotTime, Sample

PictureSize = Literal["full", "small"]
"""In `camera/<name>/@<size>`. `full`: as the robot file has it. `small`: half as wide and high, with as few bytes as
the slowest link asks for."""

HOLD_ENDS: Final = 2.0
"""s after its last word that somebody counts as gone: also the age beyond which a word turns nothing on."""


class Picture(Sample, frozen=True, kw_only=True):
    """One picture."""

    camera: str
    """Name in the robot file, as in the key."""
    jpeg: bytes
    width: int
    """px."""
    height: int
    tick: RobotTime | None
    """Newest moment the camera's computer held when the exposure began. None: it has not heard base yet."""
    exposure: float | None = None
    """s that the light was taken; None: the camera does not tell."""

    def __post_init__(self) -> None:
        if self.exposure is not None:
            require_finite(self, self.exposure)


class CameraHold(Sample, frozen=True, kw_only=True):
    """Somebody looks at a camera, said upon each state and each picture of it that has come.

    It counts for one start of the camera's process and while its state is new: a word that was late, and one from
    before a restart, turn nothing on.
    """

    camera: str
    to: str
    """Instance of the camera's process, as it was when somebody asked for the picture."""
    state: int
    """`seq` of its newest state that has come."""
    by: str
    """Who looks, for people: "web@laptop (Android phone at 192.168.1.7)"."""
    size: PictureSize
    """Of the pictures that it listens to now."""
    seen: int = -1
    """`seq` of the newest picture of this size that has come; -1: none has."""
    largest: PictureSize = "full"
    """That it wants. A page behind a slow link of its own asks for the small one."""


class Asker(msgspec.Struct, frozen=True, kw_only=True):
    """Who looks at a camera now."""

    instance: str
    """Of its holds."""
    by: str
    size: PictureSize
    """It is to listen to pictures of this size: those that its link carries within 60 ms."""
    transfer: float | None = None
    """s that its last picture took on its way, without the way's own delay; None: it was not measured yet."""
    is_late: bool = False
    """It has not confirmed its last picture within a second. Others do not wait for it."""

    def __post_init__(self) -> None:
        if self.transfer is not None:
            require_finite(self, self.transfer)


class CameraState(Sample, frozen=True, kw_only=True):
    """How a camera is, and who sees its pictures. It sends pictures while there is an asker, and only then."""

    camera: str
    askers: tuple[Asker, ...]
    width: int
    """px of a full picture, as the robot file asks for."""
    height: int
    rate: float
    """Hz. Pictures that the camera took in the last second."""
    reason: str
    """Why there are no pictures though somebody looks, with the way out; empty: nothing is wrong."""
    remedy: str = ""
    """Tail of `reason`: what to do about it."""

    def __post_init__(self) -> None:
        require_finite(self, self.rate)

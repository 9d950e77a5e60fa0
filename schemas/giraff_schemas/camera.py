"""Pictures of a camera, and who sees them: it sends none unless somebody has asked for it and is still there."""

from typing import Final, Literal

import msgspec

from giraff_schemas.checks import require_finite
from giraff_schemas.messages import RobotTime, Sample
from giraff_schemas.trouble import NO_TROUBLE, Trouble

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
    since_tick: float = 0.0
    """s from the tick's arrival at the camera's computer until the exposure began."""

    def __post_init__(self) -> None:
        require_finite(self, self.since_tick, self.exposure or 0.0)


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
    reason: Trouble = NO_TROUBLE
    """Cause of missing pictures while somebody looks."""

    def __post_init__(self) -> None:
        require_finite(self, self.rate)


Step = tuple[float, float, float]
"""x and y in m, yaw in rad: a pose in an earlier `base_link`, which is the motion since then."""
Pixel = tuple[int, int]
"""Column and row of a picture, from its left upper corner."""


class VisualOdometry(Sample, frozen=True, kw_only=True):
    """How a camera sees the robot move over the floor, said of each picture, or why it cannot tell.

    Motion is told since a key picture. Each key picture but the first is the last one that was told since the key
    picture before it.
    """

    camera: str
    picture: int
    """`seq` of the picture."""
    tick: RobotTime | None
    """As of the picture."""
    since_tick: float = 0.0
    """s from that tick's arrival at the camera's computer until the middle of the exposure."""
    key: int
    """Number of the key picture, from 0."""
    reason: Trouble = NO_TROUBLE
    """Cause, where this is no measurement."""
    motion: Step | None
    """Motion since the key picture, as the picture has it. Where there is a reason it is no measurement: what was seen
    and is not believed. None: nothing was seen."""
    covariance: tuple[float, float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """Covariance of the motion's (x, y, yaw): xx, xy, xyaw, yy, yyaw, yawyaw; m², m·rad, rad². It counts what is
    random: a height of the camera that is wrong by 1 % makes each way wrong by 1 %. Zeros: the picture is not sure of
    its motion. It may be sure though the wheels disagree."""
    wheels: Step | None = None
    """Motion since the key picture, by the wheels; None: they were not heard all the time."""
    path: Step
    """Pose in the `base_link` of the first picture: what was measured, and what the wheels say where nothing was."""
    seen_m: float = 0.0
    """m of the path that were measured."""
    blind_m: float = 0.0
    """m of the path that are the wheels' word."""
    width: int = 0
    """px; size of the picture, which the pixels below are of."""
    height: int = 0
    tracked: tuple[Pixel, ...] = ()
    """Corners on the floor that move as the motion has it."""
    rejected: tuple[Pixel, ...] = ()
    """Corners that were followed and do not."""
    ground: tuple[Pixel, ...] = ()
    """Outline of the floor that corners are looked for on."""

    def __post_init__(self) -> None:
        steps = (self.path, self.motion or (), self.wheels or (), self.covariance)
        require_finite(self, self.since_tick, self.seen_m, self.blind_m, *(number for step in steps for number in step))

    @property
    def is_measured(self) -> bool:
        """Whether the motion is a measurement."""
        return not self.reason

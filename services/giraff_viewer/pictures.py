"""What a robot's cameras see, each picture with its age. Nothing is decoded: the viewer reads JPEG itself."""

import math
from typing import Final

import rerun as rr

from giraff_core.freshness import age_here
from giraff_schemas.camera import Picture
from giraff_schemas.messages import RobotTime, Tick
from giraff_viewer.colours import LEVELS, WHITE
from giraff_viewer.rows import Row

OLD: Final = 0.5
"""s beyond which a picture says nothing of now."""


def picture_path(camera: str) -> str:
    """Return where the pictures of a camera are drawn."""
    return f"camera/{camera}"


class Pictures:
    """The newest picture of each camera. Times are ns of the listener's clock."""

    def __init__(self) -> None:
        self._tick: tuple[RobotTime, int] | None = None
        self._newest: dict[str, Picture] = {}
        self._texts: dict[str, str] = {}

    @property
    def cameras(self) -> tuple[str, ...]:
        """Those that a picture was heard of."""
        return tuple(self._newest)

    def size(self, camera: str) -> tuple[float, float] | None:
        """Return width and height of the newest picture of a camera, px; None: there is none."""
        picture = self._newest.get(camera)
        return None if picture is None else (picture.width, picture.height)

    def on_sample(self, sample: Tick | Picture, at_ns: int) -> list[Row]:
        """Return what a picture draws. A tick is the robot's clock, by which a picture's age is told."""
        if isinstance(sample, Tick):
            self._tick = RobotTime(epoch=sample.epoch, robot_ns=sample.robot_ns), at_ns
            return []
        picture = sample
        self._newest[picture.camera] = picture
        image = rr.EncodedImage(contents=picture.jpeg, media_type="image/jpeg")
        return [(picture_path(picture.camera), image), *self._write(picture, at_ns)]

    def update(self, now_ns: int) -> list[Row]:
        """Return what the time that passes changes: a picture that was not followed by another is old."""
        return [
            row
            for picture in self._newest.values()
            if self.age(picture, now_ns) > OLD
            for row in self._write(picture, now_ns)
        ]

    def age(self, picture: Picture, now_ns: int) -> float:
        """Return s since the exposure began; infinite where nothing tells."""
        if self._tick is None:
            return math.inf
        tick, at_ns = self._tick
        return age_here(picture.tick, tick, (now_ns - at_ns) * 1e-9)

    def _write(self, picture: Picture, now_ns: int) -> list[Row]:
        age = self.age(picture, now_ns)
        is_old = age > OLD
        text = _age_text(age)
        if text == self._texts.get(picture.camera):
            return []
        self._texts[picture.camera] = text
        place = [[picture.width / 2.0, picture.height * 0.93]]
        colour = LEVELS["ERROR"] if is_old else WHITE
        label = rr.Points2D(place, labels=[text], colors=[colour], radii=[1.0])
        return [(f"{picture_path(picture.camera)}/age", label)]


def _age_text(age: float) -> str:
    if math.isinf(age):
        return "OLD: nothing tells its age"
    if age > OLD:
        return f"OLD: {math.floor(age)} s" if age >= 1.0 else f"OLD: over {OLD:g} s"
    return f"{age:.2f} s"

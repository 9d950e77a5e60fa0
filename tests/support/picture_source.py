"""A camera that somebody has asked for its pictures, without a network."""

from giraff_schemas.camera import CameraState, Picture, PictureSize
from giraff_schemas.trouble import NO_TROUBLE


class Source:
    """A `PictureSource` whose pictures are given beforehand."""

    def __init__(self, camera: str = "head", by: str = "", *coming: Picture) -> None:
        self.camera, self.by = camera, by
        self.coming = list(coming)
        self.trouble = NO_TROUBLE
        self.asked: list[PictureSize] = []
        self.closed = False

    @property
    def state(self) -> CameraState | None:
        return CameraState(camera=self.camera, askers=(), width=320, height=240, rate=15.0)

    def ask(self, largest: PictureSize = "full") -> Picture | None:
        self.asked.append(largest)
        return self.next_picture()

    def next_picture(self) -> Picture | None:
        return self.coming.pop(0) if self.coming else None

    def close(self) -> None:
        self.closed = True


class Sources:
    """Opens a source of this kind each time that a camera is asked."""

    def __init__(self, kind: type[Source] = Source) -> None:
        self._kind = kind
        self.opened: list[Source] = []

    def __call__(self, camera: str, by: str) -> Source:
        self.opened.append(self._kind(camera, by))
        return self.opened[-1]

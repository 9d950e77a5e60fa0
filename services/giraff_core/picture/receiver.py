"""Receives pictures of a robot's cameras: asks while somebody looks, and says why none comes. No I/O and no clock."""

import math
from collections.abc import Callable
from typing import Any, Final, Protocol

from giraff_schemas.camera import CameraState, Picture, PictureSize
from giraff_schemas.messages import Sample
from giraff_schemas.topics import CAMERA, CAMERA_SMALL, Topic
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_FULL_WITHIN: Final = 2.0
"""s after the first small picture in which a full one comes, where the link carries it."""


class PictureSource(Protocol):
    """One wish to see what a camera sees: `giraff_node.picture_client.PictureClient` in a process. No call waits."""

    by: str
    """Who looks, for people."""

    @property
    def state(self) -> CameraState | None: ...
    @property
    def trouble(self) -> Trouble: ...
    def ask(self, largest: PictureSize = "full") -> Picture | None: ...
    def close(self) -> None: ...


OpenSource = Callable[[str, str], PictureSource]
"""Takes the camera's name, and who looks."""


class _Camera:
    """A camera that was asked."""

    def __init__(self, source: PictureSource) -> None:
        self.source = source
        self.told = NO_TROUBLE
        self.small: Picture | None = None
        self.small_since = math.inf

    def ask(self, by: str, largest: PictureSize = "full") -> Picture | None:
        self.source.by = by
        return self.source.ask(largest)

    def is_full(self, picture: Picture) -> bool:
        return picture.width >= (0 if self.source.state is None else self.source.state.width)


class PictureReceiver:
    """Asks cameras for their pictures from the first look until it is closed. Times are s of any one monotonic clock.

    A camera that has started again shows nothing more: somebody must leave it and ask anew.
    """

    def __init__(self, open_source: OpenSource | None, by: str = "", apart: float = 0.0) -> None:
        """`open_source`: None: nobody may look. `by`: who looks, for people.

        `apart`: s between two starts to look at a camera: each opens a session.
        """
        self._open, self._apart = open_source, apart
        self.by = by
        """Who looks. It may become somebody else."""
        self.heard: dict[str, CameraState] = {}
        """The newest state of each camera that was heard."""
        self._asked: dict[str, _Camera] = {}
        self._opened: dict[str, float] = {}

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """Remember a camera that is heard: the receiver is told of all samples of a connection."""
        del topic, key, at_ns
        if isinstance(sample, CameraState):
            self.heard[sample.camera] = sample

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """Nothing: a camera is known by what it says."""

    def ask(self, camera: str, now: float, largest: PictureSize = "full") -> Picture | None:
        """Say that somebody looks, twice a second at least; return the newest picture that was not taken yet."""
        one = self._opened_camera(camera, now)
        return None if one is None else one.ask(self.by, largest)

    def ask_best(self, camera: str, now: float, *, is_last: bool) -> Picture | None:
        """Prefer a full picture, and return a small one where none comes: everybody begins with small ones.

        `is_last`: it is waited for no longer.
        """
        if (one := self._opened_camera(camera, now)) is None:
            return None
        if (picture := one.ask(self.by)) is not None:
            if one.is_full(picture):
                one.small = None
                return picture
            one.small, one.small_since = picture, min(one.small_since, now)
        if not is_last and now - one.small_since < _FULL_WITHIN:
            return None
        picture, one.small = one.small, None
        return picture

    def ask_all(self, now: float) -> list[tuple[Topic[Picture], Picture]]:
        """As `ask`, of all that are heard; return the new pictures with their topics."""
        return [
            ((CAMERA if one.is_full(picture) else CAMERA_SMALL).at(camera), picture)
            for camera in self.heard
            if (one := self._opened_camera(camera, now)) is not None and (picture := one.ask(self.by)) is not None
        ]

    def trouble(self, camera: str) -> Trouble:
        """Return why there is no picture; NO_TROUBLE: one comes, or may, or nobody looks."""
        one = self._asked.get(camera)
        return NO_TROUBLE if one is None else one.source.trouble

    def new_troubles(self) -> list[str]:
        """Return why there are no pictures, once for each camera and reason."""
        news = []
        for one in self._asked.values():
            if (trouble := one.source.trouble) and trouble != one.told:
                news.append(str(trouble))
            one.told = trouble
        return news

    def leave(self, camera: str) -> None:
        """Look no longer at this camera."""
        if (one := self._asked.pop(camera, None)) is not None:
            one.source.close()

    def close(self) -> None:
        """Look no longer."""
        while self._asked:
            self._asked.popitem()[1].source.close()

    def _opened_camera(self, camera: str, now: float) -> _Camera | None:
        one = self._asked.get(camera)
        if one is None and self._open is not None and now - self._opened.get(camera, -math.inf) >= self._apart:
            self._opened[camera] = now
            one = self._asked[camera] = _Camera(self._open(camera, self.by))
        return one

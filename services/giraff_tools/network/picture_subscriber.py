"""The pictures of a robot's cameras, for who has asked for them: nobody else is sent any."""

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol, Self

from giraff_node.picture_client import PictureClient
from giraff_schemas.camera import CameraState, Picture
from giraff_schemas.messages import Sample
from giraff_schemas.topics import CAMERA, CAMERA_SMALL, Topic
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.program import user_at_host


class ReceivedPicture(NamedTuple):
    """A picture that has come."""

    full_width: int
    """px of a full picture of its camera."""
    picture: Picture

    @property
    def topic(self) -> Topic[Picture]:
        """On which it has come."""
        is_full = self.picture.width >= self.full_width
        return (CAMERA if is_full else CAMERA_SMALL).at(self.picture.camera)


class PictureSource(Protocol):
    """A `PictureClient`."""

    @property
    def state(self) -> CameraState | None: ...
    @property
    def trouble(self) -> Trouble: ...
    def want(self) -> None: ...
    def pop_picture(self) -> Picture | None: ...
    def close(self) -> None: ...


class PictureSubscriber:
    """Asks each camera that is heard for its pictures, until it is closed. It must hear the cameras' states.

    A camera that has started again shows nothing more: somebody must ask anew.
    """

    def __init__(self, open_source: Callable[[str], PictureSource], only: str = "") -> None:
        """`open_source`: asks the camera of this name. `only`: the camera to ask; empty: all."""
        self._open = open_source
        self._only = only
        self._sources: dict[str, PictureSource] = {}
        self._told: dict[str, Trouble] = {}

    @classmethod
    def of(cls, connection: RobotConnection, verb: str, only: str = "") -> Self:
        """Ask in the name of the user who typed this verb."""
        by = f"{user_at_host()} (giraff {verb})"
        return cls(lambda camera: PictureClient(connection.network, connection.robot, camera, by), only)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: object) -> None:
        self.close()

    @property
    def cameras(self) -> tuple[str, ...]:
        """Those that are asked."""
        return tuple(self._sources)

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """Ask a camera that is heard for the first time. As `Listener` has it."""
        del topic, key, at_ns
        if not isinstance(sample, CameraState) or sample.camera in self._sources:
            return
        if self._only in ("", sample.camera):
            self._sources[sample.camera] = self._open(sample.camera)

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """As `Listener` has it."""

    def pop_pictures(self) -> list[ReceivedPicture]:
        """Say that somebody still looks, and return the new pictures; to be called twice a second at least."""
        seen: list[ReceivedPicture] = []
        for source in self._sources.values():
            source.want()
            if (picture := source.pop_picture()) is not None:
                state = source.state
                seen.append(ReceivedPicture(0 if state is None else state.width, picture))
        return seen

    def troubles(self) -> list[str]:
        """Return why there is no picture, once for each camera and reason."""
        news = []
        for camera, source in self._sources.items():
            trouble = source.trouble
            if trouble and trouble != self._told.get(camera, NO_TROUBLE):
                news.append(str(trouble))
            self._told[camera] = trouble
        return news

    def close(self) -> None:
        """Look no longer."""
        while self._sources:
            self._sources.popitem()[1].close()

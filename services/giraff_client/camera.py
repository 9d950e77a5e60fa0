"""What a camera of the robot sees, in a script."""

import math
import time
from collections.abc import Callable
from typing import Any, Final, NamedTuple

import zenoh

from giraff_client.errors import RobotError
from giraff_core.freshness import age_here
from giraff_core.network import NetworkConfig
from giraff_core.picture.receiver import PictureReceiver
from giraff_node.picture_client import PictureClient
from giraff_schemas.camera import Picture
from giraff_schemas.messages import RobotTime, Tick
from giraff_schemas.topics import CAMERA_STATE, key_of

_LOOK: Final = 0.01  # s
_MEET: Final = 0.5  # s in which all cameras are heard: each tells of itself five times a second
_GOES_ON: Final = 0.9  # s between two calls; after more the camera is asked anew, because nobody looks any longer


class CameraPicture(NamedTuple):
    """What a camera has seen."""

    camera: str
    """Its name in the robot file."""
    jpeg: bytes
    width: int
    """px."""
    height: int
    age: float
    """s since the exposure began, when the picture was returned; infinite where nothing tells."""
    tick: RobotTime | None
    """The robot's time before the exposure: `lookup` takes it as its `at`."""


class CameraFinder:
    """Asks the robot's cameras for their pictures."""

    def __init__(self, tick: Callable[[], tuple[Any, float] | None], silence: Callable[[str], RobotError]) -> None:
        """`tick`: the newest, and when it was heard. `silence`: the error that says why something is not heard."""
        self._tick, self._silence = tick, silence
        self._pictures = PictureReceiver(None)
        self._session: zenoh.Session | None = None
        self._key = ""
        self._states: Any = None
        self._there: set[str] = set()
        self._looked: dict[str, float] = {}

    def begin(self, session: zenoh.Session, config: NetworkConfig, robot: str, by: str) -> None:
        """Be on the network. Nothing is asked for yet."""
        self._session, self._key = session, key_of(robot, CAMERA_STATE)
        self._pictures = PictureReceiver(lambda *asked: PictureClient(config, robot, *asked), by)

    def picture(self, camera: str, timeout: float) -> CameraPicture:
        """As `CameraReader` has it."""
        if self._session is None:
            raise self._silence("no camera is heard")
        until = time.monotonic() + timeout
        name = camera or self._only(self._session, until)
        if time.monotonic() - self._looked.get(name, math.inf) > _GOES_ON:
            self._pictures.leave(name)
        picture, why = None, ""
        try:
            while (picture := self._ask(name, until)) is None and self._looked[name] < until:
                time.sleep(_LOOK)
        finally:
            if picture is None:
                why = str(self._pictures.trouble(name))
                self._pictures.leave(name)
        if picture is None:
            raise self._silence(why or f"no picture of the camera {name} came in {timeout:g} s")
        return CameraPicture(name, picture.jpeg, picture.width, picture.height, self._age(picture), picture.tick)

    def _ask(self, name: str, until: float) -> Picture | None:
        now = self._looked[name] = time.monotonic()
        return self._pictures.ask_best(name, now, is_last=now >= until)

    def close(self) -> None:
        """Look no longer."""
        self._pictures.close()

    def _only(self, session: zenoh.Session, until: float) -> str:
        """Return the only camera that is heard. Raises SilentError, ValueError where there are several."""

        def on_state(received: zenoh.Sample) -> None:
            self._there.add(CAMERA_STATE.name_in(str(received.key_expr)))

        if self._states is None:
            self._states = session.declare_subscriber(self._key, on_state)
            time.sleep(_MEET)
        while not self._there and time.monotonic() < until:
            time.sleep(_LOOK)
        there = sorted(self._there)
        if not there:
            raise self._silence("no camera is heard; check that giraff_camera runs, and [camera] of the robot file")
        if len(there) > 1:
            raise ValueError(f"picture: there are the cameras {', '.join(there)}: name one")
        return there[0]

    def _age(self, picture: Picture) -> float:
        tick, heard = self._tick() or (None, 0.0)
        if not isinstance(tick, Tick):
            return math.inf
        return age_here(picture.tick, RobotTime(epoch=tick.epoch, robot_ns=tick.robot_ns), time.monotonic() - heard)


class CameraReader:
    """What of `Robot` is about cameras."""

    _cameras: CameraFinder

    def picture(self, camera: str = "", timeout: float = 5.0) -> CameraPicture:
        """What a camera sees now, as JPEG; `camera`: its name, where the robot has several.

        The robot says to all who looks, until a second after the last call. The first call takes about a second, and
        later ones until the next picture comes. A full picture is waited for; on a link that is too slow for it, small
        ones come. A script that drives calls it in a thread or while the robot stands: `drive` ends after 0.4 s.
        Raises SilentError with the reason where no picture comes in `timeout` s, LostRobotError, ValueError where it
        is not told which camera. The next call after an error asks anew.
        """
        return self._cameras.picture(camera, timeout)

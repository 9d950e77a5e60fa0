"""What a camera of the robot sees, in a script."""

import math
import time
from collections.abc import Callable
from typing import Any, Final, NamedTuple

import zenoh

from giraff_client.errors import RobotError
from giraff_core.freshness import age_here
from giraff_core.network import NetworkConfig
from giraff_core.picture.asker import PictureChoice
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


class _Network(NamedTuple):
    session: zenoh.Session
    config: NetworkConfig
    robot: str
    by: str


class _Looking:
    """One wish to see what a camera sees."""

    def __init__(self, network: _Network, camera: str) -> None:
        self._client = PictureClient(network.config, network.robot, camera, network.by)
        self._choice = PictureChoice()
        self._asked = time.monotonic()

    @property
    def goes_on(self) -> bool:
        """Whether the camera still sends pictures because of it."""
        return time.monotonic() - self._asked <= _GOES_ON

    @property
    def trouble(self) -> str:
        """Why there is no picture."""
        return str(self._client.trouble)

    def wait(self, until: float) -> Picture | None:
        """Return the next picture; None: none came until then, s of the monotonic clock."""
        while True:
            self._asked = time.monotonic()
            self._client.want()
            taken, state = self._client.pop_picture(), self._client.state
            full_width = 0 if state is None else state.width
            if (picture := self._choice.choose(taken, full_width, self._asked)) is not None:
                return picture
            if self._asked >= until:
                return self._choice.give_up()
            time.sleep(_LOOK)

    def close(self) -> None:
        self._client.close()


class CameraFinder:
    """Asks the robot's cameras for their pictures."""

    def __init__(self, tick: Callable[[], tuple[Any, float] | None], silence: Callable[[str], RobotError]) -> None:
        """`tick`: the newest, and when it was heard. `silence`: the error that says why something is not heard."""
        self._tick = tick
        self._silence = silence
        self._network: _Network | None = None
        self._there: set[str] = set()
        self._declared: Any = None
        self._looking: dict[str, _Looking] = {}

    def begin(self, session: zenoh.Session, config: NetworkConfig, robot: str, by: str) -> None:
        """Be on the network. Nothing is asked for yet."""
        self._network = _Network(session, config, robot, by)

    def picture(self, camera: str, timeout: float) -> CameraPicture:
        """As `CameraReader` has it."""
        if self._network is None:
            raise self._silence("no camera is heard")
        until = time.monotonic() + timeout
        name = camera or self._only(self._network, until)
        looking = self._looking.pop(name, None)
        if looking is not None and not looking.goes_on:
            looking.close()
            looking = None
        looking = looking or _Looking(self._network, name)
        picture: Picture | None = None
        try:
            picture = looking.wait(until)
        finally:
            if picture is None:
                looking.close()
        if picture is None:
            raise self._silence(looking.trouble or f"no picture of the camera {name} came in {timeout:g} s")
        self._looking[name] = looking
        return CameraPicture(name, picture.jpeg, picture.width, picture.height, self._age(picture), picture.tick)

    def close(self) -> None:
        """Look no longer."""
        while self._looking:
            self._looking.popitem()[1].close()

    def _only(self, network: _Network, until: float) -> str:
        """Return the only camera that is heard. Raises SilentError, ValueError where there are several."""

        def on_state(received: zenoh.Sample) -> None:
            self._there.add(CAMERA_STATE.name_in(str(received.key_expr)))

        if self._declared is None:
            self._declared = network.session.declare_subscriber(key_of(network.robot, CAMERA_STATE), on_state)
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

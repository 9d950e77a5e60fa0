"""Looks at a camera of the robot: `giraff_core.picture.asker` on the network, in a Zenoh session of its own.

Pictures come over another link than ticks, commands and what the robot tells of itself, which do not wait for them.
"""

import secrets
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any, Final

import zenoh

from giraff_core.network import NetworkConfig
from giraff_core.picture.asker import PictureAsker
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.session import NobodyError, close_session, open_session
from giraff_node.node import Publisher
from giraff_schemas.camera import CameraHold, CameraState, Picture, PictureSize
from giraff_schemas.codec import DecodeError, decode
from giraff_schemas.topics import CAMERA, CAMERA_ON, CAMERA_SMALL, CAMERA_STATE, Topic, key_of
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_AGAIN: Final = 2.0  # s until a network that could not be reached is tried again
_LOOK: Final = 0.05  # s between two looks whether another size is to be listened to


def _now() -> float:
    """Return s of a clock that also counts sleep, where there is one: after sleep a wish is over."""
    return time.clock_gettime(getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC))


class PictureClient:
    """A `PictureSource`: one person's wish. Nobody looks any longer a second after the last `ask`."""

    def __init__(self, network: NetworkConfig, robot: str, camera: str, by: str) -> None:
        """`by`: who looks, for people. Raises ValueError for a camera's name that cannot be one."""
        self._network, self._robot, self._camera = network, robot, camera
        self._topics: dict[PictureSize, Topic[Picture]] = {"full": CAMERA.at(camera), "small": CAMERA_SMALL.at(camera)}
        self.by = by
        """Who looks. It may become somebody else, from the next `ask`."""
        self._instance = secrets.token_hex(8)
        self._asker = PictureAsker(camera, by)
        self._lock = threading.Lock()  # the asker is used by Zenoh's threads, and the holds are counted
        self._newest: Picture | None = None
        self._holds: Publisher[CameraHold] | None = None
        self._unreachable = NO_TROUBLE
        self._closed = threading.Event()
        # No daemon: Zenoh aborts a process that ends while a session is being opened.
        threading.Thread(target=self._run, name=f"camera {camera}").start()

    def ask(self, largest: PictureSize = "full") -> Picture | None:
        """Say that somebody still looks, twice a second at least; return the newest picture that was not taken yet.

        `largest`: that is wanted.
        """
        with self._lock:
            self._asker.by = self.by
            self._asker.want(largest, _now())
            picture, self._newest = self._newest, None
            return picture

    @property
    def state(self) -> CameraState | None:
        """The newest of the camera; None: it was not heard."""
        return self._asker.state

    @property
    def trouble(self) -> Trouble:
        """Why there is no picture; NO_TROUBLE: one comes, or may."""
        with self._lock:
            return self._unreachable or self._asker.trouble(_now())

    def close(self) -> None:
        """Look no longer. The session ends by itself."""
        self._closed.set()

    def _run(self) -> None:
        while not self._closed.is_set():
            try:
                session = open_session(self._network, self._robot, "client")
            except (NobodyError, ConfigError, zenoh.ZError) as error:
                self._unreachable = Trouble(f"no door of the robot answers: {error}", "check the network to the robot")
                self._closed.wait(_AGAIN)
                continue
            self._unreachable = NO_TROUBLE
            self._listen(session)
            close_session(session)

    def _listen(self, session: zenoh.Session) -> None:
        """Until the end. A client's session finds its door again by itself."""
        with self._lock:
            self._holds = Publisher(session, self._robot, CAMERA_ON.at(self._camera), self._instance)
        state = self._subscriber(session, CAMERA_STATE.at(self._camera), self._on_state)
        size = self._asker.size
        while not self._closed.is_set():
            pictures = self._pictures(session, size)
            with self._lock:
                self._asker.listen(size)
            while size == self._asker.size and not self._closed.wait(_LOOK):
                pass
            size = self._asker.size
            with suppress(zenoh.ZError):
                pictures.undeclare()
        with self._lock:
            self._holds = None
        with suppress(zenoh.ZError):
            state.undeclare()

    def _pictures(self, session: zenoh.Session, size: PictureSize) -> Any:
        def on_picture(picture: Picture) -> None:
            with self._lock:
                if self._asker.takes(picture, size):
                    self._newest = picture
                    self._say(self._asker.on_picture(picture, size, _now()))

        return self._subscriber(session, self._topics[size], on_picture)

    def _on_state(self, state: CameraState) -> None:
        with self._lock:
            self._say(self._asker.on_state(state, self._instance, _now()))

    def _say(self, hold: CameraHold | None) -> None:
        if hold is not None and self._holds is not None:
            self._holds.put(hold)

    def _subscriber(self, session: zenoh.Session, topic: Topic[Any], take: Callable[[Any], None]) -> Any:
        def on_sample(received: zenoh.Sample) -> None:
            with suppress(DecodeError):  # of another version: it is as if nothing had come
                take(decode(topic, str(received.key_expr), bytes(received.payload), str(received.encoding)))

        return session.declare_subscriber(key_of(self._robot, topic), on_sample)

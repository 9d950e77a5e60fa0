"""A camera's policy and those who look at it, over links with a rate and a delay, in simulated time."""

import heapq
import itertools
from collections.abc import Iterator
from typing import Any, Final, NamedTuple

from giraff_camera.policy import PicturePolicy
from giraff_core.picture.asker import PictureAsker
from giraff_schemas.camera import CameraHold, CameraState, Picture, PictureSize
from giraff_schemas.codec import stamped
from giraff_schemas.topics import CAMERA_STATE

STEP: Final = 0.001
"""s."""
FULL: Final = 12_000
"""Bytes of a full picture of this scene."""


class Link(NamedTuple):
    """The link of an asker."""

    rate: float
    """bit/s."""
    delay: float
    """s, each way."""


class Came(NamedTuple):
    """A picture that has come."""

    at: float
    size: PictureSize
    bytes: int
    on_the_way: float
    """s that it has kept the link busy, with what was before it there."""


class Viewer:
    """One who looks, until `until`."""

    def __init__(self, name: str, link: Link, until: float) -> None:
        self.name, self.link, self.until = name, link, until
        self.asker = PictureAsker("head", name)
        self.came: list[Came] = []
        self.busy_until = 0.0
        self.said = 0
        self.largest: PictureSize = "full"
        self.sleeps = False
        self.confirms = True
        """It answers pictures, and not states alone."""


class Scene:
    """Runs as long as it is iterated."""

    def __init__(self, *links: Link, until: float = 1e9, instance: str = "camera") -> None:
        self.viewers = [Viewer(f"viewer {n}", link, until) for n, link in enumerate(links)]
        self.start(instance)
        self.now = 0.0
        self._counter = itertools.count()
        self._events: list[tuple[float, int, Any]] = []
        self._next_state = 0.0

    def start(self, instance: str) -> None:
        """Start the camera's process, or another one in its place."""
        self.instance = instance
        self.policy = PicturePolicy("head", instance, 15.0, 40_000)
        self.policy.full_bytes = FULL
        self.sent: dict[PictureSize, int] = {"full": 0, "small": 0}
        self._states = 0

    def run(self, seconds: float) -> None:
        end = self.now + seconds
        while self.now < end:
            self._step()
            self.now += STEP

    def _step(self) -> None:
        now, policy = self.now, self.policy
        while self._events and self._events[0][0] <= now:
            heapq.heappop(self._events)[2]()
        for viewer in self.viewers:
            if now < viewer.until and not viewer.sleeps:
                viewer.asker.want(viewer.largest, now)
            if viewer.asker.listens != viewer.asker.size:
                viewer.asker.listen(viewer.asker.size)
        policy.update(now)
        if now >= self._next_state:
            self._next_state += 1.0 / CAMERA_STATE.rate_hz
            self._say_state()
        for size, limit in policy.due(now).items():
            self._send(size, min(limit, FULL if size == "full" else FULL // 3))

    def _say_state(self) -> None:
        state = stamped(
            CameraState(camera="head", askers=self.policy.askers(), width=320, height=240, rate=15.0),
            self._states,
            0,
            self.instance,
        )
        self.policy.on_state_sent(self._states, self.now)
        self._states += 1
        for viewer in self.viewers:

            def arrives(viewer: Viewer = viewer) -> None:
                self._answer(viewer, viewer.asker.on_state(state, viewer.name, self.now))

            self._at(max(self.now, viewer.busy_until) + viewer.link.delay, arrives)

    def _send(self, size: PictureSize, length: int) -> None:
        picture = stamped(
            Picture(camera="head", jpeg=bytes(length), width=320, height=240, tick=None),
            self.sent[size],
            0,
            self.instance,
        )
        self.policy.sent(size, self.sent[size], length, self.now)
        self.sent[size] += 1
        for viewer in self._listening(size):
            begun = self.now
            viewer.busy_until = max(self.now, viewer.busy_until) + length * 8 / viewer.link.rate

            def arrives(viewer: Viewer = viewer, busy: float = viewer.busy_until - begun) -> None:
                viewer.came.append(Came(self.now, size, length, busy))
                if viewer.confirms:
                    self._answer(viewer, viewer.asker.on_picture(picture, size, self.now))

            self._at(viewer.busy_until + viewer.link.delay, arrives)

    def _listening(self, size: PictureSize) -> Iterator[Viewer]:
        return (viewer for viewer in self.viewers if viewer.asker.listens == size)

    def _answer(self, viewer: Viewer, hold: CameraHold | None) -> None:
        if hold is not None:
            word = stamped(hold, viewer.said, 0, viewer.name)
            viewer.said += 1
            self._at(self.now + viewer.link.delay, lambda: self.policy.on_hold(word, self.now))

    def _at(self, when: float, act: Any) -> None:
        heapq.heappush(self._events, (when, next(self._counter), act))

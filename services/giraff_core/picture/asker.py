"""One who looks at a camera of the robot: the asker's side of `giraff_camera`. No I/O and no clock."""

import math
from typing import Final

from giraff_schemas.camera import HOLD_ENDS, CameraHold, CameraState, Picture, PictureSize
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_LETS_GO: Final = 1.0
"""s after the last `want` that nobody looks any longer."""
_ANSWERS_WITHIN: Final = 2.0
"""s in which a camera that is heard takes the word of somebody who may look."""
_OVER: Final = Trouble("nobody here looked for a while, and it shows nothing by itself", "ask for its picture again")
_RESTARTED: Final = Trouble("the camera has started again, and shows nothing by itself", "ask for its picture again")


class PictureAsker:
    """Keep one person's wish at one camera: it makes the holds, and tells why no picture comes.

    The wish is for the camera's process of the moment. A later start of it is another one, which a person must ask.
    """

    def __init__(self, camera: str, by: str) -> None:
        """`by`: who looks, for people."""
        self._camera, self.by = camera, by
        self._wanted = self._heard = self._another_heard = -math.inf
        self._since = self._asking_since = math.inf
        self._has_asked = False
        self._is_over = False  # nobody looked for a while: a machine that slept does not look again by itself
        self._instance = ""  # of the camera's process
        self._seen = -1
        self._largest: PictureSize = "full"
        self.state: CameraState | None = None
        """The newest of the camera."""
        self.size: PictureSize = "small"
        """Size of the pictures to listen to. `listen` tells that it is done."""
        self.listens: PictureSize = "small"
        """Size of the pictures that are listened to."""

    def want(self, largest: PictureSize, now: float) -> None:
        """Somebody still looks; to be said twice a second at least. `now`: s of any one monotonic clock."""
        if self._wanted == -math.inf:
            self._since = now
        elif now - self._wanted > HOLD_ENDS:
            self._is_over = True
        self._wanted, self._largest = now, largest

    def on_state(self, state: CameraState, instance: str, now: float) -> CameraHold | None:
        """Take the camera's state; returns what is to be said. `instance`: of this asker's words."""
        if not self._instance:
            self._instance = state.instance
        if state.instance != self._instance:
            self._another_heard = now
            return None
        self.state, self._heard = state, now
        mine = next((each for each in state.askers if each.instance == instance), None)
        if mine is not None:
            self._asking_since = math.inf
            self.size = mine.size
        return self._hold(now)

    def listen(self, size: PictureSize) -> None:
        """Pictures of this size are listened to from now on."""
        self.listens, self._seen = size, -1

    def takes(self, picture: Picture, size: PictureSize) -> bool:
        """Whether a picture of this size is this asker's. Others may have asked for it alone."""
        return size == self.listens and picture.instance == self._instance != "" and not self._is_over

    def on_picture(self, picture: Picture, size: PictureSize, now: float) -> CameraHold | None:
        """Take a picture of this size; returns what is to be said."""
        if not self.takes(picture, size):
            return None
        self._seen = picture.seq
        return self._hold(now)

    def trouble(self, now: float) -> Trouble:
        """Why there is no picture; NO_TROUBLE: one comes, or may."""
        if self._is_over:
            return _OVER
        if now - self._heard > HOLD_ENDS:
            if now - self._another_heard <= HOLD_ENDS:
                return _RESTARTED
            if now - self._since <= _ANSWERS_WITHIN:
                return NO_TROUBLE
            return Trouble(
                f"the camera {self._camera} is not heard", "check that giraff_camera runs and that both share a network"
            )
        assert self.state is not None  # noqa: S101  it was heard
        if now - self._asking_since > _ANSWERS_WITHIN:
            return Trouble(
                f"the camera {self._camera} does not take this host's word, or shows its picture to as many as it can",
                "on a secured network, write `camera` for this host in [network.access.operators] on all hosts",
            )
        return self.state.reason

    def _hold(self, now: float) -> CameraHold | None:
        if self.state is None or self._is_over or now - self._wanted > _LETS_GO:
            return None
        if not self._has_asked:
            self._has_asked, self._asking_since = True, now
        return CameraHold(
            camera=self._camera,
            to=self._instance,
            state=self.state.seq,
            by=self.by,
            size=self.listens,
            seen=self._seen,
            largest=self._largest,
        )

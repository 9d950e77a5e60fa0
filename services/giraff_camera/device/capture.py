"""A camera in a thread of its own: the newest picture, and why there is none."""

import time
from collections import deque
from collections.abc import Callable
from threading import Condition, Thread
from typing import Final, TypeVar

from giraff_camera.device.image import Device, DeviceError, Image
from giraff_node.process.selector import Waker
from giraff_schemas.trouble import NO_TROUBLE, Trouble

REOPEN_PERIOD: Final = 1.0
"""s between two attempts."""
HANGS: Final = 2.0
"""s after which a call to the camera hangs."""
STUCK: Final = 30.0
"""s after which nobody waits for its end any longer."""
_LAST_PICTURE: Final = 1.0
"""s that an orderly end waits for the picture that is under way."""
_MOST_RATE: Final = 200
"""Hz that `rate` tells at most."""
T = TypeVar("T")
_HANGS: Final = Trouble("the camera does not answer", "unplug it, and plug it in again")
_ENDED: Final = Trouble("the thread that reads the camera has ended by an error", "see the log of this service")


class Capture:
    """The camera is open from `start()` to `stop()` alone. Nothing here waits for it.

    One thread opens, reads and closes it, and no second one is started: a call that hangs may hold the camera.
    """

    def __init__(self, open_device: Callable[[], Device], clock: Callable[[], float] = time.monotonic) -> None:
        """`open_device`: raises DeviceError. `clock`: monotonic, s."""
        self._open_device, self._clock = open_device, clock
        self._changed = Condition()
        """Guards what follows, and is notified when `_wanted` or `_closed` changes."""
        self._wanted = self._closed = False
        self._image: Image | None = None
        self._fault = NO_TROUBLE
        self._call_began: float | None = None
        """When the call to the camera began that is under way; None: none is."""
        self._times: deque[float] = deque(maxlen=_MOST_RATE)
        self._waker = Waker()
        self._thread = Thread(target=self._run, name="camera", daemon=True)
        self._thread.start()

    def start(self) -> None:
        """Open the camera, and take pictures. It is opened again after an error."""
        self._want(True)

    def stop(self) -> None:
        """Close the camera after the picture that is under way, and drop the one that nobody has taken."""
        self._want(False)

    def close(self) -> None:
        """Stop for ever. A call that hangs is left behind."""
        self._want(False)
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join(_LAST_PICTURE)
        self._waker.close()

    def descriptor(self) -> int | None:
        """Return what is readable while there is a picture to take."""
        return self._waker.descriptor()

    def pop_picture(self) -> Image | None:
        """Return the newest picture that was not taken yet."""
        with self._changed:
            self._waker.drain()
            image, self._image = self._image, None
            return image

    @property
    def fault(self) -> Trouble:
        """Say why there are no pictures; NO_TROUBLE: there are, or nobody wants them."""
        with self._changed:
            if not self._thread.is_alive() and not self._closed:
                return _ENDED
            return _HANGS if self._hangs_for() >= HANGS else self._fault

    @property
    def is_stuck(self) -> bool:
        """Whether only the end of this process helps: the camera holds its thread for good."""
        with self._changed:
            return self._hangs_for() >= STUCK or not (self._thread.is_alive() or self._closed)

    @property
    def rate(self) -> float:
        """Hz. Pictures of the last second."""
        with self._changed:
            while self._times and self._clock() - self._times[0] >= 1.0:
                self._times.popleft()
            return float(len(self._times))

    def _want(self, wanted: bool) -> None:
        with self._changed:
            if wanted != self._wanted:
                self._wanted, self._fault, self._image = wanted, NO_TROUBLE, None
                self._times.clear()
                self._waker.drain()
                self._changed.notify()

    def _hangs_for(self) -> float:
        return 0.0 if self._call_began is None else self._clock() - self._call_began

    def _run(self) -> None:
        while self._waits_until_wanted():
            try:
                device = self._called(self._open_device)
                try:
                    while self._wanted:
                        self._on_image(self._called(device.read))
                finally:
                    self._called(device.close)
            except DeviceError as error:
                with self._changed:
                    if self._wanted:
                        self._fault = error.trouble
                        self._changed.wait_for(lambda: not self._wanted, REOPEN_PERIOD)

    def _waits_until_wanted(self) -> bool:
        with self._changed:
            self._changed.wait_for(lambda: self._wanted or self._closed)
            return not self._closed

    def _called(self, call: Callable[[], T]) -> T:
        with self._changed:
            self._call_began = self._clock()
        try:
            return call()
        finally:
            with self._changed:
                self._call_began = None

    def _on_image(self, image: Image) -> None:
        with self._changed:
            if self._wanted:
                self._image, self._fault = image, NO_TROUBLE
                self._times.append(self._clock())
                self._waker.wake()

"""A picture as it was taken, and what takes one. This package imports `cv2` from here alone.

OpenCV has one thread here, and no wait that never ends.
"""

import os
from typing import NamedTuple, Protocol

# Read when the library is loaded. s without a picture after which V4L2 gives up; the default is 10.
os.environ.setdefault("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT", "2")

import cv2 as cv2  # noqa: PLC0414  after the setting; the name is given to others
import numpy as np
from numpy.typing import NDArray

from giraff_schemas.trouble import Trouble

# A picture of 320 x 240 takes 1 ms. More threads would take the processor from the services that drive.
cv2.setNumThreads(1)


class Image(NamedTuple):
    """One picture, as a camera gives it."""

    pixels: NDArray[np.uint8]
    """(height, width) grey, or (height, width, 3) blue, green, red."""
    taken: float
    """s of the monotonic clock. The exposure began then, or later."""
    exposure: float | None
    """s; None: unknown."""


class DeviceError(Exception):
    """There is no picture. `trouble` says why and what to do."""

    def __init__(self, trouble: Trouble) -> None:
        super().__init__(str(trouble))
        self.trouble = trouble


class Device(Protocol):
    """A camera that is open. Each call may take a second: `Capture` gives it a thread."""

    def read(self) -> Image:
        """Wait for the next picture. Raises DeviceError."""
        ...

    def close(self) -> None: ...

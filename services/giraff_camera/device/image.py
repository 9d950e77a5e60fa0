"""A picture as it was taken, and what takes one."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from giraff_schemas.trouble import Trouble


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

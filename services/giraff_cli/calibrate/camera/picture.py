"""A picture as the fits take it."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

Grey = NDArray[np.uint8]
"""(height, width), 0 black to 255 white."""
Points = NDArray[np.float64]
"""(n, 2) px: x to the right, y down, from the middle of the left upper pixel."""

_END: Final = b"\xff\xd9"
"""Last bytes of each whole JPEG."""
_JPEG: Final = b"\xff\xd8"


class UnusableError(Exception):
    """This picture, or all of them, cannot be used. The message says why and what to do."""


def decode(data: bytes) -> Grey:
    """Return the grey picture of a JPEG or PNG. Raises UnusableError."""
    if data.startswith(_JPEG) and not data.rstrip(b"\0").endswith(_END):  # OpenCV would fill the rest with grey
        raise UnusableError("the picture is torn: its end is missing")
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_GRAYSCALE) if data else None
    except cv2.error:
        pixels = None
    if pixels is None:
        raise UnusableError("it is no picture that can be read; give JPEG or PNG")
    return np.asarray(pixels, dtype=np.uint8)

"""JPEGs of at most so many bytes."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from giraff_camera.device.image import cv2

_LOWEST: Final = 10
"""Quality below which a picture of half the size shows more."""
_BEGIN_HALVED: Final = 40
"""Quality at which a picture of half the size takes about as many bytes as one of the whole size at the lowest."""
_MOST_HALVINGS: Final = 5
_STEP: Final = 0.8
"""Factor of the quality, from one rung to the next."""
_LESS_BYTES: Final = 0.85
"""A rung takes about so much of the bytes of the one above."""
_ROOM: Final = 1.25
"""The next picture tries one rung up where the bytes of this one fit so many times."""


class JpegEncoder:
    """Encodes a stream of pictures. It remembers the rung that fitted last, and tries a better one at each picture."""

    def __init__(self, quality: int) -> None:
        """`quality`: of the JPEG where it is not too large, 10 to 95."""
        self._ladder = _ladder(quality)
        self._rung = 0
        self.size = (0, 0)
        """Width and height of the last picture, in px: it was halved where nothing else fitted."""
        self.tries = 0
        """How often the last picture was encoded."""

    def encode(self, pixels: NDArray[np.uint8], max_bytes: int) -> bytes:
        """Return the best JPEG of at most so many bytes. Raises ValueError where none is so small (1000 always do)."""
        self.tries, halved = 0, 0
        while True:
            halvings, quality = self._ladder[self._rung]
            for _ in range(halvings - halved):
                pixels = half(pixels)
            halved = halvings
            _, buffer = cv2.imencode(".jpg", pixels, (cv2.IMWRITE_JPEG_QUALITY, quality, cv2.IMWRITE_JPEG_OPTIMIZE, 1))
            self.tries += 1
            if len(buffer) <= max_bytes:
                break
            if self._rung == len(self._ladder) - 1:
                raise ValueError(f"no JPEG of {len(pixels)} rows has at most {max_bytes} bytes")
            down = math.ceil(math.log(max_bytes / len(buffer)) / math.log(_LESS_BYTES))
            self._rung = min(self._rung + down, len(self._ladder) - 1)
        self.size = pixels.shape[1], pixels.shape[0]
        if self._rung and len(buffer) * _ROOM <= max_bytes:
            self._rung -= 1
        return buffer.tobytes()


def half(pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the picture half as wide and high."""
    height, width = pixels.shape[:2]
    size = max(1, width // 2), max(1, height // 2)
    return np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), np.uint8)


def _ladder(quality: int) -> list[tuple[int, int]]:
    """How often the picture is halved, and its quality: each rung takes fewer bytes than the one before."""
    rungs: list[tuple[int, int]] = []
    for halvings in range(_MOST_HALVINGS + 1):
        begin = float(quality if halvings == 0 else min(quality, _BEGIN_HALVED))
        while begin > _LOWEST:
            rungs.append((halvings, round(begin)))
            begin *= _STEP
        rungs.append((halvings, _LOWEST))
    return rungs

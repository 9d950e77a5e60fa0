"""What is to be seen on a picture: where a colour is, and on which side of the robot."""

from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from giraff_viewer.colours import Colour

_NEAR_ENOUGH: Final = 24
"""Of 255, by which each part of a colour may differ: its lines have soft edges."""
_LEFT, _TOP, _RIGHT, _BOTTOM = 5, 65, 795, 615
"""The floor plan on the picture, in pixels, without its title."""

_POPUP: Final = (173, 187, 255)
"""The viewer's mark of a notification, which nothing of a robot has."""


def has_popup(path: Path) -> bool:
    """Whether the viewer tells about itself over the plots."""
    with Image.open(path) as picture:
        return bool((np.asarray(picture.convert("RGB"))[:, _RIGHT:] == _POPUP).all(axis=2).any())


class Floor:
    """The floor plan of a picture. Coordinates are its pixels: x to the right, y up."""

    def __init__(self, path: Path) -> None:
        with Image.open(path) as picture:
            self._pixels = np.asarray(picture.convert("RGB"), dtype=np.int16)[_TOP:_BOTTOM, _LEFT:_RIGHT]

    def count(self, colour: Colour) -> int:
        """How many pixels have it."""
        return int(self._mask(colour).sum())

    def points(self, colour: Colour) -> NDArray[np.float64]:
        """Where they are, one row a pixel."""
        rows, columns = np.nonzero(self._mask(colour))
        return np.stack([columns, -rows], axis=1).astype(np.float64)

    def middle(self, colour: Colour) -> NDArray[np.float64]:
        """Of all that have it."""
        points = self.points(colour)
        middle: NDArray[np.float64] = points.mean(axis=0)
        return middle

    def _mask(self, colour: Colour) -> NDArray[np.bool_]:
        close: NDArray[np.bool_] = np.all(np.abs(self._pixels - np.asarray(colour)) <= _NEAR_ENOUGH, axis=2)
        return close

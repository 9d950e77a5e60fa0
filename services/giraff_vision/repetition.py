"""Tell whether a floor's pattern repeats. The picture alone then fits several motions, each a repetition apart."""

from typing import Any, Final

import cv2
import numpy as np

from giraff_vision.ground import Array, Grey, Ground

_CELL: Final = 0.01  # m of floor that a pixel of the view from above shows
_CELLS: Final = 96
_NEAREST: Final = 0.025  # m: every pattern is like itself at a smaller shift
_FARTHEST: Final = 0.4  # m: no robot goes farther between two pictures, even where some are lost
_OVERLAP: Final = 0.25  # share of the view that both must show: a smaller part is alike by chance
_ALIKE: Final = 0.65
"""Correlation from which the pattern repeats. Bricks and tiles of different shades reach 0.6, equal ones 0.7."""
_NEIGHBOURS: Final = np.full((5, 5), 1, np.uint8)
_SHIFT: Final = np.hypot(*np.mgrid[-_CELLS:_CELLS, -_CELLS:_CELLS]) * _CELL  # m
_IN_REACH: Final = (_SHIFT > _NEAREST) & (_SHIFT < _FARTHEST)


class Repetition:
    """Compares the nearer floor of a picture with itself, seen from above and shifted."""

    def __init__(self, ground: Ground) -> None:
        """`ground`: some floor is seen."""
        rows, columns = np.nonzero(ground.bands[0])
        floor = ground.floor(np.column_stack([columns, rows]).astype(np.float64))
        x, y = (floor.min(axis=0) + floor.max(axis=0)) / 2 - _CELLS * _CELL / 2
        cells = np.array([[0.0, _CELL, x], [_CELL, 0.0, y], [0.0, 0.0, 1.0]])
        self._to_picture = np.asarray(ground.projections(np.zeros((1, 5)))[0] @ cells, np.float64)
        self._shown = np.asarray(self._from_above(ground.bands[0], cv2.INTER_NEAREST) > 0, np.float64)

    def is_in(self, even: Grey) -> bool:
        """Return True if the floor's pattern repeats. `even`: a picture without what is darker over larger parts."""
        shown = self._shown
        grey = self._from_above(even, cv2.INTER_LINEAR)
        pattern = (grey - (grey * shown).sum() / max(1.0, shown.sum())) * shown
        place, own, power = (np.fft.rfft2(each, (2 * _CELLS, 2 * _CELLS)) for each in (shown, pattern, pattern**2))
        overlap, powers = _shifted(place, place), _shifted(power, place) * _shifted(place, power)
        likeness = _shifted(own, own) / np.sqrt(np.maximum(powers, 1e-9))
        likeness[(overlap < _OVERLAP * shown.sum()) | (overlap < 1.0)] = 0.0
        is_peak = (likeness >= cv2.dilate(likeness, _NEIGHBOURS)) & _IN_REACH
        return bool((likeness[is_peak] > _ALIKE).any())

    def _from_above(self, picture: Grey, flags: int) -> Array:
        view = cv2.warpPerspective(picture, self._to_picture, (_CELLS, _CELLS), flags=flags | cv2.WARP_INVERSE_MAP)
        return np.asarray(view, np.float64)


def _shifted(one: Any, other: Any) -> Array:
    """Return the sum of the products at each shift of two spectra, no shift in the middle."""
    return np.fft.fftshift(np.fft.irfft2(one * np.conj(other), (2 * _CELLS, 2 * _CELLS)))

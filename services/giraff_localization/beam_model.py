"""How likely each reading of an ultrasonic sensor is, by what is expected.

A mixture as in S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), section 6.3: the expected echo, one of
something nearer that is not on the map, one of no meaning, and none at all. Where no echo is expected, that there is
none is a reading of its own, with its own likelihood.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from giraff_localization.range_table import CLEAR, SLANTED, SOLID

_HIT: Final = 0.72
_NEARER: Final = 0.10
_WILD: Final = 0.10
_LOST: Final = 0.08
_SPREAD: Final = 0.15
"""m, standard deviation of an echo: of the map and of furniture, far more than the sensor's own."""
_SURPRISE: Final = 0.15
"""Share of echoes where nothing is on the map."""
_SLANTED_CLEAR: Final = 0.45
"""Share of no echo from what is too slanted."""
_SOLID: Final = 0.02
"""Of each reading of a sensor that would be within a wall."""
_NEAR: Final = 0.3
"""m: an echo of something nearer than a wall is taken to come from so much of room at least."""


def beam_model(reach: float, bin_size: float) -> npt.NDArray[np.float32]:
    """log p(reading | expected), by reading (a range in bins, or CLEAR) and by expected; of echoes: per m.

    `reach`, `bin_size`: m.
    """
    bins = np.arange(CLEAR) * bin_size
    likely = np.full((SOLID + 1, SOLID + 1), _SOLID / reach)
    echo, none = slice(0, CLEAR), CLEAR
    off = (bins[:, None] - bins[None, :]) / _SPREAD
    nearer = (bins[:, None] < bins[None, :]) / np.maximum(bins[None, :], _NEAR)
    hit = np.exp(-0.5 * off * off) / (_SPREAD * np.sqrt(2.0 * np.pi))
    likely[echo, echo] = _HIT * hit + _NEARER * nearer + _WILD / reach
    likely[none, echo] = _LOST
    likely[echo, CLEAR], likely[none, CLEAR] = _SURPRISE / reach, 1.0 - _SURPRISE
    likely[echo, SLANTED], likely[none, SLANTED] = (1.0 - _SLANTED_CLEAR) / reach, _SLANTED_CLEAR
    likely[none, SOLID] = _SOLID
    model: npt.NDArray[np.float32] = np.log(likely).astype(np.float32)
    return model

"""How much of what was heard a place explains, whatever it makes of the likelihood.

Likelihoods add up the map's small errors as if they were evidence: of two rooms that are alike, one always wins. How
many readings a place explains is the fair question.
"""

import copy
import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_localization.beams.range_table import CLEAR, SLANTED
from giraff_localization.beams.ultrasonic import Beam
from giraff_localization.floor import Floor

_MEMORY: Final = 4.0
RECENT: Final = 2.0
"""m of way, after which a reading counts e times less: to say that a place is right, and that it is not any more."""
_CLOSE: Final = 0.25
"""m between an echo and what was expected that are the same."""
_NEARER: Final = 0.3
"""Of one reading: what is nearer than expected hides the walls, and says little against the place."""
_LEAST: Final = 0.25
"""Share that fits, below which nothing is explained."""


class Counts(NamedTuple):
    """Shares of readings."""

    right: float
    nearer: float
    """Something stands before what was expected."""
    total: float


def compare(floor: Floor, pose: Pose, beams: Sequence[Beam]) -> Counts:
    """What is heard, with what a robot at `pose` would expect.

    What is too slanted to expect anything is left out; where no robot can be, nothing fits.
    """
    counts = np.zeros(3)
    is_free = floor.space.free.holds(pose.x, pose.y)
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    for model, alike in floor.sonars.alike(beams):
        x, y, yaw, heard, share, _ = np.array(alike, np.float32).T
        expected = model.table.expected(pose.x + cos * x - sin * y, pose.y + sin * x + cos * y, pose.yaw + yaw).astype(
            int
        )
        is_echo, is_expected = heard != CLEAR, expected < CLEAR
        close = np.abs(heard - expected) * model.table.bin < _CLOSE
        right = np.where(is_expected, is_echo & close, ~is_echo & (expected == CLEAR))
        nearer = is_expected & is_echo & (heard < expected) & ~right
        counted = np.where(expected == SLANTED, 0.0, share)
        counts += (counted @ right, counted @ nearer, counted.sum()) if is_free else (0.0, 0.0, share.sum())
    return Counts(*counts.tolist())


class Fit:
    """Of one place, over the last metres."""

    def __init__(self, memory: float = _MEMORY) -> None:
        """`memory`: m."""
        self._memory = memory
        self._right = self._nearer = self._total = 0.0

    def add(self, counts: Counts, effort: float) -> None:
        """Take what was heard on the next piece of way."""
        fade = math.exp(-effort / self._memory)
        self._right = self._right * fade + counts.right
        self._nearer = self._nearer * fade + counts.nearer
        self._total = self._total * fade + counts.total

    def copy(self) -> "Fit":
        """One that goes on by itself."""
        return copy.copy(self)

    @property
    def share(self) -> float:
        """Of the readings, 0..1, that the place explains."""
        return self._right / self._total if self._total else 0.0

    @property
    def forgiving(self) -> float:
        """The same of a place where people may stand about."""
        if self._right <= _LEAST * self._total:
            return 0.0
        return self._right / (self._total - (1.0 - _NEARER) * self._nearer)

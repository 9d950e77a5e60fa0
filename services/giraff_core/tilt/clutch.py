"""The clutch: neutral while it is pressed, and the attitude in which it is let go is the new zero."""

import math
from collections import deque
from typing import Final, NamedTuple

from giraff_schemas.trouble import NO_TROUBLE, Trouble

Vector = tuple[float, float, float]

FLAT: Final[Vector] = (0.0, 0.0, 1.0)
LARGEST_ZERO_DEG: Final = 45.0
"""From flat. Beyond it nothing is left of the tilt on one side."""
BOUNCE: Final = 0.04
"""s from the first reading to the last: for less the clutch is neither pressed on purpose nor let go."""
HELD: Final = 0.18
"""s from the first to the last of the readings whose mean becomes the zero."""

_HELD_STILL: Final = 0.5  # m/s² from their mean: 3 degrees
_GRAVITY: Final = 9.81
_GRAVITY_WITHIN: Final = 2.0  # m/s²; the sensor's own offset is up to 1.5
_EXACT: Final = 1e-6  # s; sums of periods are a little off


class Words(NamedTuple):
    """How a person is told."""

    act: str
    """What lets it go, as in `the clutch was let go`."""
    thing: str
    remedy: str


class _Held(NamedTuple):
    at: float
    vector: Vector


class Clutch:
    """Feed it each sound reading with its time (s, of any one clock) and the clutch's state."""

    def __init__(self, words: Words) -> None:
        self.zero = FLAT
        """Direction of gravity, as a unit vector, at which nothing is asked."""
        self.engaged = False
        """It is pressed: the hand moves freely."""
        self.refusal = NO_TROUBLE
        """Why the last attitude did not become the zero; NO_TROUBLE when it did."""
        self._words = words
        self._pressed = (0.0, 0.0)  # the first and the last reading of it
        self._released: float | None = None
        self._recent: deque[_Held] = deque()

    def forget(self) -> None:
        """Readings were missing."""
        self._recent.clear()

    def on_reading(self, vector: Vector, at: float, *, pressed: bool) -> None:
        """`vector`: m/s²."""
        self._recent.append(_Held(at, vector))
        while len(self._recent) > 1 and at - self._recent[1].at >= HELD - _EXACT:
            self._recent.popleft()
        if pressed:
            self._pressed = (self._pressed[0] if self.engaged else at), at
            self._released = None
            self.engaged = True  # at once: neutral is always safe
        elif self.engaged:
            self._released = at if self._released is None else self._released
            if at - self._released >= BOUNCE - _EXACT:
                self.engaged = False
                first, last = self._pressed
                if last - first >= BOUNCE - _EXACT:
                    self._let_go()

    def dismiss_refusal(self) -> None:
        """The hand has found the old zero again."""
        self.refusal = NO_TROUBLE

    def relative(self, vector: Vector) -> Vector:
        """`vector` as if the zero were flat: turned by the smallest turn that makes it so."""
        (zx, zy, zz), (x, y, z) = self.zero, vector
        # Rodrigues' formula about zero x flat = (zy, -zx, 0), whose length is the turn's sine and zz its cosine.
        along = (zy * x - zx * y) / (1.0 + zz)
        return x * zz - zx * z + zy * along, y * zz - zy * z - zx * along, z * zz + zx * x + zy * y

    def _let_go(self) -> None:
        self.refusal = NO_TROUBLE
        act, thing, remedy = self._words
        recent = [held.vector for held in self._recent]
        if self._recent[-1].at - self._recent[0].at < HELD - _EXACT:
            self.refusal = Trouble(f"{act} before the sensor had been read for 0.2 s", remedy)
            return
        x, y, z = (sum(axis) / len(recent) for axis in zip(*recent, strict=True))
        length = math.hypot(x, y, z)
        still = all(math.dist(vector, (x, y, z)) <= _HELD_STILL for vector in recent)
        if not still or abs(length - _GRAVITY) > _GRAVITY_WITHIN:
            self.refusal = Trouble(f"{act} while the {thing} moved", remedy)
        elif z < length * math.cos(math.radians(LARGEST_ZERO_DEG)):
            self.refusal = Trouble(f"{act} more than {LARGEST_ZERO_DEG:g} degrees from flat", remedy)
        else:
            self.zero = (x / length, y / length, z / length)

"""The button: neutral while it is pressed, and the attitude in which it is let go is the new zero."""

from __future__ import annotations

import math
from collections import deque
from typing import Final

Vector = tuple[float, float, float]

FLAT: Final[Vector] = (0.0, 0.0, 1.0)
LARGEST_ZERO_DEG: Final = 45.0
"""From flat. Beyond it nothing is left of the tilt on one side."""
BOUNCE_READINGS: Final = 3
"""0.06 s: for less the button is neither pressed on purpose nor let go."""

_HELD_READINGS: Final = 10  # 0.2 s, whose mean becomes the zero
_HELD_STILL: Final = 0.5  # m/s² from their mean: 3 degrees
_GRAVITY: Final = 9.81
_GRAVITY_WITHIN: Final = 2.0  # m/s²; the sensor's own offset is up to 1.5

_WAY_OUT: Final = "the old zero stays; hold the joystick level, or press the button, hold still and let it go"


class Clutch:
    """Feed it each sound reading with the button's state."""

    def __init__(self) -> None:
        self.zero = FLAT
        """Direction of gravity, as a unit vector, at which nothing is asked."""
        self.engaged = False
        """The button is pressed: the hand moves freely."""
        self.refusal = ""
        """Why the last attitude did not become the zero, with the way out; empty when it did."""
        self._pressed = 0
        self._released = 0
        self._recent: deque[Vector] = deque(maxlen=_HELD_READINGS)

    def forget(self) -> None:
        """Readings were missing."""
        self._recent.clear()

    def take(self, vector: Vector, *, pressed: bool) -> None:
        """`vector`: m/s²."""
        self._recent.append(vector)
        if pressed:
            self._pressed = self._pressed + 1 if self.engaged else 1
            self._released = 0
            self.engaged = True  # at once: neutral is always safe
        elif self.engaged:
            self._released += 1
            if self._released >= BOUNCE_READINGS:
                self.engaged = False
                if self._pressed >= BOUNCE_READINGS:
                    self._let_go()

    def dismiss_refusal(self) -> None:
        """The hand has found the old zero again."""
        self.refusal = ""

    def relative(self, vector: Vector) -> Vector:
        """`vector` as if the zero were flat: turned by the smallest turn that makes it so."""
        (zx, zy, zz), (x, y, z) = self.zero, vector
        # Rodrigues' formula about zero x flat = (zy, -zx, 0), whose length is the turn's sine and zz its cosine.
        along = (zy * x - zx * y) / (1.0 + zz)
        return x * zz - zx * z + zy * along, y * zz - zy * z - zx * along, z * zz + zx * x + zy * y

    def _let_go(self) -> None:
        self.refusal = ""
        if len(self._recent) < _HELD_READINGS:
            self.refusal = f"the clutch was let go before the sensor had been read for 0.2 s; {_WAY_OUT}"
            return
        x, y, z = (sum(axis) / _HELD_READINGS for axis in zip(*self._recent, strict=True))
        length = math.hypot(x, y, z)
        still = all(math.dist(vector, (x, y, z)) <= _HELD_STILL for vector in self._recent)
        if not still or abs(length - _GRAVITY) > _GRAVITY_WITHIN:
            self.refusal = f"the clutch was let go while the joystick moved; {_WAY_OUT}"
        elif z < length * math.cos(math.radians(LARGEST_ZERO_DEG)):
            self.refusal = f"the clutch was let go more than {LARGEST_ZERO_DEG:g} degrees from flat; {_WAY_OUT}"
        else:
            self.zero = (x / length, y / length, z / length)

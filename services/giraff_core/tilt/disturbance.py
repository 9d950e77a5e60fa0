"""Whether what holds an accelerometer falls or is shaken. Readings may come 10 to 200 times a second.

What the thresholds stand on:

- Free fall is below 0.3 to 0.6 g on every axis (ADXL345 datasheet, "free-fall"). Of a tumbling thing less than the
  whole vector vanishes: the threshold is the lower end, of the vector.
- A wrist turns at up to 5 rad/s when a driver hurries. That turns gravity by 1 m/s² in 20 ms.
"""

import math
from collections import deque
from typing import Final

from giraff_core.tilt.clutch import Vector
from giraff_schemas.trouble import NO_TROUBLE, Trouble

FREE_FALL: Final = 3.0
"""m/s². Whatever is shorter is no gravity, and its direction no tilt."""
STEP: Final = 0.015
"""s, at least, between two readings that are compared: in less, what a sensor rounds looks like a jolt."""
JOLT: Final = 100.0
"""m/s³: 2 m/s² in 20 ms, twice what a hurried wrist does."""
JOLTS: Final = 3
"""Of the last SHAKE_STEPS steps: a shake. A knock is two, one there and one back."""
SHAKE_STEPS: Final = 5
SOUND: Final = 0.5
"""s without any of it, after which a hand counts again."""

_GRAVITY: Final = 9.81
_QUIET: Final = 4.0  # m/s² from gravity, beyond which a reading is no sign that it is over
_EXACT: Final = 1e-6  # s; sums of periods are a little off


def falling(thing: str) -> Trouble:
    """The reason, of a thing by this name."""
    return Trouble(f"the {thing} is falling", "take it in the hand and hold it level")


def shaken(thing: str) -> Trouble:
    """The reason, of a thing by this name."""
    return Trouble(f"the {thing} is being shaken", "hold it still and level")


class Disturbance:
    """Feed it each reading of a running sensor; `forget` when there was none."""

    def __init__(self, thing: str) -> None:
        self._thing = thing
        self.forget()

    def forget(self) -> None:
        """Readings were missing: what came before says nothing about what comes now."""
        self._compared: tuple[Vector, float] | None = None
        self._jolts: deque[bool] = deque(maxlen=SHAKE_STEPS)
        self._alarm = NO_TROUBLE
        self._unsound = -math.inf

    def judge(self, vector: Vector, at: float, also: Trouble = NO_TROUBLE) -> Trouble:
        """Why this reading (m/s², at s of any one clock) is no hand's; NO_TROUBLE: it may be one.

        `also`: another cause that lasts as these do.
        """
        jolted = self._step(vector, at)
        length = math.hypot(*vector)
        if alarm := self._found(length) or also:
            self._alarm, self._unsound = alarm, at
        elif jolted or abs(length - _GRAVITY) > _QUIET:
            self._unsound = at
        elif at - self._unsound >= SOUND - _EXACT:
            self._alarm = NO_TROUBLE
        return self._alarm

    def _step(self, vector: Vector, at: float) -> bool:
        if self._compared is None:
            self._compared = vector, at
            return False
        before, then = self._compared
        if at - then < STEP - _EXACT:
            return False
        self._compared = vector, at
        self._jolts.append(math.dist(vector, before) > JOLT * (at - then))
        return self._jolts[-1]

    def _found(self, length: float) -> Trouble:
        if length < FREE_FALL:
            return falling(self._thing)
        return shaken(self._thing) if sum(self._jolts) >= JOLTS else NO_TROUBLE

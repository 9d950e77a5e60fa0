"""Whether a hand holds the joystick, told by its accelerometer alone. One reading every TILT_PERIOD_MS.

What the thresholds stand on, beside those of `giraff_core.tilt.disturbance`:

- The sensor's noise is 0.012 m/s² rms an axis (BNO055 datasheet: 150 µg/√Hz, at 62.5 Hz of bandwidth), 0.021 m/s² of
  the vector. Three axes of it, in steps of 0.01 m/s², repeat by chance in 1 of 80 readings.
- A hand's postural tremor is 0.015 to 0.35 m/s² peak at its main frequency of 6 to 12 Hz, most often 0.1 (97 people,
  Arch Neurol 1982;39:358-362), and its slow wandering comes on top.
"""

import math
from collections import deque
from typing import Final

from giraff_core.live import Live
from giraff_core.tilt.disturbance import SHAKE_STEPS, Disturbance, falling, shaken
from giraff_joystick.config import JoystickConfig
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import TILT_LSB_PER_M_S2, TILT_PERIOD_MS

Counts = tuple[int, int, int]
"""A reading as it is on the wire: TILT_LSB_PER_M_S2."""

FROZEN_READINGS: Final = 10
"""Equal ones in a row, 0.2 s. By chance once in 10^17."""
DOUBTED_READINGS: Final = 4
"""Equal ones in a row. By chance once in 500 000: the button is then let go in vain, and a person presses it again."""
LAID_DOWN_READINGS: Final = 50
"""1 s."""

FALLING: Final = falling("joystick")
SHAKEN: Final = shaken("joystick")
FROZEN: Final = Trouble("the tilt sensor repeats one reading", "reset the joystick board, or unplug it for a second")
LAID_DOWN: Final = Trouble(
    "the joystick lies tilted and nobody holds it", "take it in the hand and hold it level, or lay it down level"
)


class HandDetector:
    """Feed `alarm` each reading of a running sensor, and `laid_down` each one that is no alarm.

    `forget` when there was none.
    """

    def __init__(self, live: Live[JoystickConfig]) -> None:
        self._live = live
        self.forget()

    def forget(self) -> None:
        """Readings were missing: what came before says nothing about what comes now."""
        self._disturbance = Disturbance("joystick")
        self._readings = 0
        self._before: Counts | None = None
        self._repeats = 0
        self._window = _Window()
        self._lies = False

    def alarm(self, counts: Counts) -> Trouble:
        """Return why no hand's attitude can be read now; NO_TROUBLE when it can."""
        self._readings += 1
        self._repeats = self._repeats + 1 if counts == self._before else 0
        self._before = counts
        frozen = FROZEN if self._repeats >= FROZEN_READINGS - 1 else NO_TROUBLE
        x, y, z = (count / TILT_LSB_PER_M_S2 for count in counts)
        return self._disturbance.judge((x, y, z), self._readings * TILT_PERIOD_MS / 1000, also=frozen)

    @property
    def may_be_frozen(self) -> bool:
        """Whether too many readings in a row are equal for a new zero to rest on them."""
        return self._repeats >= DOUBTED_READINGS - 1

    def laid_down(self, counts: Counts, *, deflected: bool) -> Trouble:
        """Return why a joystick that is read well is in no hand; NO_TROUBLE when it is in one.

        `deflected`: the reading would drive. Once it lies it does so until it is level: nothing less would arm the
        robot anyway.
        """
        self._window.push(counts)
        still_counts = self._live.config.stillness * TILT_LSB_PER_M_S2
        self._lies = deflected and (self._lies or self._window.spread < still_counts)
        return LAID_DOWN if self._lies else NO_TROUBLE


class _Window:
    """How much the last LAID_DOWN_READINGS differ. Sums of integers: exact, however long it runs."""

    def __init__(self) -> None:
        self._readings: deque[Counts] = deque()
        self._x = self._y = self._z = self._squares = 0

    def push(self, counts: Counts) -> None:
        self._readings.append(counts)
        self._add(counts, 1)
        if len(self._readings) > LAID_DOWN_READINGS:
            self._add(self._readings.popleft(), -1)

    @property
    def spread(self) -> float:
        """Counts, rms of the vector about its mean; infinite before there is a whole window."""
        n = len(self._readings)
        if n < LAID_DOWN_READINGS:
            return math.inf
        return math.sqrt(n * self._squares - self._x**2 - self._y**2 - self._z**2) / n

    def _add(self, counts: Counts, sign: int) -> None:
        x, y, z = counts
        self._x += sign * x
        self._y += sign * y
        self._z += sign * z
        self._squares += sign * (x * x + y * y + z * z)


DETECTION_S: Final = {
    FALLING: TILT_PERIOD_MS / 1000,
    SHAKEN: SHAKE_STEPS * TILT_PERIOD_MS / 1000,
    FROZEN: FROZEN_READINGS * TILT_PERIOD_MS / 1000,
    LAID_DOWN: LAID_DOWN_READINGS * TILT_PERIOD_MS / 1000,
}
"""s from the first such reading to the alarm; of a shake of 4 Hz or more and 12 m/s² or more."""

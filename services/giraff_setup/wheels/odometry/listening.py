"""Hears the wheels of one robot, and makes of them what a run has driven."""

from typing import Final

import numpy as np

from giraff_core.counters import SLACK_TICKS, Standstill, elapsed_us, restart, signed32
from giraff_schemas.messages import Wheels
from giraff_setup.wheels.odometry.plan import POSITION_SD, YAW_SD
from giraff_setup.wheels.odometry.runs import Run

_REST: Final = 0.5
"""s without motion that count as standing."""
_LONGEST_GAP: Final = 0.5
"""s between two samples over which the way is taken for one arc; more is a guess."""
_FASTEST: Final = 3.0
"""m/s that no wheel does: a leap of the counter."""

_LEAP: Final = "a counter leapt farther than a wheel can roll; check the encoders' cables"
_GAP: Final = "wheels were silent while it moved; check base, and the network to it"


class WheelListener:
    """Takes the samples one after another."""

    def __init__(self, ticks_per_metre: float) -> None:
        self._fastest = _FASTEST * ticks_per_metre
        self._last: Wheels | None = None
        self._left: list[int] = []
        self._right: list[int] = []
        self._standstill = Standstill()
        self.fault = ""
        """What has spoilt this run, and the way out; empty: nothing."""

    @property
    def is_at_rest(self) -> bool:
        """For half a second, by the board's clock."""
        return self._standstill.seconds >= _REST

    def begin(self) -> None:
        """A run begins here."""
        self._left, self._right, self.fault = [], [], ""

    def driven(self, name: str) -> Run:
        """The run so far, with nothing measured of it; without the samples between which nothing moved."""
        left, right = (np.array(side, dtype=np.float64) for side in (self._left, self._right))
        return Run(name, left, right, (), POSITION_SD, YAW_SD)

    def on_wheels(self, wheels: Wheels) -> None:
        """The next sample."""
        self._standstill.on_wheels(wheels)
        last = self._last
        if last is None:
            self._last = wheels
            return
        if fault := restart(last, wheels):
            self._spoil(wheels, str(fault))
            return
        elapsed = elapsed_us(last, wheels) / 1e6
        if not elapsed:
            return
        left = signed32(wheels.left_ticks - last.left_ticks)
        right = signed32(wheels.right_ticks - last.right_ticks)
        farther = max(abs(left), abs(right))
        if farther > self._fastest * elapsed + SLACK_TICKS:
            self._spoil(wheels, _LEAP)
            return
        if elapsed > _LONGEST_GAP and farther > 1:
            self._spoil(wheels, _GAP)
            return
        self._last = wheels
        if left or right:
            self._left.append(left)
            self._right.append(right)

    def _spoil(self, wheels: Wheels, fault: str) -> None:
        self._last = wheels
        self.fault = self.fault or fault

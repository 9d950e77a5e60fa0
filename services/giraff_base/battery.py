"""What a battery that runs down means: slower first, then the emergency stop. And when it was last charged."""

from __future__ import annotations

import math
from typing import Final

from giraff_base.config import BaseConfig
from giraff_core.estop.latch import RESET_COMMAND
from giraff_core.live import Live
from giraff_schemas.requests import EStopEngage
from giraff_schemas.trouble import WELL, Trouble

_HELD_NS: Final = 5_000_000_000  # motors that start pull any battery down; what lasts is not that
_RISE: Final = 0.5  # V above the limit: what a battery regains by mere rest is no charge
_LOW_SHARE: Final = 0.5
_CHARGE: Final = 1.0  # V by which a battery of a robot that rests rises when it is charged
_RESTED_NS: Final = 60_000_000_000  # a battery regains volts for about a minute after a load: an estimate

BY: Final = "battery"
"""Who engages the emergency stop when the battery is empty."""


class _Held:
    """A condition that comes and goes only after every reading of 5 s has said so."""

    def __init__(self, *, holds: bool = False) -> None:
        self.holds = holds
        self._held_ns = 0
        self._last_ns: int | None = None  # when the last such reading came; None: there was none just before

    def judge(self, comes: bool, goes: bool, robot_ns: int) -> None:
        if not (goes if self.holds else comes):
            self._held_ns, self._last_ns = 0, None
            return
        if self._last_ns is not None:
            self._held_ns += robot_ns - self._last_ns
        self._last_ns = robot_ns
        if self._held_ns >= _HELD_NS:
            self.holds, self._held_ns, self._last_ns = not self.holds, 0, None

    def pause(self) -> None:
        """Nothing is measured now. That counts as neither, so that a link that comes and goes cannot hide it."""
        self._last_ns = None


class _SinceCharge:
    """Sees a charge by the volts of a robot that rests. A load pulls them down, and they rise again after it."""

    def __init__(self) -> None:
        self._rests_ns: int | None = None  # since when; None: it does not
        self._lowest = math.inf
        self._charged_ns: int | None = None
        self._newest_ns = 0

    def take(self, volts: float, robot_ns: int, *, rests: bool) -> None:
        self._newest_ns = robot_ns
        if not rests:
            self._rests_ns = None
            return
        if self._rests_ns is None:
            self._rests_ns = robot_ns
        if robot_ns - self._rests_ns < _RESTED_NS:
            return
        if volts >= self._lowest + _CHARGE:
            self._charged_ns, self._lowest = robot_ns, volts
        self._lowest = min(self._lowest, volts)

    @property
    def seconds(self) -> float | None:
        return None if self._charged_ns is None else (self._newest_ns - self._charged_ns) * 1e-9


class BatteryWatch:
    """Judges each reading of a battery whose divider is known."""

    def __init__(self, live: Live[BaseConfig], *, was_empty: bool = False) -> None:
        """`was_empty`: an earlier base has stopped the robot for it, so that only a charged battery is not."""
        self._live = live
        self._volts: float | None = None
        self._low, self._empty = _Held(), _Held(holds=was_empty)
        self._since = _SinceCharge()

    @property
    def share(self) -> float:
        """Of the speed."""
        return _LOW_SHARE if self._low.holds else 1.0

    @property
    def stops(self) -> Trouble:
        """Why base engages the emergency stop, and why nobody may reset it."""
        if not self._empty.holds or self._volts is None:
            return WELL
        return Trouble(f"the battery is empty at {self._volts:.1f} V", f"charge it to {self._recharged:g} V")

    @property
    def warning(self) -> Trouble:
        """What is wrong with the battery."""
        is_low = self._low.holds and self._volts is not None
        return self.stops or (Trouble(f"the battery is low at {self._volts:.1f} V", "charge it") if is_low else WELL)

    @property
    def emergency_stop(self) -> EStopEngage:
        """The emergency stop that an empty battery engages."""
        why = self.stops
        return EStopEngage(by=BY, reason=f"{why.what}; {why.remedy}, then {RESET_COMMAND}")

    @property
    def since_charge(self) -> float | None:
        """s, from the last charge that was seen to the newest reading; None: none was."""
        return self._since.seconds

    def take(self, volts: float, robot_ns: int, *, rests: bool) -> None:
        """Take a reading. `rests`: the motors have no power and the wheels stand."""
        low, cutoff = self._live.config.battery_low, self._live.config.battery_cutoff  # 0: off, no battery is below it
        self._volts = volts
        self._low.judge(volts < low, volts >= low + _RISE, robot_ns)
        self._empty.judge(volts < cutoff, volts >= self._recharged, robot_ns)
        self._since.take(volts, robot_ns, rests=rests)

    def pause(self) -> None:
        """The readings have stopped."""
        self._low.pause()
        self._empty.pause()

    @property
    def _recharged(self) -> float:
        """V from which an empty battery drives again."""
        return max(self._live.config.battery_low, self._live.config.battery_cutoff + _RISE)

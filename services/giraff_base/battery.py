"""What a battery that runs down means: slower first, then nothing."""

from __future__ import annotations

from typing import Final

from giraff_base.config import BaseConfig
from giraff_core.live import Live
from giraff_schemas.trouble import WELL, Trouble

_HELD_NS: Final = 5_000_000_000  # motors that start pull any battery down; what lasts is not that
_RISE: Final = 0.5  # V above the limit: what a battery regains by mere rest is no charge
_LOW_SHARE: Final = 0.5


class _Held:
    """A condition that comes and goes only after every reading of 5 s has said so."""

    def __init__(self) -> None:
        self.holds = False
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


class BatteryWatch:
    """Judges each reading of a battery whose divider is known."""

    def __init__(self, live: Live[BaseConfig]) -> None:
        self._live = live
        self._volts = 0.0
        self._low, self._empty = _Held(), _Held()

    @property
    def share(self) -> float:
        """Of the speed."""
        return _LOW_SHARE if self._low.holds else 1.0

    @property
    def stops(self) -> Trouble:
        """Why nothing may move."""
        if not self._empty.holds:
            return WELL
        return Trouble(f"the battery is empty at {self._volts:.1f} V", f"charge it to {self._recharged:g} V")

    @property
    def warning(self) -> Trouble:
        """What is wrong with the battery."""
        low = Trouble(f"the battery is low at {self._volts:.1f} V", "charge it") if self._low.holds else WELL
        return self.stops or low

    def take(self, volts: float, robot_ns: int) -> None:
        low, cutoff = self._live.config.battery_low, self._live.config.battery_cutoff  # 0: off, no battery is below it
        self._volts = volts
        self._low.judge(volts < low, volts >= low + _RISE, robot_ns)
        self._empty.judge(volts < cutoff, volts >= self._recharged, robot_ns)

    def pause(self) -> None:
        """The readings have stopped."""
        self._low.pause()
        self._empty.pause()

    @property
    def _recharged(self) -> float:
        """V from which an empty battery drives again."""
        return max(self._live.config.battery_low, self._live.config.battery_cutoff + _RISE)

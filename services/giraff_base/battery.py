"""A battery that runs down slows the robot, then engages the emergency stop. A charge of it is seen, too."""

import math
from typing import Final

from giraff_base.config import BaseConfig
from giraff_core.live import Live
from giraff_schemas.requests import EStopEngage
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_HELD_NS: Final = 5_000_000_000  # motors that start pull any battery down; what lasts is not that
_LONGEST_NS: Final = 1_000_000_000  # from one reading to the next; a longer gap tells nothing
_RISE: Final = 0.5  # V above the limit: what a battery regains by mere rest is no charge
_LOW_SHARE: Final = 0.5
_CHARGE: Final = 1.0  # V by which a battery of a robot that rests rises when it is charged
_RESTED_NS: Final = 60_000_000_000  # a battery regains volts for about a minute after a load: an estimate
_MEAN_NS: Final = 10_000_000_000  # whose readings give one voltage of a robot that rests: they are noisy
_BY: Final = "battery"


class _Held:
    """A condition that comes and goes when the readings for it are 5 s ahead of those against it.

    So a robot that stops for a moment, again and again, does not hide an empty battery.
    """

    def __init__(self, *, holds: bool = False) -> None:
        self.holds = holds
        self._held_ns = 0
        self._last_ns: int | None = None  # when the last reading came; None: the next one begins anew

    def judge(self, comes: bool, goes: bool, robot_ns: int) -> None:
        since_ns = 0 if self._last_ns is None else robot_ns - self._last_ns
        self._last_ns = robot_ns
        if not 0 <= since_ns <= _LONGEST_NS:
            return
        self._held_ns = max(0, self._held_ns + (since_ns if (goes if self.holds else comes) else -since_ns))
        if self._held_ns >= _HELD_NS:
            self.holds, self._held_ns, self._last_ns = not self.holds, 0, None


class _SinceCharge:
    """Sees a charge by the volts of a robot that rests. A load pulls them down, and they rise again after it."""

    def __init__(self) -> None:
        self._sum, self._count = 0.0, 0  # V, of readings whose mean counts
        self._mean_from_ns: int | None = None  # when the first of these readings came; None: it does not rest
        self._lowest = math.inf
        self._charged_ns: int | None = None
        self._newest_ns = 0

    def on_voltage(self, volts: float, robot_ns: int, *, rests: bool) -> None:
        self._newest_ns = robot_ns
        if not rests:
            self._mean_from_ns = None
            return
        if self._mean_from_ns is None:
            self._sum, self._count, self._mean_from_ns = 0.0, 0, robot_ns + _RESTED_NS
        if robot_ns < self._mean_from_ns:
            return
        self._sum += volts
        self._count += 1
        if robot_ns - self._mean_from_ns < _MEAN_NS:
            return
        mean = self._sum / self._count
        self._sum, self._count, self._mean_from_ns = 0.0, 0, robot_ns
        if mean >= self._lowest + _CHARGE:
            self._charged_ns, self._lowest = robot_ns, mean
        self._lowest = min(self._lowest, mean)

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
        """Reason for base to engage the emergency stop, and to refuse its reset. NO_TROUBLE: there is none."""
        if not self._empty.holds or self._volts is None:
            return NO_TROUBLE
        if self._volts >= self._recharged:
            return Trouble(f"the battery was empty and has {self._volts:.1f} V", f"wait {_HELD_NS // 1_000_000_000} s")
        return Trouble(f"the battery is empty at {self._volts:.1f} V", f"charge it to {self._recharged:g} V")

    @property
    def warning(self) -> Trouble:
        """What is wrong with the battery."""
        is_low = self._low.holds and self._volts is not None
        return self.stops or (
            Trouble(f"the battery is low at {self._volts:.1f} V", "charge it") if is_low else NO_TROUBLE
        )

    @property
    def emergency_stop(self) -> EStopEngage:
        """The emergency stop that an empty battery engages."""
        return EStopEngage(by=_BY, reason=self.stops)

    @property
    def since_charge(self) -> float | None:
        """s, from the last charge that was seen to the newest reading; None: none was."""
        return self._since.seconds

    def on_voltage(self, volts: float, robot_ns: int, *, rests: bool) -> None:
        """Take a reading. `rests`: the motors have no power and the wheels stand."""
        low, cutoff = self._live.config.battery_low, self._live.config.battery_cutoff  # 0: off, no battery is below it
        self._volts = volts
        self._low.judge(volts < low, volts >= low + _RISE, robot_ns)
        self._empty.judge(volts < cutoff, volts >= self._recharged, robot_ns)
        self._since.on_voltage(volts, robot_ns, rests=rests)

    @property
    def _recharged(self) -> float:
        """V from which an empty battery drives again."""
        return max(self._live.config.battery_low, self._live.config.battery_cutoff + _RISE)

"""One wheel against the other: both need about as much power for their speed, or an encoder or a motor is at fault.

A wheel is taken to turn at gain * PWM counts - offset. Friction and a slope make the offset, alike for both wheels that
turn the same way. A wheel is doubted where no such offset explains how unlike the gains seem. A slope across is left
out: it slows one wheel and helps the other.

The evidence is a way: how many metres a wheel lacks, of those that its power makes at the other wheel. It is summed as
CUSUM does (Page, Continuous Inspection Schemes, 1954), so that a fast robot, which turns soonest, is doubted soonest.
"""

from typing import Final, NamedTuple

from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.kinematics.differential_drive import CREEP
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import WheelsFrame

_FACTOR: Final = 1.5
"""Between the gains of two sound wheels: 1.31 at most, of a motor 15 % weak, wheels 2 % off and carpet under one."""
_CREEP_BY_LEVELS: Final = CREEP / _FACTOR  # m/s at most while a wheel is doubted
_CREEP_BY_SPEEDS: Final = CREEP / 3.0
"""m/s. A wheel that holds a speed gets faster by the counts that its encoder loses, and turns the robot. Where two
thirds are lost it does not exceed CREEP."""
_OFFSETS: Final = (-0.08, -0.04, 0.0, 0.04, 0.08)
"""m/s. Offsets that are tried: a slope of 3 degrees either way; friction is less."""
_FROM: Final = 0.18  # m/s of the faster wheel, as its encoder tells it: from 0.2 m/s on it is always judged
_LEAST_PWM: Final = 8  # counts of 255: fewer are mostly rounding and dead zone
_LACK: Final = 0.015  # m. Sound wheels that start, stop or meet an edge lack 0.013 m at most
_LASTS: Final = 0.35
"""s of driving over which a wheel must lack something. Sound wheels do for 0.17 s at most, and for less than this even
where `motor_time` is 1.7 times the true one."""
_PAUSE: Final = 0.3  # s without driving, after which an offset may be another one
_LONGEST_GAP_US: Final = 50_000


def creep(config: WheelsConfig) -> float:
    """Return the m/s that a wheel may turn at most while an encoder is doubted."""
    return _CREEP_BY_SPEEDS if config.asks_for_speeds else _CREEP_BY_LEVELS


class WheelDoubt:
    """Judges wheels that drive. A doubt lasts until the port is opened anew: a sound moment proves no repair."""

    def __init__(self, config: WheelsConfig) -> None:
        self._motor_time = config.speed_control.motor_time
        self.forget()

    def forget(self) -> None:
        """Begin anew: the port was opened, perhaps again."""
        self._last: WheelsFrame | None = None
        self._last_way = 0
        self._paused = 0.0
        self.trouble = NO_TROUBLE
        """Names the wheel that is doubted, and says what to do."""
        self._restart()

    def on_report(self, report: WheelsFrame) -> None:
        """Judge the wheels by one more report."""
        last, self._last = self._last, report
        gap_us = (report.board_us - last.board_us) & 0xFFFFFFFF if last is not None else 0
        if last is None or last.boot_id != report.boot_id:
            self._restart()
            return
        seconds = gap_us * 1e-6
        if gap_us > _LONGEST_GAP_US or not (way := _way(report)):
            self._paused += seconds  # only this report is left out: lost reports and short stops must hide no slip
            return
        if self._paused > _PAUSE or way != self._last_way:
            self._restart()  # the robot may have turned, and a slope that held it may push it now
        self._last_way, self._paused = way, 0.0
        left = self._work(way * report.left_um_s, way * last.left_um_s, abs(report.left_pwm_counts), seconds)
        right = self._work(way * report.right_um_s, way * last.right_um_s, abs(report.right_pwm_counts), seconds)
        self._left.add(left, right, seconds)
        self._right.add(right, left, seconds)
        if not self.trouble and (self._left.is_sure or self._right.is_sure):
            self.trouble = _doubted("left" if self._left.is_sure else "right")

    def _work(self, um_s: int, before_um_s: int, power: int, seconds: float) -> "_Work":
        """Return the work of a wheel between two reports. Power also speeds a wheel up."""
        return _Work(1e-6 * (um_s * seconds + (um_s - before_um_s) * self._motor_time), power)

    def _restart(self) -> None:
        self._left, self._right = _Lack(), _Lack()


class _Work(NamedTuple):
    """A wheel's work between two reports."""

    due: float
    """m that its power has made, as far as its encoder tells."""
    power: int
    """PWM counts."""


class _Lack:
    """The way that one wheel lacks, of the way that its power makes at the other wheel."""

    def __init__(self) -> None:
        self._metres = [0.0] * len(_OFFSETS)  # by each offset
        self._seconds = 0.0  # for which it has lacked something by each of them

    @property
    def is_sure(self) -> bool:
        """Whether a fault explains it, and nothing else."""
        return min(self._metres) > _LACK and self._seconds > _LASTS

    def add(self, own: _Work, other: _Work, seconds: float) -> None:
        """Add what both wheels did in these `seconds` of driving. A wheel that does well again pays its lack back."""
        most_power = max(own.power, other.power)
        for index, offset in enumerate(_OFFSETS):
            has = own.due + offset * seconds
            made = _FACTOR * has * other.power if has > 0.0 else 0.0
            lack = self._metres[index] + ((other.due + offset * seconds) * own.power - made) / most_power
            self._metres[index] = max(0.0, lack)
        self._seconds = self._seconds + seconds if min(self._metres) > 0.0 else 0.0


def _way(report: WheelsFrame) -> int:
    """Return 1 or -1 where both wheels turn that way as their motors do, one of them at _FROM at least; else 0."""
    left, right = report.left_um_s, report.right_um_s
    powers = report.left_pwm_counts, report.right_pwm_counts
    if max(abs(left), abs(right)) * 1e-6 < _FROM or min(map(abs, powers)) < _LEAST_PWM:
        return 0
    if all(value > 0 for value in (left, right, *powers)):
        return 1
    return -1 if all(value < 0 for value in (left, right, *powers)) else 0


def _doubted(name: str) -> Trouble:
    return Trouble(
        f"encoder or motor of the {name} wheel: it turns much less for its power than the other one",
        "check both, their cables and what rubs on the wheel, then restart giraff_base",
    )

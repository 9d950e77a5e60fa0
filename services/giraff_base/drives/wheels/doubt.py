"""One wheel against the other: both need about alike much power for their speed, or an encoder or a motor is at fault.

A wheel is taken to turn at gain * PWM counts - offset. Friction and a slope make the offset, alike for both wheels that
turn the same way. A wheel is doubted where no such offset explains how unlike the gains seem. A slope across is left
out: it slows one wheel and helps the other.
"""

from __future__ import annotations

from typing import Final

from giraff_core.kinematics.differential_drive import CREEP
from giraff_schemas.trouble import WELL, Trouble
from giraff_schemas.wire import WheelsFrame

_FACTOR: Final = 1.5
"""Between the gains of two sound wheels: 1.31 at most, of a motor 15 % weak, wheels 2 % off and carpet under one."""
DOUBTED_SPEED: Final = CREEP / _FACTOR
"""m/s at most while a wheel is doubted: an encoder that loses counts makes its wheel faster than it tells."""
_OFFSET: Final = 0.08  # m/s either way: a slope of 3 degrees; friction is less
_FROM: Final = 0.18  # m/s of the faster wheel, as its encoder tells it: from 0.2 m/s on it is always judged
_LEAST_PWM: Final = 8  # counts of 255: fewer are mostly rounding and dead zone
_WINDOW: Final = 1.0  # s of driving: so 2 s of it hold a whole one
_LONGEST_GAP_US: Final = 50_000


class WheelDoubt:
    """Judges each second of driving. A doubt lasts until the port is opened anew: a sound moment proves no repair."""

    def __init__(self, motor_time: float) -> None:
        """`motor_time`: s; time constant of a motor."""
        self._motor_time = motor_time
        self._last: WheelsFrame | None = None
        self.trouble = WELL
        """Names the wheel that is doubted, and says what to do."""
        self._restart()

    def forget(self) -> None:
        """Begin anew: the port was opened, perhaps again."""
        self.trouble, self._last = WELL, None
        self._restart()

    def take(self, report: WheelsFrame) -> None:
        """Judge the wheels by one more report."""
        last, self._last = self._last, report
        gap_us = (report.board_us - last.board_us) & 0xFFFFFFFF if last is not None else 0
        if last is None or last.boot_id != report.boot_id:
            self._restart()
            return
        if gap_us > _LONGEST_GAP_US or not _drives(report):
            return  # only this report is left out: lost reports and stops must not hide a wheel that slips
        seconds = gap_us * 1e-6
        self._seconds += seconds
        for wheel, (speed, before, pwm) in enumerate(
            (
                (report.left_um_s, last.left_um_s, report.left_pwm_counts),
                (report.right_um_s, last.right_um_s, report.right_pwm_counts),
            )
        ):
            sign = 1 if pwm > 0 else -1
            # What speeds a wheel up takes power, too.
            self._due[wheel] += sign * 1e-6 * (speed * seconds + (speed - before) * self._motor_time)
            self._power[wheel] += sign * pwm * seconds
        if self._seconds >= _WINDOW:
            for wheel, name in enumerate(("left", "right")):
                if not self.trouble and self._lacks(wheel):
                    self.trouble = _doubted(name)
            self._restart()

    def _lacks(self, wheel: int) -> bool:
        """Return whether a wheel has done too little for its power, whatever the floor did to both."""
        other = 1 - wheel
        for offset in (-_OFFSET * self._seconds, _OFFSET * self._seconds):
            has, most = max(0.0, self._due[wheel] + offset), self._due[other] + offset
            if _FACTOR * has * self._power[other] >= most * self._power[wheel]:
                return False
        return True

    def _restart(self) -> None:
        self._seconds = 0.0
        self._due = [0.0, 0.0]  # m that each wheel's power has made
        self._power = [0.0, 0.0]  # PWM counts, times s


def _drives(report: WheelsFrame) -> bool:
    """Return whether both wheels turn the same way as their motors, one of them at _FROM at least."""
    left, right = report.left_um_s, report.right_um_s
    powers = report.left_pwm_counts, report.right_pwm_counts
    if max(abs(left), abs(right)) * 1e-6 < _FROM or min(map(abs, powers)) < _LEAST_PWM:
        return False
    return all(value > 0 for value in (left, right, *powers)) or all(value < 0 for value in (left, right, *powers))


def _doubted(name: str) -> Trouble:
    return Trouble(
        f"encoder or motor of the {name} wheel: it turns much less for its power than the other one",
        "check both, their cables and what rubs on the wheel, then restart giraff_base",
    )

"""What the motors' pins give, beside what base asked of its board and what the robot may do at all."""

import math
from collections import deque
from typing import Final, NamedTuple, Self

from giraff_base.config import BaseConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.robot import RobotConfig
from giraff_schemas.wire import PWM_OVER_BLIND_PERCENT, PWM_OVER_PERCENT, DriveFrame, SpeedFrame
from giraff_sim.bodies.wheels.body import WheelsBody

_SPEED_OFF: Final = 2e-6  # m/s: a frame has whole micrometres a second
_WINDOW_US: Final = 100_000  # over which a ramp is measured
_STEPS_US: Final = 12_000  # of the simulation and of the board's reports, at both ends of it
_ROUNDING: Final = 2.5  # PWM counts: of two levels, and of the drive's mean over a step
_OVERSHOOT: Final = 0.06  # m/s: a tenth of the largest speed


class WheelRequest(NamedTuple):
    """What base asks of the wheels, m/s."""

    left: float
    right: float
    off: float
    """By rounding."""

    @classmethod
    def by(cls, frame: DriveFrame | SpeedFrame, robot: RobotConfig, drive: WheelsConfig) -> Self:
        """What a frame stands for."""
        if isinstance(frame, SpeedFrame):
            return cls(frame.left_um_s * 1e-6, frame.right_um_s * 1e-6, _SPEED_OFF)
        speed_per_level = robot.max_wheel_speed / drive.max_level
        return cls(frame.left_level * speed_per_level, frame.right_level * speed_per_level, speed_per_level)

    def __str__(self) -> str:
        return f"{self.left:+.3f}, {self.right:+.3f} m/s"


class Pins:
    """Asked after each step. Counts are PWM counts of 255."""

    def __init__(self, body: WheelsBody, robot: RobotConfig, config: BaseConfig, outlives_us: int) -> None:
        """`outlives_us`: for so long a frame may have effect."""
        self._body = body
        self._drive = drive = body.drive
        self._by_speed = drive.asks_for_speeds
        # A pulse's width is rounded to its timer's counts.
        rounds_up = 1 if body.settles_us else 0
        self._most_counts = rounds_up + (drive.speed_control.max_pwm if self._by_speed else drive.max_level)
        self._counts_per_speed = drive.max_level / robot.max_wheel_speed
        turn = config.angular_acceleration * robot.kinematics.track_width / 2.0
        self._speeds_up = (config.linear_acceleration + turn) * drive.speed_control.motor_time
        if self._by_speed:
            # By wheels: where something holds one, the robot turns, and none has risen.
            wheel = config.linear_acceleration + turn
            self._rises = Rises(wheel, wheel, _OVERSHOOT, "m/s", by_wheel=True)
        else:
            per_speed = self._counts_per_speed
            most = config.linear_acceleration * per_speed, turn * per_speed
            self._rises = Rises(*most, _ROUNDING + rounds_up, late_us=body.settles_us)
        self._rises_wrongly = ""
        self._lost = 0.0, 0.0  # share of counts that each encoder loses
        self._resets, self._judged_from_us = body.resets, 0
        lasts_us = outlives_us + body.settles_us
        self._asked = (_Extremes(lasts_us), _Extremes(lasts_us))  # of the left and the right wheel, m/s

    def asked(self, asked: WheelRequest, now_us: int) -> None:
        """Base has asked the board for this."""
        for wheel, speed in zip(self._asked, (asked.left, asked.right), strict=True):
            wheel.add(speed, now_us)

    def note(self, now_us: int) -> None:
        """Remember how the wheels turn, also without power."""
        if self._body.resets != self._resets or self._body.has_cut_signal:
            # Either cuts a servo pulse short. Nothing hinders the motor driver from obeying the piece.
            self._resets, self._judged_from_us = self._body.resets, now_us + self._body.settles_us
        if self._by_speed:
            plant = self._body.plant
            lost = plant.left.lost_share, plant.right.lost_share
            if lost != self._lost:  # counted speeds leap, wheels do not
                self._lost, self._judged_from_us = lost, now_us + _WINDOW_US + _STEPS_US
            self._rises_wrongly = self._rises.judge(plant.left.counted_speed, plant.right.counted_speed, now_us)

    def judge(self, now_us: int) -> str:
        """What is wrong with the drive of this step, in which a motor has power; empty when nothing is."""
        left, right = self._body.drives
        if now_us < self._judged_from_us:
            return ""
        if not self._by_speed:
            self._rises_wrongly = self._rises.judge(left, right, now_us)
        return self._too_much() or self._unasked(left, right, now_us) or self._rises_wrongly

    def _too_much(self) -> str:
        peak, most = self._body.activity, self._most_counts
        return f"{peak} counts at a motor, where {most} is the most" if peak > most else ""

    def _unasked(self, left: float, right: float, now_us: int) -> str:
        for name, given, asked in zip(("left", "right"), (left, right), self._asked, strict=True):
            # From 0 on: a motor that stops within a step has had less in the mean. What a speed is worth rises with it.
            least, most = map(self._counts_for, asked.around_zero(now_us))
            if not least - _ROUNDING <= given <= most + _ROUNDING:
                return f"{given:+.0f} counts at the {name} motor, for which base has not asked"
        return ""

    def _counts_for(self, speed: float) -> float:
        """What a speed is worth; of a wheel that is to hold it, the most that it may take."""
        if not self._by_speed or speed == 0.0:
            return speed * self._counts_per_speed
        plant, drive = self._body.plant, self._drive
        over = PWM_OVER_PERCENT if drive.battery_volts_per_count else PWM_OVER_BLIND_PERCENT
        counts = (abs(speed) + self._speeds_up) * self._counts_per_speed
        if drive.battery_volts_per_count:
            counts *= drive.battery_nominal / plant.volts
        return math.copysign((counts + drive.speed_control.dead_pwm) * (1.0 + over / 100.0), speed)


class _Extremes:
    """The least and the greatest value of the last `lasts_us`. Only values that can still become one are kept."""

    def __init__(self, lasts_us: int) -> None:
        self._lasts_us = lasts_us
        self._falling: deque[tuple[int, float]] = deque()  # each greater than those after it
        self._rising: deque[tuple[int, float]] = deque()

    def add(self, value: float, now_us: int) -> None:
        falling, rising = self._falling, self._rising
        while falling and falling[-1][1] <= value:
            falling.pop()
        while rising and rising[-1][1] >= value:
            rising.pop()
        falling.append((now_us, value))
        rising.append((now_us, value))

    def around_zero(self, now_us: int) -> tuple[float, float]:
        """Return the least and the greatest value, 0 among them."""
        for kept in (self._falling, self._rising):
            while kept and now_us - kept[0][0] > self._lasts_us:
                kept.popleft()
        if not self._falling:
            return 0.0, 0.0
        return min(0.0, self._rising[0][1]), max(0.0, self._falling[0][1])


class _Given(NamedTuple):
    at_us: int
    left: float
    right: float
    is_whole: bool
    """Not of a step in which a motor reverses: it is off for a moment then, and nothing rises from there."""


class Rises:
    """How fast driving and turning rise, or both wheels."""

    def __init__(
        self,
        first: float,
        second: float,
        off: float = _ROUNDING,
        unit: str = "counts",
        *,
        by_wheel: bool = False,
        late_us: int = 0,
    ) -> None:
        """What both may rise by in a second, in the unit; `off`, in the unit, does not count.

        `late_us`: by so much may what is given be older than what was asked.
        """
        self._most = first, second
        self._off, self._unit = off, unit
        self._steps_us = _STEPS_US + late_us
        self._by_wheel = by_wheel
        self._given: deque[_Given] = deque()

    def judge(self, left: float, right: float, now_us: int) -> str:
        """What rises too fast, of what the motors get or the wheels do. Asked after each step in which they do."""
        given = self._given
        if given and now_us - given[-1].at_us > _STEPS_US:
            given.clear()  # without power in between: from rest
        reverses = bool(given) and (given[-1].left * left < 0.0 or given[-1].right * right < 0.0)
        if reverses:
            given[-1] = given[-1]._replace(is_whole=False)
        given.append(_Given(now_us, left, right, not reverses))
        while now_us - given[0].at_us > _WINDOW_US:
            given.popleft()
        start = next((each for each in given if each.is_whole), given[0])
        if now_us - given[0].at_us < _WINDOW_US - _STEPS_US:
            start = _Given(now_us - _WINDOW_US, 0.0, 0.0, is_whole=True)
        seconds = (now_us - start.at_us + self._steps_us) * 1e-6
        names = ("the left wheel", "the right wheel") if self._by_wheel else ("drive", "turn")
        for name, now, then, most in zip(names, self._parts(given[-1]), self._parts(start), self._most, strict=True):
            begin = abs(then) if now * then > 0.0 else 0.0
            if abs(now) > begin + most * seconds + self._off:
                return f"{name} rises from {begin:.4g} to {abs(now):.4g} {self._unit} within {_WINDOW_US / 1e6:g} s"
        return ""

    def _parts(self, given: _Given) -> tuple[float, float]:
        """The wheels; else driving and turning, which are mean and half difference."""
        if self._by_wheel:
            return given.left, given.right
        return (given.left + given.right) / 2.0, (given.right - given.left) / 2.0

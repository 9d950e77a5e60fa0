"""What the motors' pins give, beside what base asked of its board and what the robot may do at all."""

from __future__ import annotations

from collections import deque
from typing import Final, NamedTuple

from giraff_base.config import BaseConfig
from giraff_core.robot import RobotConfig
from giraff_schemas.wire import BoardKind, DriveFrame
from giraff_sim.simulation import Simulation

_WINDOW_US: Final = 100_000  # over which a ramp is measured
_STEPS_US: Final = 12_000  # of the simulation and of the board's reports, at both ends of it
_ROUNDING: Final = 2.5  # PWM counts: of two levels, and of the drive's mean over a step


class Pins:
    """Asked after each step while a motor has power. Counts are PWM counts of 255."""

    def __init__(self, simulation: Simulation, robot: RobotConfig, config: BaseConfig, outlives_us: int) -> None:
        """`outlives_us`: for so long a frame may have effect."""
        self._simulation = simulation
        self._max_level = robot.max_level
        counts_per_speed = robot.max_level / robot.max_wheel_speed
        self._rises = Rises(
            config.linear_acceleration * counts_per_speed,
            config.angular_acceleration * robot.track_width / 2.0 * counts_per_speed,
        )
        self._outlives_us = outlives_us
        self._asked: deque[tuple[int, int, int]] = deque()  # when, left, right

    def asked(self, frame: DriveFrame, now_us: int) -> None:
        """Base has sent a drive frame."""
        self._asked.append((now_us, frame.left_level, frame.right_level))

    def look(self, now_us: int) -> str:
        """What is wrong with the drive of this step; empty when nothing is."""
        motors = self._simulation.boards[BoardKind.BASE].model.motor
        left, right = float(motors[0].drive), float(motors[1].drive)
        return self._too_much() or self._unasked(left, right, now_us) or self._rises.look(left, right, now_us)

    def _too_much(self) -> str:
        peak = self._simulation.peak_counts
        return f"{peak} counts at a motor, where {self._max_level} is the most" if peak > self._max_level else ""

    def _unasked(self, left: float, right: float, now_us: int) -> str:
        asked = self._asked
        while asked and now_us - asked[0][0] > self._outlives_us:
            asked.popleft()
        for name, given, levels in (
            ("left", left, [level for _, level, _ in asked]),
            ("right", right, [level for _, _, level in asked]),
        ):
            # From 0 on: a motor that stops within a step has had less in the mean.
            if not min((0, *levels)) - _ROUNDING <= given <= max((0, *levels)) + _ROUNDING:
                return f"{given:+.0f} counts at the {name} motor, for which base has not asked"
        return ""


class _Given(NamedTuple):
    at_us: int
    left: float
    right: float
    is_whole: bool
    """Not of a step in which a motor reverses: it is off for a moment then, and nothing rises from there."""

    @property
    def parts(self) -> tuple[float, float]:
        """Driving and turning: mean and half difference."""
        return (self.left + self.right) / 2.0, (self.right - self.left) / 2.0


class Rises:
    """How fast driving and turning rise at the motors."""

    def __init__(self, drive: float, turn: float) -> None:
        """Both in counts a second, at the most."""
        self._most = drive, turn
        self._given: deque[_Given] = deque()

    def look(self, left: float, right: float, now_us: int) -> str:
        """What rises too fast, of these counts at the motors. Asked after each step while one of them has power."""
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
        seconds = (now_us - start.at_us + _STEPS_US) * 1e-6
        for name, now, then, most in zip(("drive", "turn"), given[-1].parts, start.parts, self._most, strict=True):
            begin = abs(then) if now * then > 0.0 else 0.0
            if abs(now) > begin + most * seconds + _ROUNDING:
                return f"{name} rises from {begin:.0f} to {abs(now):.0f} counts within {_WINDOW_US / 1e6:g} s"
        return ""

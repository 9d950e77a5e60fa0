"""What the motors' pins give, beside what base asked of its board and what the robot may do at all."""

from __future__ import annotations

from collections import deque
from typing import Final

from giraff_base.config import BaseConfig
from giraff_node.robot import RobotConfig
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
        seconds = (_WINDOW_US + _STEPS_US) * 1e-6
        self._rises = (
            config.linear_acceleration * seconds * counts_per_speed,
            config.angular_acceleration * seconds * robot.track_width / 2.0 * counts_per_speed,
        )
        self._outlives_us = outlives_us
        self._asked: deque[tuple[int, int, int]] = deque()  # when, left, right
        self._given: deque[tuple[int, float, float]] = deque()  # when, mean and half difference

    def asked(self, frame: DriveFrame, now_us: int) -> None:
        """Base has sent a drive frame."""
        self._asked.append((now_us, frame.left_level, frame.right_level))

    def look(self, now_us: int) -> str:
        """What is wrong with the drive of this step; empty when nothing is."""
        motors = self._simulation.boards[BoardKind.BASE].model.motor
        left, right = float(motors[0].drive), float(motors[1].drive)
        return self._too_much() or self._unasked(left, right, now_us) or self._unramped(left, right, now_us)

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

    def _unramped(self, left: float, right: float, now_us: int) -> str:
        mean, half = (left + right) / 2.0, (right - left) / 2.0
        given = self._given
        given.append((now_us, mean, half))
        while now_us - given[0][0] > _WINDOW_US:
            given.popleft()
        since_us, *before = given[0]
        if now_us - since_us < _WINDOW_US - _STEPS_US:
            before = [0.0, 0.0]  # without power in between
        for name, now, then, rise in zip(("drive", "turn"), (mean, half), before, self._rises, strict=True):
            start = abs(then) if now * then > 0.0 else 0.0
            if abs(now) > start + rise + _ROUNDING:
                return f"{name} rises from {then:+.0f} to {now:+.0f} counts within {_WINDOW_US / 1e6:g} s"
        return ""

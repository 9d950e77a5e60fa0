"""From a twist to what each wheel is asked for: limits, ramp, mixing."""

from __future__ import annotations

import math
from collections.abc import Callable

from giraff_core.base_commands import BaseCommands
from giraff_core.robot import RobotConfig
from giraff_core.wheel_control import UM_PER_M
from giraff_schemas.wire import Frame, WheelsFrame

_LEAST_SPEED = 0.005  # m/s: nothing tells a slower wheel from one that stands; nor is the end of a slowing down a drive
_LONGEST_STEP = 0.02  # s, two reports of the board: a ramp does not jump after a pause


class WheelDemand:
    """Asks the wheels for what `wheel_control` says: PWM levels, each of which stands for a speed, or the speeds."""

    def __init__(self, robot: RobotConfig, commands: BaseCommands) -> None:
        self._drive = robot.kinematics
        self._frame: Callable[[WheelsFrame, int, int], Frame]
        if robot.asks_for_speeds:
            self._per_speed, self._frame, self._least = UM_PER_M, commands.speed, _LEAST_SPEED
        else:
            self._per_speed, self._frame, self._least = robot.max_level / robot.max_wheel_speed, commands.drive, 0.0

    def of(self, linear_x: float, angular_z: float) -> tuple[int, int]:
        """What a twist (m/s, rad/s) takes of the left and the right wheel: levels, or µm/s; forward positive.

        Both are scaled alike so that neither exceeds the largest level or speed: the curvature is kept.
        """
        left, right = self._drive.wheel_speeds(*self._drive.within_limits(linear_x, angular_z))
        if max(abs(left), abs(right)) < self._least:
            return 0, 0
        return round(left * self._per_speed), round(right * self._per_speed)

    def frame(self, report: WheelsFrame, demand: tuple[int, int]) -> Frame:
        """The answer to `report` that asks for it."""
        return self._frame(report, *demand)


def ramped(now_at: float, target: float, largest_step: float) -> float:
    """The next value from `now_at` to `target`: away from zero by at most `largest_step`, towards it at once.

    A reversal passes through zero: what is asked in the old direction ends now, the new one starts from rest.
    """
    if math.copysign(1.0, now_at) != math.copysign(1.0, target):
        now_at = 0.0
    return math.copysign(min(abs(target), abs(now_at) + largest_step), target)


class Ramp:
    """The twist that is asked of the motors now, on its way to the one that may be driven."""

    def __init__(self, linear_acceleration: float, angular_acceleration: float) -> None:
        self.limit(linear_acceleration, angular_acceleration)
        self.linear = self.angular = 0.0
        self._at_ns = 0

    def limit(self, linear_acceleration: float, angular_acceleration: float) -> None:
        """m/s², rad/s²; of starts only."""
        self._linear_acceleration = linear_acceleration
        self._angular_acceleration = angular_acceleration

    def stop(self) -> None:
        self.linear = self.angular = 0.0

    def follow(self, linear: float, angular: float, robot_ns: int) -> None:
        """Go on to what may be driven at `robot_ns`."""
        seconds = min(_LONGEST_STEP, max(0.0, (robot_ns - self._at_ns) * 1e-9))
        self._at_ns = robot_ns
        self.linear = ramped(self.linear, linear, self._linear_acceleration * seconds)
        self.angular = ramped(self.angular, angular, self._angular_acceleration * seconds)

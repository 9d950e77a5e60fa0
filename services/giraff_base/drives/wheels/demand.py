"""From a twist to what each wheel is asked for."""

from __future__ import annotations

from collections.abc import Callable

from giraff_base.drives.wheels.commands import WheelsCommands
from giraff_base.drives.wheels.config import UM_PER_M, WheelsConfig
from giraff_core.robot import RobotConfig
from giraff_schemas.wire import Frame, WheelsFrame

_LEAST_SPEED = 0.005  # m/s: nothing tells a slower wheel from one that stands; nor is the end of a slowing down a drive


class WheelDemand:
    """Asks the wheels for what `wheel_control` says: PWM levels, each of which stands for a speed, or the speeds."""

    def __init__(self, robot: RobotConfig, config: WheelsConfig, commands: WheelsCommands) -> None:
        self._kinematics = robot.kinematics
        self._frame: Callable[[WheelsFrame, int, int], Frame]
        if config.asks_for_speeds:
            self._per_speed, self._frame, self._least = UM_PER_M, commands.speed, _LEAST_SPEED
        else:
            self._per_speed, self._frame, self._least = config.max_level / robot.max_wheel_speed, commands.drive, 0.0

    def of(self, linear_x: float, angular_z: float) -> tuple[int, int]:
        """What a twist (m/s, rad/s) takes of the left and the right wheel: levels, or µm/s; forward positive.

        Both are scaled alike so that neither exceeds the largest level or speed: the curvature is kept.
        """
        left, right = self._kinematics.wheel_speeds(*self._kinematics.within_limits(linear_x, angular_z))
        if max(abs(left), abs(right)) < self._least:
            return 0, 0
        return round(left * self._per_speed), round(right * self._per_speed)

    def frame(self, report: WheelsFrame, demand: tuple[int, int]) -> Frame:
        """The answer to `report` that asks for it."""
        return self._frame(report, *demand)

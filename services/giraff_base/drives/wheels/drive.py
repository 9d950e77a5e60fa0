"""The dialogue with `firmware/base`: its settings, and frames of levels or speeds."""

from collections.abc import Callable
from typing import Final

from giraff_base.drive import Answer, SpeedLimit
from giraff_base.drives.dialogue import Dialogue
from giraff_base.drives.wheels.camera_doubt import CameraDoubt
from giraff_base.drives.wheels.commands import WheelsCommands
from giraff_base.drives.wheels.config import UM_PER_M, WheelsConfig
from giraff_base.drives.wheels.doubt import WheelDoubt, creep
from giraff_base.drives.wheels.reports import WheelReports
from giraff_base.drives.wheels.words import BLIND, engaged_by, held, limit, silent
from giraff_core.robot import RobotConfig
from giraff_schemas.camera import VisualOdometry
from giraff_schemas.messages import RobotTime, Sample, Side
from giraff_schemas.requests import EStopEngage
from giraff_schemas.topics import WHEELS
from giraff_schemas.trouble import Trouble
from giraff_schemas.wire import PWM_OVER_BLIND_PERCENT, Frame, Latch, WheelsFrame

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


_ZERO = (0, 0)
_BLIND_OVER: Final = 1.0 + PWM_OVER_BLIND_PERCENT / 100.0
"""Factor by which a board that does not know its volts may drive faster than asked, where both encoders lose counts."""

_SILENT_WAY: Final = 0.25
"""m that the wheels may turn on while a motor controller that others have made hears nobody any more: the margin
of a guard by its defaults. No robot file changes it."""


class WheelsDrive(Dialogue[WheelsFrame]):
    """The `giraff_base.drive.Drive` of two wheels."""

    topics = (WHEELS,)
    can_power_off = False

    def __init__(self, robot: RobotConfig, config: WheelsConfig, acceleration: float) -> None:
        """`acceleration`: m/s² of the faster wheel, where driving and turning start at once."""
        super().__init__(WheelsFrame, Latch)
        self._config = config
        self._frames = WheelsCommands()
        self._demand = WheelDemand(robot, config, self._frames)
        config.require_countable(robot)
        config.require_its_levels(robot)
        self._settings = config.board_settings(robot, acceleration)
        self._board = config.board_type
        self._reports = WheelReports(robot.ticks_per_metre)
        self._doubt, self._camera_doubt = WheelDoubt(config), CameraDoubt(robot.ticks_per_metre)
        self._limit = SpeedLimit()
        if config.asks_for_speeds and not config.battery_volts_per_count:
            self._limit = SpeedLimit(robot.max_wheel_speed / _BLIND_OVER, BLIND)
        slowest = min(self._limit.speed, robot.max_wheel_speed)
        if (drives_on := self._board.stops_after_s) and _SILENT_WAY / drives_on < slowest:
            self._limit = SpeedLimit(_SILENT_WAY / drives_on, silent(_SILENT_WAY / drives_on, drives_on))

    @property
    def at_rest(self) -> bool:
        return self._reports.at_rest

    @property
    def warning(self) -> Trouble:
        return self._reports.warning

    @property
    def voltage(self) -> float | None:
        if self._report is None or self._config.battery_volts_per_count == 0.0:
            return None
        return self._report.battery_adc_counts * self._config.battery_volts_per_count

    @property
    def limit(self) -> SpeedLimit:
        doubted = self._doubt.trouble or self._camera_doubt.trouble
        if doubted and (slow := creep(self._config)) < self._limit.speed:
            return SpeedLimit(slow, doubted)
        return self._limit

    def open(self, session: int) -> None:
        self._reports.forget()
        self._doubt.forget()
        self._camera_doubt.forget()
        super().open(session)

    def on_camera(self, told: VisualOdometry, now: RobotTime) -> None:
        self._camera_doubt.on_camera(told, now)

    def ask(self, linear: float, angular: float, *, armed: bool, free_side: Side) -> Answer:  # noqa: ARG002  it stands by itself
        report, demand = self._newest, self._demand.of(linear, angular)
        moves = demand != _ZERO
        return Answer(self._demand.frame(report, demand), limit(report, self._board) if moves else None, moves)

    def _halts(self, report: WheelsFrame) -> list[Trouble]:
        return [by] if (by := held(report)) else []

    def _latched(self, report: WheelsFrame) -> EStopEngage:
        return engaged_by(report.latch)

    def _samples(self, report: WheelsFrame, now: RobotTime) -> tuple[Sample, ...]:
        self._doubt.on_report(report)
        sample = self._reports.on_report(report, now)
        self._camera_doubt.on_wheels(sample)
        return (sample,)

    def _configure(self, report: WheelsFrame) -> Frame:
        return self._frames.configure(report, self._session, self._settings)

    def _estop(self, report: WheelsFrame, *, engage: bool) -> Frame:
        return self._frames.estop(report, self._session, engage=engage)

"""The dialogue with `firmware/balancer`: its settings, what it is asked for, and what makes it stand up."""

from typing import Final

import msgspec

from giraff_base.drive import Answer
from giraff_base.drives.balancer.config import BalancerConfig
from giraff_base.drives.balancer.words import (
    AT_LIMIT,
    GETS_UP,
    HELD,
    NEW_GAINS,
    ONLY_STANDS,
    cause,
    latched_by,
    left_standing,
    lies,
    posture,
    stopped_by,
    untouched,
)
from giraff_base.drives.dialogue import Dialogue
from giraff_core.kinematics.differential_drive import DifferentialDrive
from giraff_core.robot import RobotConfig
from giraff_schemas.messages import Attitude, RobotTime, Sample, Side, Wheels
from giraff_schemas.requests import EStopEngage
from giraff_schemas.topics import ATTITUDE, WHEELS
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import DriveState, Frame
from giraff_schemas.wires.balancer import (
    DRIVER_FULL,
    BalanceAsk,
    BalanceDriveFrame,
    BalanceEngage,
    BalanceEstopFrame,
    BalanceFlag,
    BalanceFrame,
    BalanceLatch,
    BalancePosture,
    BalanceSide,
)

_FULL_PWM: Final = 255


def wheels(report: BalanceFrame, kinematics: DifferentialDrive, tick: RobotTime) -> Wheels:
    """Return what the wheels do on the floor, without what they turn as the body leans."""
    left, right = kinematics.wheel_speeds(report.speed_um_s * 1e-6, report.turn_urad_s * 1e-6)
    return Wheels(
        left_ticks=report.left_counts,
        right_ticks=report.right_counts,
        left_velocity=left,
        right_velocity=right,
        left_pwm_counts=round(report.left_command * _FULL_PWM / DRIVER_FULL),
        right_pwm_counts=round(report.right_command * _FULL_PWM / DRIVER_FULL),
        board_us=report.board_us,
        boot_id=report.boot_id,
        tick=tick,
    )


def attitude(report: BalanceFrame, pivot: float, tick: RobotTime) -> Attitude:
    """Return how the robot holds itself. `pivot`: m of its axle above the floor."""
    return Attitude(
        lean=report.lean_urad * 1e-6,
        rate=report.rate_urad_s * 1e-6,
        accelerometer_lean=report.accelerometer_urad * 1e-6,
        trim=report.trim_urad * 1e-6,
        torque=report.torque_mnm * 1e-3,
        posture=posture(report),
        cause=cause(report).what,
        tick=tick,
        pivot=pivot,
    )


_LEAST_SPEED: Final = 0.005  # m/s: less is the end of a slowing down, and no drive
_TAKEN: Final = 0.1  # rad, 6 degrees: on its friction alone it stands up to 4
_SWAYS: Final = 0.10, 0.20  # m/s and rad/s: a robot that stands sways by less
_RESTS_NS: Final = 500_000_000  # for which it stands before it balances by other gains
_SIDES: Final[dict[Side, BalanceSide]] = {
    "none": BalanceSide.NONE,
    "forward": BalanceSide.FORWARD,
    "backward": BalanceSide.BACKWARD,
}
_UNHEARD: Final = Trouble("the base board has not reported in this session")


class BalancerDrive(Dialogue[BalanceFrame]):
    """The `giraff_base.drive.Drive` of a robot that balances on two wheels."""

    topics = (WHEELS, ATTITUDE)
    can_power_off = True

    def __init__(self, robot: RobotConfig, config: BalancerConfig) -> None:
        super().__init__(BalanceFrame, BalanceLatch)
        config.require_countable(robot)
        self._robot, self._kinematics, self._max_turn = robot, robot.kinematics, robot.max_angular_speed
        self._settings = self._wanted = config.board_settings(robot)
        self._may_drive = config.drives(robot)
        self._rested_ns: int | None = None  # since when it stands; None: it does not
        self._wheel_radius = config.wheel_radius
        self._seq = 0
        self._drives = False  # the newest frame asks for motion
        self._stood = False  # it was not off, in whatever session
        self._untouched = False  # it went off and may still stand there on its friction: nobody has leaned it since

    @property
    def at_rest(self) -> bool:
        report = self._report
        if report is None:
            return True
        speed, turn = abs(report.speed_um_s) * 1e-6, abs(report.turn_urad_s) * 1e-6
        return not self._drives and speed <= _SWAYS[0] and turn <= _SWAYS[1]

    @property
    def voltage(self) -> float | None:
        return None if self._report is None else self._report.battery_mv / 1000

    @property
    def arming_block(self) -> Trouble:
        report = self._report
        if report is None or report.session not in self._ours:
            return _UNHEARD
        if report.posture == BalancePosture.STANDS:
            return NO_TROUBLE
        if report.posture == BalancePosture.SITS_DOWN:
            return cause(report).of("the robot sits down")
        if self._untouched:
            return untouched(report)
        return NO_TROUBLE if report.flags & BalanceFlag.UPRIGHT else lies(report)

    @property
    def not_ready(self) -> Trouble:
        return (
            self.arming_block
            or (NO_TROUBLE if self._newest.posture == BalancePosture.STANDS else GETS_UP)
            or super().not_ready
        )

    def reconfigure(self, config: msgspec.Struct) -> None:
        assert isinstance(config, BalancerConfig), "a kind of drive does not change while base runs"  # noqa: S101
        self._wanted, self._may_drive = config.board_settings(self._robot), config.drives(self._robot)

    def lose(self) -> None:
        self._drives = False
        super().lose()

    def settle(self, now: RobotTime, *, engaged: bool) -> Answer | None:
        """Tell the board other gains once the robot has stopped by those that it has."""
        if not self.at_rest:
            self._rested_ns = None
        elif self._rested_ns is None:
            self._rested_ns = now.robot_ns
        elif self._wanted != self._settings and now.robot_ns - self._rested_ns >= _RESTS_NS:
            self._settings = self._wanted
            self._renew()
        return super().settle(now, engaged=engaged)

    def ask(self, linear: float, angular: float, *, armed: bool, free_side: Side) -> Answer:
        report = self._newest
        linear, angular = self._kinematics.within_limits(linear, angular)
        slower = min(1.0, self._max_turn / abs(angular)) if angular else 1.0
        linear, angular = linear * slower, angular * slower
        reason = NEW_GAINS if self._wanted != self._settings else None if self._may_drive else ONLY_STANDS
        if reason is not None or max(map(abs, self._kinematics.wheel_speeds(linear, angular))) < _LEAST_SPEED:
            linear = angular = 0.0
        self._drives = linear != 0.0 or angular != 0.0
        frame = BalanceDriveFrame(
            seq=self._next_seq(),
            boot_id=report.boot_id,
            board_ms=report.board_ms,
            linear_um_s=round(linear * 1e6),
            angular_urad_s=round(angular * 1e6),
            # A board that is off stands up only for a host that has asked to keep it off in this state.
            ask=BalanceAsk.STAND if armed else BalanceAsk.KEEP,
            free_side=_SIDES[free_side],
        )
        if self._drives and report.flags & BalanceFlag.AT_LIMIT:
            reason = AT_LIMIT
        return Answer(frame, reason, self._drives)

    def _is_held(self, report: BalanceFrame) -> bool:
        return report.latch == BalanceLatch.OFF or (report.latch == BalanceLatch.STANDS and not self._off)

    def _halts(self, report: BalanceFrame) -> list[Trouble]:
        found, last = list[Trouble](), self._report
        is_off = report.posture == BalancePosture.OFF
        is_leaned = abs(report.lean_urad) * 1e-6 > _TAKEN
        self._untouched = is_off and not is_leaned and (self._stood or self._untouched)
        self._stood = not is_off
        if last is not None and last.posture == BalancePosture.STANDS != report.posture:
            found.append(left_standing(report))
        if report.flags & BalanceFlag.HELD or report.drive_state == DriveState.HELD:
            found.append(HELD)
        return found

    def _engages(self, report: BalanceFrame) -> EStopEngage | None:
        return stopped_by(report) or super()._engages(report)

    def _latched(self, report: BalanceFrame) -> EStopEngage:
        return latched_by(report.latch)

    def _samples(self, report: BalanceFrame, now: RobotTime) -> tuple[Sample, ...]:
        return wheels(report, self._kinematics, now), attitude(report, self._wheel_radius, now)

    def _configure(self, report: BalanceFrame) -> Frame:
        return msgspec.structs.replace(
            self._settings,
            seq=self._next_seq(),
            boot_id=report.boot_id,
            board_ms=report.board_ms,
            session=self._session,
        )

    def _estop(self, report: BalanceFrame, *, engage: bool) -> Frame:
        engaging = BalanceEngage.OFF if self._off else BalanceEngage.STANDS
        return BalanceEstopFrame(
            seq=self._next_seq(),
            boot_id=report.boot_id,
            board_ms=report.board_ms,
            session=self._session,
            engage=engaging if engage else BalanceEngage.RELEASE,
        )

    def _next_seq(self) -> int:
        self._seq = (self._seq + 1) & 0xFFFF
        return self._seq

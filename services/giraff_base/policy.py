"""Base's whole policy: what goes to the board, and why. No I/O and no clock: time is an argument."""

from __future__ import annotations

from collections.abc import Iterable

from giraff_base.authority import Authority
from giraff_base.board import board_state, engaged_by, held, limit, word
from giraff_base.config import BaseConfig
from giraff_base.drive import Ramp, WheelDemand
from giraff_base.estop import EStopControl, EStopLatch
from giraff_base.wheels import WheelReports
from giraff_core.base_commands import BaseCommands
from giraff_core.robot import RobotConfig
from giraff_schemas.messages import BaseState, Battery, EStop, GuardedCommand, RobotTime, Wheels
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.wire import DriveState, Frame, Latch, Refusal, WheelsFrame

_CONFIGURE_PERIOD_NS = 50_000_000
_NO_REPORT = "no report from the base board yet"
_ZERO = (0, 0)


class BasePolicy:
    """The second of the four safety layers.

    Feed it what arrives (`on_…`) and send what `next_frame` answers: the board's reports are the clock of the loop,
    because a frame is only as good as the board time it echoes. Between two of them a new command has one frame more.
    """

    def __init__(self, config: BaseConfig, robot: RobotConfig, latch: EStopLatch) -> None:
        self._config = config
        self._robot = robot
        self._estop = EStopControl(latch, config.reset_budget)
        self._authority = Authority(config, robot, self._estop)
        self._ramp = Ramp(config.linear_acceleration, config.angular_acceleration)
        self._reports = WheelReports()
        self._report: WheelsFrame | None = None
        self._reported_ns = 0
        self._answered = False
        self._may_hurry = False  # a command may have a frame before the next report
        self._releasing = False  # a reset has not reached the board yet
        self._link_fault = ""
        self._session = 0
        self._frames = BaseCommands()
        self._wheels = WheelDemand(robot, self._frames)
        self._demand = _ZERO  # of the newest frame
        # The faster wheel's, where driving and turning start at once. The ramp here may be made gentler live.
        _, acceleration = robot.kinematics.wheel_speeds(config.linear_acceleration, config.angular_acceleration)
        self._board_settings = robot.board_settings(acceleration)
        self._next_configure_ns = 0
        self._reason = _NO_REPORT

    def reconfigure(self, config: BaseConfig) -> None:
        """Use a new configuration."""
        self._config = config
        self._authority.reconfigure(config)
        self._ramp.limit(config.linear_acceleration, config.angular_acceleration)

    @property
    def latch(self) -> EStopLatch:
        """The emergency stop in force; what belongs on disk."""
        return self._estop.latch

    @property
    def faults(self) -> dict[str, str]:
        """What is wrong, with the way out; empty where nothing is."""
        return self._authority.faults

    def on_link_opened(self, session: int) -> None:
        """The port was opened, perhaps again. `session`: random, not 0; tells this opening from any other."""
        self._session = session
        self._link_fault = ""
        self._reports.forget()
        self._lose_board("the serial link was opened anew")

    def on_link_lost(self, fault: str) -> None:
        """There is no board now. `fault`: why, with the way out."""
        self._link_fault = fault
        self._lose_board("the serial link was lost")

    def on_frames(self, frames: Iterable[Frame], now: RobotTime) -> list[Wheels]:
        """Take what the board sent; the samples to publish, once it works with this session's wiring."""
        samples = []
        for report in frames:
            if not isinstance(report, WheelsFrame):
                continue
            self._compare(report, now)
            self._link_fault = ""
            self._report, self._reported_ns = report, now.robot_ns
            self._answered = False
            self._may_hurry = True
            self._adopt_latch(report, now)
            if (battery := self.battery()) is not None:
                self._authority.battery.take(battery.voltage, now.robot_ns)
            if report.session == self._session:
                samples.append(self._reports.take(report, now))
        return samples

    def on_command(self, command: GuardedCommand, now: RobotTime) -> None:
        """Take a command of a guard. One that counts goes down at once, and the next ones with the board's report."""
        if self._authority.on_command(command, now, self._reports.at_rest) and self._may_hurry:
            self._may_hurry = False
            self._answered = False

    def on_engage(self, asked: EStopEngage, now: RobotTime) -> EStopAnswer:
        """Stop, from the next frame on. Whether it is on disk is not answered here."""
        self._engage(asked, now)
        return self._estop.answer()

    def reset_refusal(self, reset: EStopReset, now: RobotTime) -> str:
        """Why `on_reset` would clear nothing; empty when it would, or when nothing is left to clear."""
        return self._estop.refusal(reset, now)

    def released(self, reset: EStopReset) -> EStopLatch:
        """The latch that `on_reset` would leave: it belongs on disk first."""
        return self._estop.released(reset)

    def on_reset(self, reset: EStopReset, now: RobotTime) -> EStopAnswer:
        """Permit motion again, of a robot that must be armed for it."""
        refusal = self._estop.refusal(reset, now)
        if not refusal and self._estop.latch.engaged:
            self._estop.latch = self._estop.released(reset)
            self._releasing = True
        return self._estop.answer(refusal)

    def next_frame(self, now: RobotTime) -> Frame | None:
        """The answer to the board's newest report; None when there is none, or no news since it was answered."""
        report = self._report
        if report is None or self._answered:
            return None
        self._answered = True
        if self._estop.latch.engaged and report.latch == Latch.NONE:
            return self._frames.estop(report, self._session, engage=True)
        if report.session != self._session:
            self._stand_still("the base board is being configured")
            if report.last_refusal == Refusal.PROTOCOL:
                self._reason = "the base board refuses the configuration; check [robot], or reflash the board"
            if now.robot_ns < self._next_configure_ns:
                return None
            self._next_configure_ns = now.robot_ns + _CONFIGURE_PERIOD_NS
            return self._frames.configure(report, self._session, self._board_settings)
        if self._releasing:
            self._stand_still("the base board is being released")
            return self._frames.estop(report, self._session, engage=False)
        return self._drive_frame(report, now)

    @property
    def reason(self) -> str:
        """Why the robot does not do what is commanded; empty when it does."""
        return self._estop.stops or self._link_fault or self._reason

    def state(self) -> BaseState:
        """Of the newest drive or speed frame."""
        report, authority = self._report, self._authority
        return BaseState(
            armed=authority.arming.armed,
            driving=self._demand != _ZERO,
            reason=self.reason,
            guard=authority.binding.guard,
            round_trip=authority.round_trip if report else None,
            budget_left=authority.budget_left if report else None,
            board=board_state(report),
        )

    def estop(self) -> EStop:
        """The emergency stop as it is now."""
        return self._estop.sample()

    def battery(self) -> Battery | None:
        """The battery, where its divider is known."""
        if self._report is None or self._robot.battery_volts_per_count == 0.0:
            return None
        return Battery(voltage=self._report.battery_adc_counts * self._robot.battery_volts_per_count)

    def _engage(self, asked: EStopEngage, now: RobotTime) -> None:
        self._estop.engage(asked, now)
        self._authority.arming.disarm("the emergency stop")
        self._releasing = False
        self._stand_still("")
        self._answered = False  # the board hears of it at once, whatever it was told last

    def _lose_board(self, why: str) -> None:
        self._report = None
        self._releasing = False
        self._stand_still(_NO_REPORT)
        self._authority.battery.pause()
        self._authority.arming.disarm(why)

    def _compare(self, report: WheelsFrame, now: RobotTime) -> None:
        """Disarm if something held a wheel, or this is not the board of the last report, at work ever since."""
        last, arming = self._report, self._authority.arming
        if by := held(report):
            arming.disarm(by)
        if last is None:
            return
        if report.boot_id != last.boot_id:
            self._releasing = False
            arming.disarm("the base board was reset")
        elif last.session == self._session and report.session != self._session:
            arming.disarm("another program took over the base board")
        if (now.robot_ns - self._reported_ns) * 1e-9 > self._config.disarm_time:
            arming.disarm("the base board was silent for too long")

    def _adopt_latch(self, report: WheelsFrame, now: RobotTime) -> None:
        """Make a latch of the board that base did not order base's own."""
        if report.latch == Latch.NONE:
            self._releasing = False
        elif not self._estop.latch.engaged and not self._releasing:
            self._engage(engaged_by(report.latch), now)

    def _drive_frame(self, report: WheelsFrame, now: RobotTime) -> Frame:
        linear, angular, self._reason = self._authority.wanted(now)
        # Within the wheels first: a ramp up to what is scaled down later would leap where the other part ends.
        self._ramp.follow(*self._robot.kinematics.within_limits(linear, angular), now.robot_ns)
        if report.drive_state != DriveState.ACTIVE:
            # The board's latch opens for a zero frame only; the ramp starts over once it has.
            self._stand_still(self._reason or f"the base board is in state {word(DriveState, report.drive_state)}")
        self._demand = self._wheels.of(self._ramp.linear, self._ramp.angular)
        if self._demand != _ZERO:
            self._reason = self._reason or limit(report)
        return self._wheels.frame(report, self._demand)

    def _stand_still(self, reason: str) -> None:
        self._reason = reason
        self._ramp.stop()
        self._demand = _ZERO

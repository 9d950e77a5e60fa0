"""Base's whole policy: which command reaches the board, and why not. No I/O and no clock: time is an argument."""

from __future__ import annotations

from collections.abc import Iterable

from giraff_base.arming import HOW_TO_ARM, Arming
from giraff_base.config import BaseConfig
from giraff_base.drive import ramped, wheel_levels
from giraff_base.wheels import WheelReports
from giraff_node.freshness import age, fade
from giraff_node.robot import RobotConfig
from giraff_schemas.messages import BaseState, Battery, BoardState, GuardedCommand, RobotTime, Wheels
from giraff_schemas.wire import (
    PROTOCOL_HASH,
    ConfigureFrame,
    DriveFrame,
    DriveState,
    Frame,
    Refusal,
    WheelsFrame,
)

_LONGEST_STEP = 0.05  # s; a ramp does not jump after a pause
_CONFIGURE_PERIOD_NS = 50_000_000


class BasePolicy:
    """The second of the four safety layers.

    Feed it what arrives (`on_link_opened`, `on_link_lost`, `on_frames`, `on_command`) and send what `next_frame`
    answers: the board's own reports are the clock of the loop, because a frame is only as good as the board time
    it echoes.
    """

    def __init__(self, config: BaseConfig, robot: RobotConfig) -> None:
        self._config = config
        self._robot = robot
        self._arming = Arming(config)
        self._reports = WheelReports(robot)
        self._report: WheelsFrame | None = None
        self._answered = False
        self._command: GuardedCommand | None = None
        self._refused = "the guard has not been heard yet"
        self._link_fault = ""
        self._session = 0
        self._seq = 0
        self._next_configure_ns = 0
        self._linear = self._angular = 0.0  # what the newest drive frame asked for
        self._ramped_ns = 0
        self._round_trip: float | None = None
        self._budget_left: float | None = None
        self._reason = "no report from the base board yet"

    @property
    def intruder(self) -> str:
        """A fault: a second guard is running; empty when none is."""
        other = self._arming.intruder
        return f"a second guard, {other}, is running; end one of the two" if other else ""

    def on_link_opened(self, session: int) -> None:
        """The port was opened, perhaps again. `session`: random, not 0; tells this opening from any other."""
        self._session = session
        self._link_fault = ""
        self._report = None
        self._reason = "no report from the base board yet"
        self._reports.forget()
        self._linear = self._angular = 0.0
        self._arming.disarm("the serial link was opened anew")

    def on_link_lost(self, fault: str) -> None:
        """There is no board now. `fault`: why, with the way out."""
        self._report = None
        self._link_fault = fault
        self._linear = self._angular = 0.0
        self._arming.disarm("the serial link was lost")

    def on_frames(self, frames: Iterable[Frame], now: RobotTime) -> list[Wheels]:
        """Take what the board sent; the samples to publish, once it works with this session's wiring."""
        samples = []
        for frame in frames:
            if not isinstance(frame, WheelsFrame):
                continue
            if self._report is not None and frame.boot_id != self._report.boot_id:
                self._arming.disarm("the base board was reset")
            self._link_fault = ""
            self._report = frame
            self._answered = False
            if frame.session == self._session:
                samples.append(self._reports.take(frame, now))
        return samples

    def on_command(self, command: GuardedCommand, now: RobotTime) -> None:
        """Take a command of a guard."""
        if self._command is not None:
            self._disarm_if_stale(self._command, now)  # before a fresh one can hide it
        # A refused one does not end the command in charge: a late copy must not be able to stop the robot.
        self._refused = self._arming.admit(command, now, self._reports.at_rest)
        if not self._refused:
            self._command = command
            self._arming.consider(command, now)

    def next_frame(self, now: RobotTime) -> Frame | None:
        """The answer to the board's newest report; None when it has been answered, or there is none."""
        report = self._report
        if report is None or self._answered:
            return None
        self._answered = True
        if report.session != self._session:
            self._linear = self._angular = 0.0
            self._reason = "the base board is being configured"
            if report.last_refusal == Refusal.PROTOCOL:
                self._reason = "the base board refuses the configuration; check [robot], or reflash the board"
            if now.robot_ns < self._next_configure_ns:
                return None
            self._next_configure_ns = now.robot_ns + _CONFIGURE_PERIOD_NS
            return self._configure(report)
        self._advance(now)
        if report.drive_state != DriveState.ACTIVE:
            # The board's latch opens for a zero frame only; the ramp starts over once it has.
            self._linear = self._angular = 0.0
            self._reason = self._reason or f"the base board is in state {DriveState(report.drive_state).name.lower()}"
        left, right = wheel_levels(self._linear, self._angular, self._robot)
        return DriveFrame(
            seq=self._next_seq(),
            boot_id=report.boot_id,
            board_ms=report.board_ms,
            left_level=left,
            right_level=right,
        )

    def state(self) -> BaseState:
        """Of the newest drive frame."""
        report = self._report
        return BaseState(
            armed=self._arming.armed,
            driving=self._linear != 0.0 or self._angular != 0.0,
            reason=self._link_fault or self._reason,
            guard=self._arming.guard,
            round_trip=self._round_trip if report else None,
            budget_left=self._budget_left if report else None,
            board=BoardState(
                connected=report is not None,
                boot_id=report.boot_id if report else 0,
                drive_state=DriveState(report.drive_state).name.lower() if report else "",
                last_refusal=Refusal(report.last_refusal).name.lower() if report else "",
                accepted=report.accepted if report else 0,
                refused=report.refused if report else 0,
                line_errors=report.line_errors if report else 0,
            ),
        )

    def battery(self) -> Battery | None:
        """The battery, where its divider is known."""
        if self._report is None or self._robot.battery_volts_per_count == 0.0:
            return None
        return Battery(voltage=self._report.battery_adc_counts * self._robot.battery_volts_per_count)

    def _advance(self, now: RobotTime) -> None:
        """Let `_linear` and `_angular` follow the command in charge, as far as it is fresh and the robot is armed."""
        linear, angular, self._reason = self._wanted(now)
        seconds = min(_LONGEST_STEP, (now.robot_ns - self._ramped_ns) * 1e-9)
        self._ramped_ns = now.robot_ns
        self._linear = ramped(self._linear, linear, self._config.linear_acceleration * seconds)
        self._angular = ramped(self._angular, angular, self._config.angular_acceleration * seconds)

    def _wanted(self, now: RobotTime) -> tuple[float, float, str]:
        """The twist that may be driven now, and why it is less than the command."""
        command, config = self._command, self._config
        if command is None:
            return 0.0, 0.0, self._refused
        operator_age, guard_age, range_age = _ages(command, now)
        self._round_trip = operator_age if operator_age < config.disarm_time else None
        left = min(
            config.operator_budget - operator_age,
            config.guard_budget - guard_age,
            config.range_budget - range_age,
        )
        self._budget_left = max(left, -config.disarm_time)
        self._disarm_if_stale(command, now)
        if guard_age > config.guard_budget:
            return 0.0, 0.0, self._refused or "the guard is not heard; start giraff_guard on this machine"
        if operator_age > config.operator_budget:
            return 0.0, 0.0, command.reason or "no fresh command of an operator"
        if range_age > config.range_budget:
            return 0.0, 0.0, command.reason or "a range that this motion relies on is too old"
        if command.source == "fault":
            return 0.0, 0.0, command.reason or "the operator's side reports a fault"
        if not self._arming.armed:
            return 0.0, 0.0, f"not armed since {self._arming.why}; {HOW_TO_ARM} for {config.arm_time:g} s"
        by_operator, by_guard = fade(operator_age, config.operator_budget), fade(guard_age, config.guard_budget)
        share, late = by_operator, "slowed: the operator's commands come late; check its link"
        if by_guard < by_operator:
            share, late = by_guard, "slowed: the guard's commands come late; relieve this machine"
        reason = command.reason or ("" if share == 1.0 or command.neutral else late)
        return command.linear_x * share, command.angular_z * share, reason

    def _disarm_if_stale(self, command: GuardedCommand, now: RobotTime) -> None:
        """Disarm when a part of the command in charge has been stale for too long."""
        if max(_ages(command, now)) > self._config.disarm_time:
            self._arming.disarm("a command or a range was stale for too long")

    def _configure(self, report: WheelsFrame) -> ConfigureFrame:
        return ConfigureFrame(
            seq=self._next_seq(),
            protocol_hash=PROTOCOL_HASH,
            boot_id=report.boot_id,
            board_ms=report.board_ms,
            session=self._session,
            wiring=self._robot.wiring,
            level_max=self._robot.max_level,
        )

    def _next_seq(self) -> int:
        self._seq = (self._seq + 1) & 0xFFFF
        return self._seq


def _ages(command: GuardedCommand, now: RobotTime) -> tuple[float, float, float]:
    """s, of the operator's, the guard's and the range's tick; a command that relies on no range has a new one."""
    range_age = age(command.range_tick, now) if command.range_tick is not None else 0.0
    return age(command.operator_tick, now), age(command.guard_tick, now), range_age

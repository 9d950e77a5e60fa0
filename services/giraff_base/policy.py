"""Base's whole policy: what goes to the board, and why. No I/O and no clock: time is an argument."""

import math
from collections.abc import Iterable
from typing import Any, Final

import msgspec

from giraff_base.config import BaseConfig
from giraff_base.drive import Report
from giraff_base.estop import EStopControl, EStopLatch
from giraff_base.permission import Permission
from giraff_base.registry import drive_of
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_schemas.camera import VisualOdometry
from giraff_schemas.messages import BaseState, Battery, EStop, GuardedCommand, RobotTime, Sample
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import Topic
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import COMMAND_TIMEOUT_MS, ECHO_MAX_AGE_MS, Frame

_LONGEST_STEP = 0.02  # s, two reports of the board: a ramp does not jump after a pause


def ramped(now_at: float, target: float, largest_step: float) -> float:
    """The next value from `now_at` to `target`: away from zero by at most `largest_step`, towards it at once.

    A reversal passes through zero: what is asked in the old direction ends now, the new one starts from rest.
    """
    if math.copysign(1.0, now_at) != math.copysign(1.0, target):
        now_at = 0.0
    return math.copysign(min(abs(target), abs(now_at) + largest_step), target)


class Ramp:
    """The twist that is asked of the motors now, on its way to the one that may be driven."""

    def __init__(self, live: Live[BaseConfig]) -> None:
        self._live = live
        self.linear = self.angular = 0.0
        self._at_ns = 0

    def stop(self) -> None:
        self.linear = self.angular = 0.0

    def follow(self, linear: float, angular: float, robot_ns: int) -> None:
        """Go on to what may be driven at `robot_ns`."""
        config = self._live.config
        seconds = min(_LONGEST_STEP, max(0.0, (robot_ns - self._at_ns) * 1e-9))
        self._at_ns = robot_ns
        self.linear = ramped(self.linear, linear, config.linear_acceleration * seconds)
        self.angular = ramped(self.angular, angular, config.angular_acceleration * seconds)


_NO_REPORT: Final = Trouble("no report from the base board yet")
_UNMEASURED: Final = Trouble("the battery was empty and is not measured now", "connect the base board, then reset it")


class BasePolicy:
    """The second of the four safety layers.

    Feed it what arrives (`on_…`) and send what `next_frame` answers: the board's reports are the clock of the loop,
    because a frame is only as good as the board time it echoes. Between two of them a new command has one frame more.
    """

    def __init__(
        self, live: Live[BaseConfig], robot: RobotConfig, latch: EStopLatch, lost_parameters: Trouble = NO_TROUBLE
    ) -> None:
        """`lost_parameters`: a saved limit that may be lost; nothing moves then."""
        self._live = live
        self._kinematics = robot.kinematics
        self._drive = drive_of(robot, live.config)
        self._estop = EStopControl(latch, live.config.reset_budget, can_power_off=self._drive.can_power_off)
        if self._estop.latch.engaged:
            self._drive.hold(off=self._estop.latch.off)
        was_empty = self._estop.latch.engaged and self._estop.latch.empty
        self._permission = Permission(
            live, self._estop, self._drive, battery_was_empty=was_empty, lost_parameters=lost_parameters
        )
        self._ramp = Ramp(live)
        self._reported_ns: int | None = None  # None: there is no board
        self._answered = False
        self._may_answer_now = False  # a command may have a frame before the next report
        self._link_fault = NO_TROUBLE
        self._driving = False  # the newest frame asks for motion
        self._reason = _NO_REPORT

    @property
    def topics(self) -> tuple[Topic[Any], ...]:
        """The topics of the drive's samples."""
        return self._drive.topics

    @property
    def latch(self) -> EStopLatch:
        """The emergency stop in force; what belongs on disk."""
        return self._estop.latch

    def unheard_stops_s(self, now_ns: int) -> float:
        """Return within which time the wheels stop without base. 0: base hears its board. `now_ns`: robot time.

        A board stops when it hears no base, and one that is a process also when its controller hears no byte.
        """
        if self._reported_ns is not None and now_ns - self._reported_ns <= ECHO_MAX_AGE_MS * 1_000_000:
            return 0.0
        return max(COMMAND_TIMEOUT_MS / 1000, self._live.config.drive.board_type.stops_after_s)

    @property
    def faults(self) -> dict[str, Trouble]:
        """What is wrong, by what has it."""
        return {**self._permission.faults, "rolling": self._drive.warning}

    def on_reconfigured(self, config: BaseConfig) -> None:
        """Put another configuration in force, between two turns."""
        self._live.replace(config)
        self._drive.reconfigure(config.drive)

    def on_link_opened(self, session: int) -> None:
        """The port was opened, perhaps again. `session`: random, not 0; tells this opening from any other."""
        self._link_fault = NO_TROUBLE
        self._drive.open(session)
        self._lose_board("the serial link was opened anew")

    def on_link_lost(self, fault: Trouble) -> None:
        """There is no board now, and why."""
        self._link_fault = fault
        self._drive.lose()
        self._lose_board("the serial link was lost")

    def on_frames(self, frames: Iterable[Frame], now: RobotTime) -> list[Sample]:
        """Take what the board sent; the samples to publish, once it works with this session's wiring."""
        samples: list[Sample] = []
        for frame in frames:
            if (report := self._drive.on_frame(frame, now)) is not None:
                self._on_report(report, now)
                samples += report.samples
        return samples

    def on_camera(self, told: VisualOdometry, now: RobotTime) -> None:
        """Take what a camera sees of the motion: at most the robot creeps for it."""
        self._drive.on_camera(told, now)

    def on_command(self, command: GuardedCommand, now: RobotTime) -> None:
        """Take a command of a guard. One that counts goes down at once, and the next ones with the board's report."""
        if self._permission.on_command(command, now, self._drive.at_rest) and self._may_answer_now:
            self._may_answer_now = False
            self._answered = False

    def on_engage(self, asked: EStopEngage, now: RobotTime) -> EStopAnswer:
        """Stop, from the next frame on. Whether it is on disk is not answered here."""
        self._engage(asked, now)
        return self._estop.answer()

    def reset_refusal(self, reset: EStopReset, now: RobotTime) -> Trouble:
        """Why `on_reset` would clear nothing. NO_TROUBLE: it would, or nothing is left to clear."""
        return self._estop.refusal(reset, now) or self._uncharged

    def released(self, reset: EStopReset) -> EStopLatch:
        """The latch that `on_reset` would leave: it belongs on disk first."""
        return self._estop.released(reset)

    def on_reset(self, reset: EStopReset, now: RobotTime) -> EStopAnswer:
        """Permit motion again, of a robot that must be armed for it."""
        refusal = self.reset_refusal(reset, now)
        if not refusal and self._estop.latch.engaged:
            self._estop.latch = self._estop.released(reset)
            self._drive.release()
        return self._estop.answer(refusal)

    def next_frame(self, now: RobotTime) -> Frame | None:
        """The answer to the board's newest report; None when there is none, or no news since it was answered."""
        if self._reported_ns is None or self._answered:
            return None
        self._answered = True
        if (unsettled := self._drive.settle(now, engaged=self._estop.latch.engaged)) is not None:
            if unsettled.reason is not None:
                self._stand_still(unsettled.reason)
            return unsettled.frame
        return self._drive_frame(now)

    @property
    def reason(self) -> Trouble:
        """Why the robot does not do what is commanded."""
        return self._estop.stops or self._link_fault or self._reason

    def state(self) -> BaseState:
        """Return base's state as of its newest frame."""
        permission, is_there, reason = self._permission, self._reported_ns is not None, self.reason
        return BaseState(
            armed=permission.arming.armed,
            driving=self._driving,
            reason=reason,
            guard=permission.binding.guard,
            round_trip=permission.round_trip if is_there else None,
            budget_left=permission.budget_left if is_there else None,
            board=msgspec.structs.replace(self._drive.state(), report_ms=self._live.config.drive.board_type.report_ms),
        )

    def estop(self) -> EStop:
        """The emergency stop as it is now."""
        return self._estop.sample()

    def battery(self) -> Battery | None:
        """The battery, where its divider is known."""
        voltage = self._drive.voltage
        return None if voltage is None else Battery(voltage=voltage, since_charge=self._permission.battery.since_charge)

    @property
    def _uncharged(self) -> Trouble:
        """Reason to refuse the reset of a stop under which the battery was empty. NO_TROUBLE: there is none."""
        if not self._estop.latch.empty:
            return NO_TROUBLE
        return self._permission.battery.stops or (_UNMEASURED if self._reported_ns is None else NO_TROUBLE)

    def _engage(self, asked: EStopEngage, now: RobotTime) -> None:
        self._estop.engage(asked, now, empty=bool(self._permission.battery.stops))
        self._permission.arming.disarm("the emergency stop")
        self._drive.hold(off=self._estop.latch.off)
        self._stand_still(NO_TROUBLE)
        self._answered = False  # the board hears of it at once, whatever it was told last

    def _lose_board(self, why: str) -> None:
        self._reported_ns = None
        self._stand_still(_NO_REPORT)
        self._permission.arming.disarm(why)

    def _on_report(self, report: Report, now: RobotTime) -> None:
        """Take news of the board: what disarms comes before what the board has latched."""
        arming, last_ns = self._permission.arming, self._reported_ns
        for why in report.disarms:
            arming.disarm(why.what, why.remedy)
        if last_ns is not None and (now.robot_ns - last_ns) * 1e-9 > self._live.config.disarm_time:
            arming.disarm("the base board was silent for too long")
        self._link_fault = NO_TROUBLE
        self._reported_ns = now.robot_ns
        self._answered = False
        self._may_answer_now = True
        if (latched := report.latched) is not None and self._estop.is_news(latched):
            self._engage(latched, now)
        if (voltage := self._drive.voltage) is not None:
            watch = self._permission.battery
            watch.on_voltage(voltage, now.robot_ns, rests=self._drive.at_rest and not self._driving)
            if watch.stops and not self._estop.latch.empty:
                self._engage(watch.emergency_stop, now)

    def _drive_frame(self, now: RobotTime) -> Frame | None:
        linear, angular, self._reason = self._permission.wanted(now)
        # Within the wheels first: a ramp up to what is scaled down later would leap where the other part ends.
        allowed = self._kinematics.within_limits(linear, angular)
        limit = self._drive.limit
        if limit.speed < self._kinematics.max_wheel_speed:
            slowed = self._kinematics._replace(max_wheel_speed=limit.speed).within_limits(*allowed)
            if slowed != allowed:
                allowed, self._reason = slowed, limit.reason.of("slowed")
        self._ramp.follow(*allowed, now.robot_ns)
        if not_ready := self._drive.not_ready:
            # The board's latch opens for a zero frame only; the ramp starts over once it has.
            self._stand_still(self._reason or not_ready)
        armed, free_side = self._permission.arming.armed, self._permission.free_side(now)
        asked = self._drive.ask(self._ramp.linear, self._ramp.angular, armed=armed, free_side=free_side)
        self._driving = asked.moves
        self._reason = self._reason or asked.reason or NO_TROUBLE
        return asked.frame

    def _stand_still(self, reason: Trouble) -> None:
        self._reason = reason
        self._ramp.stop()
        self._driving = False

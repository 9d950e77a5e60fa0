"""The dialogue with `firmware/base`: a session, the board's latch, and frames of levels or speeds."""

from __future__ import annotations

from typing import Final

from giraff_base.drive import Answer, Report
from giraff_base.drives.wheels.commands import WheelsCommands
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_base.drives.wheels.demand import WheelDemand
from giraff_base.drives.wheels.reports import WheelReports
from giraff_base.drives.wheels.words import board_state, engaged_by, held, limit, word
from giraff_core.robot import RobotConfig
from giraff_schemas.messages import BoardState, RobotTime
from giraff_schemas.topics import WHEELS
from giraff_schemas.trouble import WELL, Trouble
from giraff_schemas.wire import DriveState, Frame, Latch, Refusal, WheelsFrame

_CONFIGURE_PERIOD_NS = 50_000_000
_ZERO = (0, 0)
_BEING_RELEASED: Final = Trouble("the base board is being released")
_BEING_CONFIGURED: Final = Trouble("the base board is being configured")
_REFUSES: Final = Trouble("the base board refuses the configuration", "check [base.drive], or reflash the board")


class WheelsDrive:
    """The `giraff_base.drive.Drive` of two wheels."""

    topics = (WHEELS,)
    knows_off = False

    def __init__(self, robot: RobotConfig, config: WheelsConfig, acceleration: float) -> None:
        """`acceleration`: m/s² of the faster wheel, where driving and turning start at once."""
        self._config = config
        self._frames = WheelsCommands()
        self._demand = WheelDemand(robot, config, self._frames)
        config.require_countable(robot)
        self._settings = config.board_settings(robot, acceleration)
        self._board = config.board_type
        self._reports = WheelReports()
        self._report: WheelsFrame | None = None
        self._session = 0
        self._next_configure_ns = 0
        self._releasing = False  # a reset has not reached the board yet

    @property
    def at_rest(self) -> bool:
        return self._reports.at_rest

    @property
    def voltage(self) -> float | None:
        if self._report is None or self._config.battery_volts_per_count == 0.0:
            return None
        return self._report.battery_adc_counts * self._config.battery_volts_per_count

    @property
    def waits(self) -> Trouble:
        state = self._newest.drive_state
        return WELL if state == DriveState.ACTIVE else Trouble(f"the base board is in state {word(DriveState, state)}")

    def state(self) -> BoardState:
        return board_state(self._report)

    def open(self, session: int) -> None:
        self._session = session
        self._reports.forget()
        self.lose()

    def lose(self) -> None:
        self._report = None
        self._releasing = False

    def take(self, frame: Frame, now: RobotTime) -> Report | None:
        if not isinstance(frame, WheelsFrame):
            return None
        disarms = self._disarms(frame)
        self._report = frame
        if frame.latch == Latch.NONE:
            self._releasing = False
        return Report(
            disarms=disarms,
            latched=engaged_by(frame.latch) if frame.latch != Latch.NONE and not self._releasing else None,
            samples=(self._reports.take(frame, now),) if frame.session == self._session else (),
        )

    def release(self) -> None:
        self._releasing = True

    def hold(self, *, off: bool) -> None:  # noqa: ARG002  a stopped motor has no power: off is no other state
        self._releasing = False

    def settle(self, now: RobotTime, *, engaged: bool) -> Answer | None:
        report = self._newest
        if engaged and report.latch == Latch.NONE:
            return Answer(self._frames.estop(report, self._session, engage=True))
        if report.session != self._session:
            return self._configure(report, now)
        if self._releasing:
            return Answer(self._frames.estop(report, self._session, engage=False), _BEING_RELEASED)
        return None

    def ask(self, linear: float, angular: float) -> Answer:
        report, demand = self._newest, self._demand.of(linear, angular)
        moves = demand != _ZERO
        return Answer(self._demand.frame(report, demand), limit(report, self._board) if moves else None, moves)

    @property
    def _newest(self) -> WheelsFrame:
        assert self._report is not None, "base asks only where there is a report"  # noqa: S101
        return self._report

    def _disarms(self, report: WheelsFrame) -> tuple[str, ...]:
        last, found = self._report, []
        if by := held(report):
            found.append(by)
        if last is not None and report.boot_id != last.boot_id:
            self._releasing = False
            found.append("the base board was reset")
        elif last is not None and last.session == self._session and report.session != self._session:
            found.append("another program took over the base board")
        return tuple(found)

    def _configure(self, report: WheelsFrame, now: RobotTime) -> Answer:
        reason = _REFUSES if report.last_refusal == Refusal.PROTOCOL else _BEING_CONFIGURED
        if now.robot_ns < self._next_configure_ns:
            return Answer(None, reason)
        self._next_configure_ns = now.robot_ns + _CONFIGURE_PERIOD_NS
        return Answer(self._frames.configure(report, self._session, self._settings), reason)

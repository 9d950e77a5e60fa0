"""The part of a drive that is alike for each firmware of base's board: the session, the latch and its release."""

from abc import ABC, abstractmethod
from enum import IntEnum
from functools import lru_cache
from typing import Final, Generic, Protocol, TypeVar

import msgspec

from giraff_base.drive import Answer, Report, SpeedLimit
from giraff_schemas.camera import VisualOdometry
from giraff_schemas.messages import BoardState, RobotTime, Sample
from giraff_schemas.requests import EStopEngage
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import DriveState, Frame, Refusal

_CONFIGURE_PERIOD_NS = 50_000_000
KEPT_STOP: Final = Trouble("the board kept an emergency stop from before", "see that the robot may move")
_UNLATCHED: Final = 0
_LAST_SESSION: Final = 0xFFFFFFFF
_BEING_RELEASED: Final = Trouble("the base board is being released")
_BEING_CONFIGURED: Final = Trouble("the base board is being configured")
_REFUSES: Final = Trouble("the base board refuses the configuration", "check [base.drive], or reflash the board")


class BoardReport(Protocol):
    """Fields that each base board's report has."""

    @property
    def boot_id(self) -> int: ...
    @property
    def session(self) -> int: ...
    @property
    def drive_state(self) -> int: ...
    @property
    def latch(self) -> int: ...
    @property
    def last_refusal(self) -> int: ...
    @property
    def accepted(self) -> int: ...
    @property
    def refused(self) -> int: ...
    @property
    def line_errors(self) -> int: ...


ReportT = TypeVar("ReportT", bound=BoardReport)


class Dialogue(ABC, Generic[ReportT]):
    """Implements most of `giraff_base.drive.Drive`. A kind of drive adds its frames and its words."""

    def __init__(self, kind: type[ReportT], latches: type[IntEnum]) -> None:
        """`kind`: the board's report; `latches`: the names of its latches."""
        self._kind, self._latches = kind, latches
        self._report: ReportT | None = None
        self._session = 0
        self._ours: set[int] = set()  # sessions since the port was opened: one for each configuration
        self._next_configure_ns = 0
        self._releasing = False  # a reset has not reached the board yet
        self._off = False  # base's emergency stop is off

    @property
    def arming_block(self) -> Trouble:
        return NO_TROUBLE

    @property
    def limit(self) -> SpeedLimit:
        return SpeedLimit()

    @property
    def not_ready(self) -> Trouble:
        state = self._newest.drive_state
        return (
            NO_TROUBLE
            if state == DriveState.ACTIVE
            else Trouble(f"the base board is in state {word(DriveState, state)}")
        )

    @property
    def warning(self) -> Trouble:
        return NO_TROUBLE

    def state(self) -> BoardState:
        return board_state(self._report, self._latches)

    def reconfigure(self, config: msgspec.Struct) -> None:
        pass

    def on_camera(self, told: VisualOdometry, now: RobotTime) -> None:
        pass

    def open(self, session: int) -> None:
        self._session = session
        self._ours = {session}
        self.lose()

    def lose(self) -> None:
        self._report = None
        self._releasing = False

    def on_frame(self, frame: object, now: RobotTime) -> Report | None:
        if not isinstance(frame, self._kind):
            return None
        disarms = self._disarms(frame)
        self._report = frame
        if frame.latch == _UNLATCHED:
            self._releasing = False
        return Report(
            disarms=disarms,
            latched=self._engages(frame),
            samples=self._samples(frame, now) if frame.session in self._ours else (),
        )

    def release(self) -> None:
        self._releasing, self._off = True, False

    def hold(self, *, off: bool) -> None:
        self._releasing, self._off = False, off

    def settle(self, now: RobotTime, *, engaged: bool) -> Answer | None:
        report = self._newest
        if engaged and not self._is_held(report):
            return Answer(self._estop(report, engage=True))
        if report.session != self._session:
            return self._configured(report, now)
        if self._releasing:
            return Answer(self._estop(report, engage=False), _BEING_RELEASED)
        return None

    @property
    def _newest(self) -> ReportT:
        assert self._report is not None, "base asks only where there is a report"  # noqa: S101
        return self._report

    def _disarms(self, report: ReportT) -> tuple[Trouble, ...]:
        last, found = self._report, [*self._halts(report)]
        if last is not None and report.boot_id != last.boot_id:
            self._releasing = False
            found.append(Trouble("the base board was reset"))
        elif last is not None and last.session in self._ours and report.session not in self._ours:
            found.append(Trouble("another program took over the base board"))
        return tuple(found)

    def _renew(self) -> None:
        """Begin another session: the board reports its number only once it has taken the new settings."""
        self._session = self._session % _LAST_SESSION + 1
        self._ours.add(self._session)

    def _configured(self, report: ReportT, now: RobotTime) -> Answer:
        reason = _REFUSES if report.last_refusal == Refusal.PROTOCOL else _BEING_CONFIGURED
        if now.robot_ns < self._next_configure_ns:
            return Answer(None, reason)
        self._next_configure_ns = now.robot_ns + _CONFIGURE_PERIOD_NS
        return Answer(self._configure(report), reason)

    def _engages(self, report: ReportT) -> EStopEngage | None:
        """Return the emergency stop that the board wants of base. None: none."""
        return self._latched(report) if report.latch != _UNLATCHED and not self._releasing else None

    def _is_held(self, report: ReportT) -> bool:
        """Return whether the board has latched what base's emergency stop asks for."""
        return report.latch != _UNLATCHED

    @abstractmethod
    def _halts(self, report: ReportT) -> list[Trouble]:
        """Say why the robot must be armed again, by its motion. `_report` is still the one before."""

    @abstractmethod
    def _latched(self, report: ReportT) -> EStopEngage:
        """Return the emergency stop that a latch of the board means."""

    @abstractmethod
    def _samples(self, report: ReportT, now: RobotTime) -> tuple[Sample, ...]: ...

    @abstractmethod
    def _configure(self, report: ReportT) -> Frame:
        """Return the frame that opens the session."""

    @abstractmethod
    def _estop(self, report: ReportT, *, engage: bool) -> Frame:
        """Return the frame that latches, or releases the latch."""


@lru_cache(maxsize=256)
def word(kind: type[IntEnum], value: int) -> str:
    """The name of what a board reported, whatever it was."""
    return kind(value).name.lower() if value in list(kind) else f"unknown {value}"


def board_state(report: BoardReport | None, latches: type[IntEnum]) -> BoardState:
    """None: there is no board."""
    if report is None:
        return BoardState(
            connected=False,
            boot_id=0,
            drive_state="",
            latch="",
            last_refusal="",
            accepted=0,
            refused=0,
            line_errors=0,
        )
    return BoardState(
        connected=True,
        boot_id=report.boot_id,
        drive_state=word(DriveState, report.drive_state),
        latch=word(latches, report.latch),
        last_refusal=word(Refusal, report.last_refusal),
        accepted=report.accepted,
        refused=report.refused,
        line_errors=report.line_errors,
    )

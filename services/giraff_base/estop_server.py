"""Answers what is asked of the emergency stop, in the one order that is safe with a disk between asking and answer.

Engaging takes effect first and is written then: a disk that is full or hangs delays the answer, never the stop. A
reset is written first and takes effect then: a robot that may move is one that may also after a restart. No I/O and
no clock here: what became of a write comes in as an outcome.
"""

from collections.abc import Iterable
from typing import Final, Protocol

from giraff_base.estop import EStopLatch
from giraff_base.policy import BasePolicy
from giraff_core.io import PendingQuery
from giraff_schemas.messages import RobotTime
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_PATIENCE_NS: Final = 1_000_000_000  # for the disk, before the answer is no; a reset is then given up
_RETRY_NS: Final = 100_000_000  # a stop that is not on disk is lost with the power
_HANGS: Final = Trouble("the disk hangs; while it does, the robot is stopped and a restart may not know")
_NOT_ON_DISK: Final = Trouble("the emergency stop is not on disk: the disk hangs", "mend it")

PendingRequest = PendingQuery[EStopEngage, EStopAnswer] | PendingQuery[EStopReset, EStopAnswer]


class Saver(Protocol):
    """Writes one latch at a time, elsewhere: neither call waits."""

    def save(self, latch: EStopLatch) -> None: ...

    def outcome(self) -> tuple[EStopLatch, str] | None:
        """What was written, and why it is not on disk, empty when it is; None: no news."""


class EStopServer:
    """Stands between those who ask, the policy and the disk. Each turn: `on_requests`, the frames, `turn`."""

    def __init__(self, policy: BasePolicy, saver: Saver, instance: str) -> None:
        """`instance`: of this base, as its samples carry it."""
        self._policy = policy
        self._saver = saver
        self._instance = instance
        self._waiting: list[PendingRequest] = []  # all for the same
        self._waiting_ns = 0  # since when the first of them has
        self._reset: tuple[EStopReset, RobotTime] | None = None  # what they wait for; None: for the latch in force
        self._on_disk: EStopLatch | None = None  # None: nobody knows, and it is written anew
        self._writing: EStopLatch | None = None
        self._writing_ns = 0  # since when
        self._retry_ns = 0
        self._turned_ns = 0  # robot time of the newest turn
        self._failure = NO_TROUBLE
        self.fault = NO_TROUBLE
        """Why the latch in force is not on disk, nor about to be."""

    def on_requests(
        self,
        engages: Iterable[PendingQuery[EStopEngage, EStopAnswer]],
        resets: Iterable[PendingQuery[EStopReset, EStopAnswer]],
        now: RobotTime,
    ) -> None:
        """Take what is asked. Nothing here waits for the disk."""
        for reset in resets:
            self.reset(reset, now)
        for engage in engages:  # after the resets: of two who ask at once, who stops wins
            self.engage(engage, now)

    def engage(self, asked: PendingQuery[EStopEngage, EStopAnswer], now: RobotTime) -> None:
        """Stop, then write: what is confirmed was written since it was asked, whoever else wrote meanwhile."""
        self._policy.on_engage(asked.request, now)
        self._on_disk = None
        if self._reset is not None:
            self._refuse(Trouble("the emergency stop was engaged anew meanwhile"))
        self._wait(asked, now)

    def reset(self, asked: PendingQuery[EStopReset, EStopAnswer], now: RobotTime) -> None:
        """Write, then permit."""
        if self._policy.reset_refusal(asked.request, now) or not self._policy.latch.engaged:
            asked.answer(self._policy.on_reset(asked.request, now))
            return
        if self._reset is None:
            self._refuse(Trouble("it was reset meanwhile"))
            self._reset = asked.request, now
        self._wait(asked, now)

    def turn(self, now: RobotTime) -> None:
        """Note what became of a write, answer, and begin the next one."""
        self._turned_ns = now.robot_ns
        if (outcome := self._saver.outcome()) is not None:
            self._note(*outcome, now)
        if self._on_disk == self._wanted():
            self._confirm()
        elif self._waiting and now.robot_ns - self._waiting_ns > _PATIENCE_NS:
            self._refuse(_HANGS)
        wanted = self._wanted()
        if self._writing is None and self._on_disk != wanted and now.robot_ns >= self._retry_ns:
            self._writing, self._writing_ns = wanted, now.robot_ns
            self._saver.save(wanted)
        hangs = self._writing is not None and now.robot_ns - self._writing_ns > _PATIENCE_NS
        self.fault = self._failure or (_NOT_ON_DISK if hangs else NO_TROUBLE)

    def _wanted(self) -> EStopLatch:
        """What belongs on disk: the latch in force, or what the reset under way would make of it."""
        return self._policy.latch if self._reset is None else self._policy.released(self._reset[0])

    def _wait(self, asked: PendingRequest, now: RobotTime) -> None:
        if not self._waiting:
            self._waiting_ns = self._retry_ns = now.robot_ns
        self._waiting.append(asked)

    def _note(self, latch: EStopLatch, why: str, now: RobotTime) -> None:
        self._writing = None
        self._on_disk = None if why else latch
        self._failure = NO_TROUBLE
        if why:
            self._failure = Trouble(
                f"the emergency stop cannot be kept: {why}", "free the disk or mend its permissions"
            )
            self._retry_ns = now.robot_ns + _RETRY_NS
            self._refuse(self._failure.of("the robot is stopped, and a restart may not know"))

    def _confirm(self) -> None:
        """Answer all who wait, as the disk has it now. A reset that is refused by now is written back."""
        refusal = NO_TROUBLE
        if self._reset is not None:
            refusal = self._policy.reset_refusal(*self._reset)
            self._policy.on_reset(*self._reset)
        self._answer(refusal)

    def _refuse(self, why: Trouble) -> None:
        """Give up what they wait for. A reset then never was; an engaged stop stays, and is written when it can be."""
        self._answer(why)

    def _answer(self, why_not: Trouble) -> None:
        latch = self._policy.latch
        for asked in self._waiting:
            asked.answer(
                EStopAnswer(
                    done=not why_not,
                    engaged=latch.engaged,
                    id=latch.id,
                    reason=why_not,
                    instance=self._instance,
                    unheard_stops_s=self._policy.unheard_stops_s(self._turned_ns),
                )
            )
        self._waiting.clear()
        self._reset = None

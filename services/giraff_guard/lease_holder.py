"""Who drives: one operator at a time holds the lease, and only its own fresh commands count."""

import math
from typing import Final

from giraff_core.freshness import age
from giraff_core.lease import ASK, IDLE
from giraff_core.live import Live
from giraff_guard.config import GuardConfig
from giraff_schemas.messages import DriveCommand, RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_COUNTERS: Final = (1 << 32) - 1  # counters run from 1 to this, and then from 1 again
_MOST_AHEAD: Final = 1000
"""Commands that a holder may have given since its last one, within the second after which silence ends its lease."""
_MOST_UNRANKED: Final = 8  # names; on an open network anybody may ask under any number of them
_LINK: Final = "check its link"
_AT_FAULT: Final = "was at fault"


class LeaseHolder:
    """The lease: (instance of the operator, this guard, counter).

    A late, repeated or foreign command neither keeps the lease alive nor stands in the way of the holder's next one,
    and neither does one whose number lies so far ahead that the holder cannot have given it.
    The holder's newest word always replaces the one before it: where its age is not proven, or where it is not given
    under the lease in force, nothing is asked any more.
    """

    def __init__(self, live: Live[GuardConfig], first_lease: int) -> None:
        self.holder = ""
        """Instance of the operator that holds the lease; empty: it is free."""
        self.operator = ""
        """Its name."""
        self.counter = 0
        """What its commands must carry; 0: the lease is free."""
        self.command: DriveCommand | None = None
        """The holder's newest command, whether or not it is fresh."""
        self.faults = 0
        """How often a holder's side has come to be at fault."""
        self.unranked: tuple[str, ...] = ()
        """Operators that have asked to drive, and whose names no table ranks."""
        self._live = live
        self._next = (first_lease - 1) % _COUNTERS + 1
        self._seq = -1
        self._used = False  # its holder has given a command under the lease in force
        # When (robot_ns) the holder last gave a command that counts, one of a hand, and one that asks for motion.
        self._heard_ns = self._hand_ns = self._wish_ns = 0
        self._ended = ""  # what ended the last lease; empty: its holder was at rest, or there was none
        self._is_alone = True  # no command of any operator was ever heard
        self._complaint = NO_TROUBLE
        self._complaint_ns = 0

    def on_command(self, command: DriveCommand, now: RobotTime) -> bool:
        """Take a command of any operator. True: it is the newest word of who holds the lease now."""
        self._is_alone = False
        self.review(now)
        theirs = self._holds(command)
        if theirs and not self._seq < command.seq <= self._seq + _MOST_AHEAD:
            return False
        if theirs:
            if command.source == "fault" and (self.command is None or self.command.source != "fault"):
                self.faults += 1
            self.command, self._seq = command, command.seq
        old = age(command.tick, now)
        if old > self._live.config.operator_budget:
            if theirs or not self.holder:
                self._complain(command, old, now)
        elif command.lease_counter == ASK:
            self._consider(command, now)
        elif theirs and command.lease_counter == self.counter:
            self._count(command, now)
        return theirs or self._holds(command)

    def review(self, now: RobotTime) -> None:
        """End a lease that nobody makes use of."""
        if not self.holder:
            return
        config = self._live.config
        limits = (
            (self._heard_ns, config.operator_release, "was silent"),
            (self._hand_ns, config.fault_release, _AT_FAULT),
            (self._wish_ns, config.idle_release, "rested"),
        )
        for since_ns, limit, what in limits:
            if (now.robot_ns - since_ns) * 1e-9 > limit:
                at_rest = self.command is not None and self.command.neutral
                self._ended = "" if at_rest and what != _AT_FAULT else f"{self.operator} {what} for {limit:g} s"
                self.holder = self.operator = ""
                self.counter = 0
                self.command = None
                return

    def asked(self, now: RobotTime) -> tuple[DriveCommand | None, Trouble]:
        """The command that counts now; else None and why there is none."""
        command = self.command
        if not self.holder:
            return None, self.reason(now)
        if command is not None and command.source == "fault":
            return None, command.reason.of(self.operator)
        if command is not None and command.lease_counter != self.counter:
            return None, Trouble(f"{self.operator} has not heard under which lease it drives", _LINK)
        if command is None or age(command.tick, now) > self._live.config.operator_budget:
            return None, self._recent_complaint(now) or Trouble(f"no fresh command of {self.operator}", _LINK)
        return command, NO_TROUBLE

    def reason(self, now: RobotTime) -> Trouble:
        """For those who do not hold the lease: who does, or why nobody, and what they do now."""
        if self.holder:
            config = self._live.config
            held = f"held by {self.operator} ({self.holder[:8]})"
            if config.rank(self.operator) < 0:
                return Trouble(f"{held}, which gives way to others", action="take", argument=self.operator)
            free = (
                f"wait until it rests for {config.idle_release:g} s, is silent for {config.operator_release:g} s or "
                f"at fault for {config.fault_release:g} s"
            )
            return Trouble(held, free, "ask", self.operator)
        if complaint := self._recent_complaint(now):
            return complaint
        if self._ended:
            return Trouble(f"nobody drives, since {self._ended}", action="ask")
        return Trouble("no operator is heard", action="start") if self._is_alone else IDLE

    def _consider(self, command: DriveCommand, now: RobotTime) -> None:
        """Grant the lease to a fresh asker, if it may have it."""
        self._note_name(command.operator)
        if command.source == "fault":
            if not self.holder:
                self._complaint, self._complaint_ns = command.reason.of(command.operator), now.robot_ns
            return
        outranks = self._live.config.rank(command.operator) > self._live.config.rank(self.operator)
        # A holder that has driven under its lease and asks again has another hand. Base must be armed by that one.
        renews = self._used and command.instance == self.holder
        # Only a human's wish takes the robot from another: a program that was merely started does not.
        if self.holder and (command.neutral or not (outranks or renews)):
            return
        self.holder, self.operator = command.instance, command.operator
        self.counter = self._next
        self._next = self._next % _COUNTERS + 1
        self.command = None
        self._seq = command.seq
        self._heard_ns = self._hand_ns = self._wish_ns = now.robot_ns
        self._complaint = NO_TROUBLE
        self._used = False

    def _holds(self, command: DriveCommand) -> bool:
        """Whether who gave it holds the lease now."""
        return bool(self.holder) and command.instance == self.holder

    def _note_name(self, operator: str) -> None:
        """Keep the name of an asker that no table ranks: it may be a hand's, which is to be told so."""
        if self._live.config.ranks(operator) or operator in self.unranked or len(self.unranked) >= _MOST_UNRANKED:
            return
        self.unranked = (*self.unranked, operator)

    def _count(self, command: DriveCommand, now: RobotTime) -> None:
        """Keep the lease alive by a fresh command of its holder."""
        self._complaint = NO_TROUBLE
        self._used = True
        self._heard_ns = now.robot_ns
        if command.source == "hand":
            self._hand_ns = now.robot_ns
            if not command.neutral:
                self._wish_ns = now.robot_ns

    def _complain(self, command: DriveCommand, old: float, now: RobotTime) -> None:
        """Keep why a command that would matter did not count."""
        if command.source == "fault":
            why = command.reason
        elif math.isfinite(old):
            why = Trouble(f"its command is {old:.1f} s old", "check its link and its service")
        else:
            why = Trouble("its command carries no moment of this robot's clock", "check that it hears base")
        self._complaint, self._complaint_ns = why.of(command.operator), now.robot_ns

    def _recent_complaint(self, now: RobotTime) -> Trouble:
        recent = (now.robot_ns - self._complaint_ns) * 1e-9 <= self._live.config.operator_release
        return self._complaint if recent else NO_TROUBLE

"""The operator's side of the lease: which counter its commands carry, and why they may be refused."""

import re
from typing import Final

import msgspec

from giraff_schemas.messages import Lease
from giraff_schemas.trouble import NO_TROUBLE, Trouble

ASK: Final = 0
"""The counter of a command that asks for the lease."""
IDLE: Final = Trouble("idle: nobody asks to drive", action="ask")
"""Reason of a lease that is free while nothing is wrong."""
_LATE: Final = 50
"""Samples, 5 s, by which a word may be late. One that is further behind shows that the newest was none of the guard's:
a single false one must not make this operator deaf for good."""
_RENEWED: Final = Trouble("another hand takes over here, and asks for a new lease", action="hold_level")
_NO_GUARD: Final = Trouble("the guard is not heard", "check that giraff_guard runs and that both share a network")

_BARE_KEY: Final = re.compile(r"[A-Za-z0-9_-]+")


def unranked_notice(operator: str) -> Trouble:
    """Return what to tell of an operator whose name no table ranks, with the line that the robot file needs."""
    key = operator if _BARE_KEY.fullmatch(operator) else msgspec.json.encode(operator).decode()
    return Trouble(
        f"operator {operator} has no priority, so any person's hand takes the robot from it",
        f"if a person drives by it, write `{key} = 0` under [guard.priorities] in the robot file of the guard's "
        f"machine, else `{key} = -1`",
    )


class LeaseClient:
    """What one operator process knows of the lease.

    A service asks from its start until it is given the lease once. A lease that was lost is asked for again by each
    wish of a human, and by nothing else: nobody is to find himself in charge because a hand still lies on a desk.
    """

    def __init__(self, instance: str) -> None:
        self._instance = instance
        self._lease: Lease | None = None
        self._held = ASK
        self._given_up: tuple[str, int] | None = None  # a guard's instance, and the counter of its lease
        self.refusal = _NO_GUARD
        """Why this operator does not drive, and who does; NO_TROUBLE when it holds the lease."""

    def on_lease(self, lease: Lease) -> None:
        """Take what the guard says. Late words of the same guard are not taken."""
        newest = self._lease
        if newest is not None and newest.instance == lease.instance and 0 < newest.seq - lease.seq <= _LATE:
            return
        self._lease = lease
        if self.holds:
            self._held = lease.counter
        self.refusal = NO_TROUBLE if self.holds else _RENEWED if self._is_mine(lease) else lease.reason

    @property
    def holds(self) -> bool:
        lease = self._lease
        return lease is not None and self._is_mine(lease) and (lease.instance, lease.counter) != self._given_up

    def give_up(self) -> None:
        """Drive under this lease no more, since another hand takes over. Its wish asks the guard for a new one."""
        if self._lease is not None and self.holds:
            self._given_up = self._lease.instance, self._lease.counter
            self.refusal = _RENEWED

    @property
    def unranked(self) -> tuple[str, ...]:
        """Names of operators that the guard finds in no table."""
        return self._lease.unranked if self._lease is not None else ()

    def counter(self, *, wishes: bool) -> int:
        """The counter for the next command; a lost lease's counts for nothing. `wishes`: a human asks to drive now."""
        return ASK if wishes and not self.holds else self._held

    def _is_mine(self, lease: Lease) -> bool:
        return lease.holder == self._instance

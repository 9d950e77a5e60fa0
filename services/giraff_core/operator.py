"""What every operator is: it hears the robot's clock and who holds the lease, and makes commands that carry both."""

from __future__ import annotations

import math
from typing import Final

from giraff_core.freshness import TickFilter
from giraff_core.lease import LeaseClient, unranked_notice
from giraff_schemas.messages import BaseState, DriveCommand, GuardState, Lease, RobotTime, Source, Tick

LINK_SILENCE: Final = 0.5
"""s without a new tick of the robot after which it counts as lost."""
_LINK_LOST: Final = (
    f"no tick of the robot for {LINK_SILENCE:g} s; check that base runs and that both machines share a network"
)
LEVEL: Final = 0.3
"""s of neutral commands after which base speaks of this lease and no earlier one: 0.2 s of them arm."""
ASKING: Final = (0.0, 0.1)
"""m/s, rad/s. Only a wish for motion takes the lease from a lower priority. What asks for the lease moves nothing."""
ASKS_NOTHING: Final = -1
"""Counter of a command that neither asks for the lease nor is given under one: real ones are never negative."""


class RobotLink:
    """The robot's clock as it is heard elsewhere. Times are seconds of any one monotonic clock."""

    def __init__(self) -> None:
        self._clock = TickFilter()
        self._heard = -math.inf
        self.tick: RobotTime | None = None
        """The newest that was heard."""

    def on_tick(self, tick: Tick, now: float) -> None:
        """Take the robot's clock as it arrives."""
        if self._clock.is_newer(tick, now):
            self.tick, self._heard = tick.time, now

    def link_fault(self, now: float) -> str:
        """Why the robot counts as lost, with the way out; empty: it is heard."""
        return _LINK_LOST if now - self._heard > LINK_SILENCE else ""


class Operator(RobotLink):
    """One operator's process."""

    def __init__(self, name: str, instance: str, *, asks_from_start: bool = True) -> None:
        """`name`: as in `cmd_vel/<name>`; `asks_from_start`: for the lease, not only once a human wishes to drive."""
        super().__init__()
        self._name = name
        self._asks_from_start = asks_from_start
        self._lease = LeaseClient(instance)
        self.holder = ""
        """Name of the operator that holds the lease; empty: none."""

    @property
    def holds(self) -> bool:
        """Whether this process holds the lease."""
        return self._lease.holds

    @property
    def refusal(self) -> str:
        """Why the robot does not obey this process, who drives, and the way out; empty when it holds the lease."""
        return self._lease.refusal

    @property
    def rank_notice(self) -> str:
        """Why persons take the robot from this operator, with the line to write; empty where its name is ranked."""
        return unranked_notice(self._name) if self._name in self._lease.unranked else ""

    def on_lease(self, lease: Lease) -> None:
        """Take what the guard says of who drives."""
        self._lease.on_lease(lease)
        self.holder = lease.operator

    def give_up(self) -> None:
        """Drive under this lease no more: another hand takes over here, and the robot must be armed anew by it."""
        self._lease.give_up()

    def command(
        self,
        linear_x: float,
        angular_z: float,
        *,
        tick: RobotTime | None,
        wishes: bool,
        source: Source = "hand",
        reason: str = "",
    ) -> DriveCommand:
        """A command (m/s, rad/s) under the lease as it is known now.

        `tick`: of what the wish was measured at, never a newer one; `wishes`: a human asks to drive now, which also
        asks for a lease that was lost. A fault never does.
        """
        return DriveCommand(
            operator=self._name,
            lease_counter=self._counter(wishes=wishes and source == "hand"),
            linear_x=linear_x,
            angular_z=angular_z,
            source=source,
            reason=reason,
            tick=tick,
        )

    def fault(self, reason: str, *, tick: RobotTime | None) -> DriveCommand:
        """Stop: the operator's side has lost the hand, or ends. The robot need not wait for silence."""
        return self.command(0.0, 0.0, tick=tick, wishes=False, source="fault", reason=reason)

    def _counter(self, *, wishes: bool) -> int:
        if not (self._asks_from_start or wishes or self.holds):
            return ASKS_NOTHING
        return self._lease.counter(wishes=wishes)


def what_stops(own: str, base: BaseState | None, guard: GuardState | None) -> str:
    """The first link of the chain that stops the robot, with the way out; empty: none does.

    `own`: what the operator itself says. None: that one is not heard.
    """
    if own:
        return own
    if guard is None:
        return "the guard is not heard; check that giraff_guard runs on base's machine"
    if base is None:
        return "base is not heard; check that giraff_base runs"
    return guard.reason or base.reason

"""Operators that speak ten thousand times a second, in simulated time."""

from __future__ import annotations

from typing import Any, Final

from giraff_core.freshness import TickFilter
from giraff_core.io import IO
from giraff_core.lease import ASK
from giraff_core.timer import Timer
from giraff_joystick.service import Joystick
from giraff_schemas.messages import DriveCommand, RobotTime
from giraff_schemas.topics import LEASE, OPERATOR_CMD_VEL, TICK

RATE: Final = 10_000
_BURSTS_HZ: Final = 250.0  # a step of the simulation
_BURST: Final = round(RATE / _BURSTS_HZ)


class FloodingJoystick(Joystick):
    """The holder's own: it says what it says, only far too often."""

    def __init__(self, *what: Any, **more: Any) -> None:
        super().__init__(*what, **more)
        self._bursts = Timer(_BURSTS_HZ)
        self.timers = (*self.timers, self._bursts)

    def turn(self, now: float) -> None:
        super().turn(now)
        if self._bursts.due(now):
            for _ in range(_BURST):
                self._commands.put(self._policy.command(now))


class Stranger:
    """Asks to drive backward, at times under the lease of who drives."""

    link = None

    def __init__(self, io: IO) -> None:
        self._ticks, self._leases = io.inbox(TICK), io.inbox(LEASE)
        self._commands = io.publisher(OPERATOR_CMD_VEL.at("stranger"))
        self._bursts = Timer(_BURSTS_HZ)
        self.timers = (self._bursts,)
        self._clock = TickFilter()
        self._tick: RobotTime | None = None
        self._counter = ASK

    def turn(self, now: float) -> None:
        for heard in self._ticks.take():
            if self._clock.is_newer(heard, now):
                self._tick = heard.time
        for lease in self._leases.take():
            self._counter = lease.counter
        if self._bursts.due(now):
            for number in range(_BURST):
                self._commands.put(
                    DriveCommand(
                        operator="stranger",
                        lease_counter=ASK if number % 2 else self._counter,
                        linear_x=-0.6,
                        angular_z=0.0,
                        source="hand",
                        reason="",
                        tick=self._tick,
                    )
                )

    def end(self) -> None:
        """Nothing is left to say."""

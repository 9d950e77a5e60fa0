"""Operators that speak ten thousand times a second, in simulated time."""

from typing import Any, Final

import msgspec

from giraff_core.io import IO
from giraff_core.lease import ASK
from giraff_core.operator import Operator, Wish
from giraff_core.timer import Timer
from giraff_joystick.service import Joystick
from giraff_schemas.topics import LEASE, OPERATOR_CMD_VEL, TICK
from tests.support.operators import said

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
                self._commands.put(said(self._policy, now))


class Stranger:
    """Asks to drive backward, at times under the lease of who drives."""

    link = None

    def __init__(self, io: IO) -> None:
        self._ticks, self._leases = io.inbox(TICK), io.inbox(LEASE)
        self._commands = io.publisher(OPERATOR_CMD_VEL.at("stranger"))
        self._bursts = Timer(_BURSTS_HZ)
        self.timers = (self._bursts,)
        self._operator = Operator("stranger", io.instance)
        self._counter = ASK  # of who drives

    def turn(self, now: float) -> None:
        for tick in self._ticks.pop_all():
            self._operator.on_tick(tick, now)
        for lease in self._leases.pop_all():
            self._counter = lease.counter
        if self._bursts.due(now):
            asks = self._operator.say(Wish(-0.6, 0.0, self._operator.tick, takes=True))
            forged = msgspec.structs.replace(asks, lease_counter=self._counter)
            for _ in range(_BURST // 2):
                self._commands.put(asks)
                self._commands.put(forged)

    def end(self) -> None:
        """Nothing is left to say."""

"""What people have beside the joystick, around a robot in simulated time: a keyboard's terminal, a command line."""

from typing import Any, Final

import msgspec

from giraff_core.retry import RetriedRequest
from giraff_core.timer import Timer
from giraff_schemas.topics import Query
from giraff_sim.dst.people import UnseenScreen
from giraff_sim.hosts.process import Process

REPEAT: Final = 1.0 / 30.0
"""s, of a key that is held."""


class Desk(UnseenScreen):
    """Where somebody types."""

    typed = b""

    def read(self) -> bytes:
        typed, self.typed = self.typed, b""
        return typed


class Stopper:
    """`giraff estop`."""

    link = None

    def __init__(self, process: Process) -> None:
        self._process = process
        self._asking: list[RetriedRequest[Any]] = []
        self.timers = (Timer(20.0),)

    def ask(self, query: Query[Any, Any], request: msgspec.Struct) -> None:
        self._asking.append(self._process.ask(query, request, lambda _: True))

    def turn(self, now: float) -> None:
        self.timers[0].due(now)
        self._asking = [asking for asking in self._asking if asking.poll(now) is None]

    def end(self) -> None:
        """Nothing is left to say."""

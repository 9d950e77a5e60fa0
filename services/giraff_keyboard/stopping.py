"""The space bar: an emergency stop asked for until base has confirmed it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final, Protocol

from giraff_schemas.messages import EStop, EStopAnswer, Sample

_AGAIN: Final = 0.2  # s between an answer that does not confirm and the next request


class Request(Protocol):
    """One request that is repeated until it is answered."""

    @property
    def fault(self) -> str: ...
    @property
    def attempts(self) -> int: ...
    def poll(self, now: float) -> EStopAnswer | None: ...


class Stopping:
    """Asks base until it says that it has stopped and will stay so. Times are monotonic, s."""

    def __init__(self, ask: Callable[[], Request]) -> None:
        self.asked = False
        """A stop was asked for, and base has not confirmed it."""
        self.text = ""
        """What the person at the keyboard must know."""
        self._ask = ask
        self._request: Request | None = None
        self._next = -math.inf
        self._attempts = 0
        self._trouble = ""

    def engage(self) -> None:
        """The space bar was pressed."""
        if not self.asked:
            self.asked = True
            self._request, self._next = None, -math.inf
            self._attempts, self._trouble = 0, ""
            self._tell()

    def poll(self, now: float) -> bool:
        """Go on asking; whether base has confirmed just now."""
        if not self.asked or now < self._next:
            return False
        if self._request is None:
            self._request = self._ask()
        answer = self._request.poll(now)
        if answer is not None and answer.done and answer.engaged:
            self.asked = False
            self.text = "STOPPED: base has confirmed; `giraff estop reset` releases it"
            return True
        self._trouble = self._request.fault or self._trouble
        attempts = self._attempts + self._request.attempts
        if answer is not None:
            self._trouble = f"base answers: {answer.reason}"
            self._attempts, self._request, self._next = attempts, None, now + _AGAIN
        self._tell(attempts)
        return False

    def on_sample(self, sample: Sample) -> None:
        """Base may say that it is released again."""
        if isinstance(sample, EStop) and not sample.engaged and not self.asked:
            self.text = ""

    def _tell(self, attempts: int = 0) -> None:
        why = f": {self._trouble}" if self._trouble else ""
        self.text = f"STOPPING, NOT CONFIRMED after {attempts} requests{why}; if it moves, use the battery switch"

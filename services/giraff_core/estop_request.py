"""A person's emergency stop: asked for until base has confirmed it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from giraff_schemas.messages import EStop, Sample
from giraff_schemas.requests import EStopAnswer


class Request(Protocol):
    """One request that is repeated until base confirms."""

    @property
    def fault(self) -> str: ...
    @property
    def attempts(self) -> int: ...
    @property
    def refusal(self) -> EStopAnswer | None: ...
    def poll(self, now: float) -> EStopAnswer | None: ...


class EStopRequest:
    """Asks base until it says that it has stopped and will stay so. Times are monotonic, s."""

    def __init__(self, ask: Callable[[], Request], how_to_release: str) -> None:
        self.text = ""
        """What the person who asked must know."""
        self._ask = ask
        self._how_to_release = how_to_release
        self._request: Request | None = None

    @property
    def asked(self) -> bool:
        """Whether a stop was asked for that base has not confirmed."""
        return self._request is not None

    def engage(self) -> None:
        """A stop is wished."""
        if self._request is None:
            self._request = self._ask()
            self._tell(self._request)

    def poll(self, now: float) -> bool:
        """Go on asking; whether base has confirmed just now."""
        if self._request is None:
            return False
        if self._request.poll(now) is not None:
            self._request = None
            self.text = f"STOPPED: base has confirmed; {self._how_to_release}"
            return True
        self._tell(self._request)
        return False

    def on_sample(self, sample: Sample) -> None:
        """Base may say that it is released again."""
        if isinstance(sample, EStop) and not sample.engaged and not self.asked:
            self.text = ""

    def _tell(self, request: Request) -> None:
        trouble = f"base answers: {request.refusal.reason}" if request.refusal is not None else request.fault
        why = f": {trouble}" if trouble else ""
        self.text = (
            f"STOPPING, NOT CONFIRMED after {request.attempts} requests{why}; if it moves, use the battery switch"
        )

"""Whether the router through which other sites hear this one is there."""

from collections.abc import Callable
from typing import Final

from giraff_schemas.trouble import NO_TROUBLE, Trouble

_LOOK: Final = 1.0  # s between looks
_PATIENCE: Final = 5.0  # s; a router that is started again is back sooner


class RouterLink:
    """Says when there is no link to it: Zenoh goes on trying, and says nothing."""

    def __init__(self, address: str, site: str, linked: Callable[[], bool]) -> None:
        self._problem = Trouble(
            f"no link to the router at {address}: is it up and reached from here, are both hosts' certificates of one "
            f"CA and the router's for that address, and has [router] sites there {site!r}?"
        )
        self._linked = linked
        self._seen: float | None = None
        self._next = 0.0
        self._missed = False

    def problem(self, now: float) -> Trouble:
        """What is wrong, with the likely causes. `now`: monotonic, s."""
        if self._seen is None:
            self._seen = now
        if now >= self._next:
            self._next = now + _LOOK
            if self._linked():
                self._seen = now
            self._missed = now - self._seen > _PATIENCE
        return self._problem if self._missed else NO_TROUBLE

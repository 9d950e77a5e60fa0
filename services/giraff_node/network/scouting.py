"""Who answers a call by multicast."""

import time
from typing import Any, Final

import zenoh

_MOST_HEARD: Final = 256  # answers kept; on an open network anybody may answer
_WITHIN: Final = 1.0  # s in which a first answer is waited for
_LATER: Final = 0.1  # s after it; the others come within some ten ms
_LOOK: Final = 0.01  # s
_DOOR: Final = ":7447"
VISIT: Final = b"visit".hex()
"""Marks the id of a visit (`LinkRepair`), before the last eight digits. It ends within a second: nobody misses it, and
no client may link to it, since its link would end, too."""


def is_visit(peer: str) -> bool:
    """Return whether the id is that of a visit."""
    return peer[:-8].endswith(VISIT)


def scout(seconds: float, *, first: bool = False) -> dict[str, list[str]]:
    """Who answers, but for visits: by Zenoh id, its locators.

    `first`: no longer than a moment after the first answer.
    """
    # Zenoh's default handler would block when it is full.
    calling: Any = zenoh.scout(zenoh.handlers.RingChannel(_MOST_HEARD), what="peer|router")
    heard: dict[str, list[str]] = {}
    until = time.monotonic() + seconds
    while (now := time.monotonic()) < until:
        for hello in iter(calling.try_recv, None):
            if is_visit(str(hello.zid)):
                continue
            if first and not heard:
                until = now + _LATER
            heard[str(hello.zid)] = [str(locator) for locator in hello.locators]
        time.sleep(_LOOK)
    calling.stop()
    return heard


def find_doors() -> list[str]:
    """Return locators at which a client may link, those at a door's usual port first."""
    met = dict.fromkeys(locator for locators in scout(_WITHIN, first=True).values() for locator in locators)
    return sorted(met, key=lambda locator: not locator.endswith(_DOOR))

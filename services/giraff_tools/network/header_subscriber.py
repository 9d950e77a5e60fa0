"""Hears how samples travel, not what they say: nothing but their heads is read, so that a flood is counted, too."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from typing import Any, Final

import msgspec
import zenoh

from giraff_schemas.topics import ROOT, Topic, key_of
from giraff_tools.network.statistics import Arrival, Header

_MOST_WAITING: Final = 200_000
_heads: Final = msgspec.msgpack.Decoder(Header)


class HeaderSubscriber:
    """From its making on; `dispatch` from one thread only."""

    def __init__(self, session: zenoh.Session, robot: str, topic: Topic[Any] | None = None) -> None:
        """`topic`: the only one to hear; None: whatever is said below the robot's name."""
        self._below = f"{ROOT}/{robot}/"
        self._came: deque[Arrival] = deque(maxlen=_MOST_WAITING)
        key = f"{self._below}**" if topic is None else key_of(robot, topic)
        self._subscriber = session.declare_subscriber(key, self._on_sample)

    def dispatch(self, hear: Callable[[Arrival], None]) -> None:
        """Pass on what has come since the last call."""
        for _ in range(len(self._came)):
            hear(self._came.popleft())

    def _on_sample(self, received: zenoh.Sample) -> None:
        at, wall_ns = time.monotonic(), time.time_ns()
        payload = bytes(received.payload)
        key = str(received.key_expr).removeprefix(self._below)
        self._came.append(Arrival(key, len(payload), _head(payload), at, wall_ns))


def _head(payload: bytes) -> Header | None:
    try:
        head = _heads.decode(payload)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return None
    return head if head.instance else None

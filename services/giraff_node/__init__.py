"""The runtime that each service runs on."""

import os
import time
from importlib import import_module
from typing import TYPE_CHECKING, Any

# Read once, when the first session opens: as many receiving threads as links that can die at one moment, because a dead
# link's close blocks its thread for up to 10 s and would freeze the healthy links that share it.
os.environ.setdefault("ZENOH_RUNTIME", "(rx: (worker_threads: 16))")

if TYPE_CHECKING:
    from giraff_core.io import Inbox
    from giraff_core.timer import Timer
    from giraff_node.node import Node, Publisher
__all__ = ["Inbox", "Node", "Publisher", "Timer", "robot_now_ns"]

_HOMES = {
    "Inbox": "giraff_core.io",
    "Node": "giraff_node.node",
    "Publisher": "giraff_node.node",
    "Timer": "giraff_core.timer",
}


def robot_now_ns() -> int:
    """Nanoseconds of the clock that ticks are made of and judged by. Meaningful only on base's host.

    CLOCK_BOOTTIME, unlike CLOCK_MONOTONIC, goes on while the machine is suspended: what was queued before a
    suspend is old after it.
    """
    return time.clock_gettime_ns(time.CLOCK_BOOTTIME)


def __getattr__(name: str) -> Any:
    """Import a name when it is first asked for: a command needs no `Node`, and a stop is not to wait for it."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)

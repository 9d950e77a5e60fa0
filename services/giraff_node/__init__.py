"""The runtime that each service runs on."""

from __future__ import annotations

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

# Read once, when the first session opens: as many receiving threads as links that can die at one moment, because a dead
# link's close blocks its thread for up to 10 s and would freeze the healthy links that share it.
os.environ.setdefault("ZENOH_RUNTIME", "(rx: (worker_threads: 16))")

if TYPE_CHECKING:
    from giraff_core.inbox import Inbox
    from giraff_core.timer import Timer
    from giraff_node.node import Node, Publisher
    from giraff_node.process.clock import robot_now_ns

__all__ = ["Inbox", "Node", "Publisher", "Timer", "robot_now_ns"]

_HOMES = {
    "Inbox": "giraff_core.inbox",
    "Node": "giraff_node.node",
    "Publisher": "giraff_node.node",
    "Timer": "giraff_core.timer",
    "robot_now_ns": "giraff_node.process.clock",
}


def __getattr__(name: str) -> Any:
    """Import a name when it is first asked for: a command needs no `Node`, and a stop is not to wait for it."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)

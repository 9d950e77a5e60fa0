"""Lets a dead link go when its lease is over.

To a host that has vanished the kernel tries for a quarter of an hour, and Zenoh's close of that link waits for it: up
to 10 s by its SO_LINGER, with TLS until its last word fits into a buffer that is full. So long it holds a thread, and
the links that share it. And so long this process believes to be linked: it dials nobody there, and when the cable is
back it takes a new link for the old one, and ends both. With TCP_USER_TIMEOUT the kernel gives up when Zenoh does.
"""

from __future__ import annotations

import contextlib
import os
import socket
from pathlib import Path
from typing import Final

from giraff_node.session import LEASE

_WAIT: Final = round(LEASE * 1000)  # ms


def limit_dead_links() -> None:
    """For all TCP connections of this process: what is not acknowledged within a lease ends them."""
    for entry in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(OSError):  # closed since it was listed, or of another kind
            if str(entry.readlink()).startswith("socket:"):
                _limit(os.dup(int(entry.name)))


def _limit(descriptor: int) -> None:
    with socket.socket(fileno=descriptor) as ours:
        ours.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, _WAIT)

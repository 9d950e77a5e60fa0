"""What the kernel is to do for a link, where its defaults are for downloads and not for a robot.

A link that ends. Zenoh's close of it waits until the other end has acknowledged the last word, up to 10 s by its
SO_LINGER, in a thread that links of the process share. Over a cable that loses packets nothing reached guard for 0.2 s,
up to three times a minute, and no longer does without it: then the kernel sends the last word by itself.

A link that is dead. To a host that has vanished the kernel tries for a quarter of an hour, and with TLS Zenoh's close
waits until its last word fits into a buffer that is full. So long this process believes to be linked: it dials nobody
there, and when the cable is back it takes a new link for the old one, and ends both. With TCP_USER_TIMEOUT the kernel
gives up when Zenoh does.

A link that loses packets. One whose repetition is lost, too, is sent once more after 0.2 s at the least, and then after
twice as long each time, and all that was sent later waits for it: more than a command may be old. Of a stream of a few
small packets (`tcp_thin_linear_timeouts` in the kernel's networking/tcp-thin.rst) the wait need not grow, and where the
kernel knows TCP_RTO_MIN_US (Linux 6.15) it begins at RTO_MIN beyond the round trip.
"""

import contextlib
import os
import socket
import struct
from pathlib import Path
from typing import Final

from giraff_node.network.session import LEASE

RTO_MIN: Final = 0.05
"""s; a round trip through a home varies by less."""
_THIN_LINEAR_TIMEOUTS: Final = 16  # linux/tcp.h
_RTO_MIN_US: Final = 45
_WAIT: Final = round(LEASE * 1000)  # ms
_NO_LINGER: Final = struct.pack("ii", 0, 0)  # socket(7), struct linger


def set_tcp_options() -> None:
    """Tell it for all TCP connections of this process. Where a flood has taken all descriptors, the next call does."""
    with contextlib.suppress(OSError):  # no descriptor is free to list them
        for entry in Path("/proc/self/fd").iterdir():
            with contextlib.suppress(OSError):  # closed since then, of another kind, or the kernel is an older one
                if str(entry.readlink()).startswith("socket:"):
                    _tune(os.dup(int(entry.name)))


def _tune(descriptor: int) -> None:
    with socket.socket(fileno=descriptor) as ours:
        ours.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, _WAIT)
        ours.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _NO_LINGER)
        ours.setsockopt(socket.IPPROTO_TCP, _THIN_LINEAR_TIMEOUTS, 1)
        ours.setsockopt(socket.IPPROTO_TCP, _RTO_MIN_US, round(RTO_MIN * 1e6))

"""Where other hosts reach this one, and whether that is still what its session tells them.

Zenoh looks at the interfaces once, when the process opens its first session. A robot whose Wi-Fi comes up after its
services, or gets another address, would go on telling the old addresses: some hosts would reach it and some never.
"""

from __future__ import annotations

import fcntl
import socket
import struct
from pathlib import Path
from typing import Final

_GET_FLAGS: Final = 0x8913  # linux/sockios.h, SIOCGIFFLAGS
_GET_ADDRESS: Final = 0x8915  # SIOCGIFADDR
_LOOPBACK: Final = 0x8  # linux/if.h
_UP_AND_RUNNING: Final = 0x1 | 0x40
_REQUEST: Final = struct.Struct("16s24x")  # struct ifreq: a name, and what is asked for in place of the padding

_LOOK: Final = 1.0  # s between looks
_SETTLED: Final = 1.0  # s; an address that comes and goes is none


def host_addresses() -> frozenset[str]:
    """IPv4 addresses of the interfaces that are up and have a carrier; of no loopback, and no bridge like docker0."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        found = (_address(asked, name) for _, name in socket.if_nameindex())
        return frozenset(address for address in found if address)


class AddressWatch:
    """Says when none of the addresses that were told is left, but there are others. `told`: when the session opened."""

    def __init__(self, told: frozenset[str]) -> None:
        self._told = told
        self._next = 0.0
        self._moved_at: float | None = None

    def due(self, now: float) -> bool:
        """Whether it is time to look again. `now`: monotonic, s."""
        return now >= self._next

    def moved(self, now: float, addresses: frozenset[str]) -> bool:
        """Whether this host is to be found elsewhere, and stays there."""
        self._next = now + _LOOK
        if not addresses or addresses & self._told:
            self._moved_at = None
        elif self._moved_at is None:
            self._moved_at = now
        return self._moved_at is not None and now - self._moved_at >= _SETTLED


def _address(asked: socket.socket, name: str) -> str:
    """Of an interface, or "" while it cannot be reached at any."""
    request = _REQUEST.pack(name.encode())
    try:
        (flags,) = struct.unpack_from("H", fcntl.ioctl(asked, _GET_FLAGS, request), 16)
        if flags & _UP_AND_RUNNING != _UP_AND_RUNNING or flags & _LOOPBACK or _is_bridge(name):
            return ""
        # A struct sockaddr_in: family and port, 2 bytes each, before the address.
        return socket.inet_ntoa(fcntl.ioctl(asked, _GET_ADDRESS, request)[20:24])
    except OSError:  # it is gone since it was listed, or has no address
        return ""


def _is_bridge(name: str) -> bool:
    return Path("/sys/class/net", name, "bridge").exists()

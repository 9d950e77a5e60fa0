"""Where other hosts reach this one, and whether that is still what its session tells them.

Zenoh looks at the interfaces once, when the process opens its first session. A robot whose Wi-Fi comes up after its
door, beside a cable to a laser or a VPN, would go on telling the old addresses, and call on the old networks: nobody on
the new one would find it.
"""

import fcntl
import re
import socket
import struct
from typing import Final

from giraff_schemas.trouble import NO_TROUBLE, Trouble

_GET_FLAGS: Final = 0x8913  # linux/sockios.h, SIOCGIFFLAGS
_GET_ADDRESS: Final = 0x8915  # SIOCGIFADDR
_LOOPBACK: Final = 0x8  # linux/if.h
_UP_AND_RUNNING: Final = 0x1 | 0x40
_REQUEST: Final = struct.Struct("16s24x")  # struct ifreq: a name, and what is asked for in place of the padding

_CONTAINERS: Final = re.compile(r"docker\d|br-[0-9a-f]{12}$|virbr\d|lxc|lxdbr|podman|cni|veth")
"""Names of the interfaces that Docker and its like make: no other host is behind them. A bridge of the host's own, such
as br0, carries its network."""
_LOOK: Final = 1.0  # s between looks
_SETTLED: Final = 1.0  # s; an address that comes and goes is none


def host_addresses() -> frozenset[str]:
    """IPv4 addresses of the interfaces that are up and have a carrier; of no loopback, and no bridge of containers."""
    return frozenset(address for _, address in _found())


def placed_addresses() -> frozenset[str]:
    """The same, each with its interface: one that moves to a bridge is heard by multicast there alone."""
    return frozenset(f"{address} on {name}" for name, address in _found())


def loopback_fault() -> Trouble:
    """Return why processes of this host cannot meet at its own address. A container's fresh network begins so."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        is_up = asked.connect_ex(("127.0.0.1", 9)) == 0  # sends nothing
    return NO_TROUBLE if is_up else Trouble("this host's loopback is down", "type: sudo ip link set lo up")


def _found() -> list[tuple[str, str]]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        every = [(name, _address(asked, name)) for _, name in socket.if_nameindex()]
    return [(name, address) for name, address in every if address]


class AddressWatch:
    """Says when this host is to be found elsewhere than was told. `told`: its addresses when the session opened.

    `every`: each address that comes or goes counts, as it does for a door, which nobody's driving depends on. Else only
    that none of those which were told is left: whoever drives is not stopped by a VPN.
    """

    def __init__(self, told: frozenset[str], *, every: bool = False) -> None:
        self._told = told
        self._every = every
        self._next = 0.0
        self._seen = told
        self._since = 0.0

    def due(self, now: float) -> bool:
        """Whether it is time to look again. `now`: monotonic, s."""
        return now >= self._next

    def moved(self, now: float, addresses: frozenset[str]) -> bool:
        """Whether this host has other addresses, and keeps them."""
        self._next = now + _LOOK
        if addresses != self._seen:
            self._seen, self._since = addresses, now
        is_other = addresses != self._told if self._every else not addresses & self._told
        return bool(addresses) and is_other and now - self._since >= _SETTLED


def flags_up(asked: socket.socket, name: str) -> int:
    """Return the flags of an interface. 0: it is down, or the loopback. Raises OSError."""
    flags: int = struct.unpack_from("H", fcntl.ioctl(asked, _GET_FLAGS, _REQUEST.pack(name.encode())), 16)[0]
    return flags if flags & (_UP_AND_RUNNING | _LOOPBACK) == _UP_AND_RUNNING else 0


def _address(asked: socket.socket, name: str) -> str:
    """Of an interface, or "" while it cannot be reached at any."""
    try:
        if not flags_up(asked, name) or _CONTAINERS.match(name):
            return ""
        request = _REQUEST.pack(name.encode())
        # A struct sockaddr_in: family and port, 2 bytes each, before the address.
        return socket.inet_ntoa(fcntl.ioctl(asked, _GET_ADDRESS, request)[20:24])
    except OSError:  # it is gone since it was listed, or has no address
        return ""

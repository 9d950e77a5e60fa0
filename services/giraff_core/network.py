"""Table `[network]` of the robot file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, Literal

import msgspec

from giraff_core.access import AccessConfig
from giraff_core.site import require_site

_PORT: Final = 7447  # Zenoh's own
HAND_PORTS: Final = range(7448, 7457)
"""Other hosts reach a door at 7447, and hands and whatever else stays at the first free one of these."""
_FURTHER: Final = (10, 11, 12)
"""A door listens at so much more than its port, too: who calls one port all the time shuts that one alone."""


class NetworkConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How this process meets the others."""

    mode: Literal["lan", "fixed", "secured"] = "lan"
    """`lan`: trusted, found by multicast. `fixed`: trusted, found at the addresses in `connect`. `secured`: as fixed,
    with certificates and rules."""
    session_file: str = ""
    """A Zenoh JSON5 file; when given, it alone counts."""
    rendezvous: str = "127.0.0.1:7447"
    """Where the door of this host listens, on its loopback; at the same port it listens to other hosts."""
    sockets: str = ""
    """Folder of the Unix sockets at which the robot's own processes on this host meet; empty: /run/giraff/network where
    this user may use it, else a folder of this user's own."""
    client: bool = False
    """Hear all through the robot's door, over the one link that this host has dialled: for one that cannot be dialled.
    A hand finds out by itself."""
    connect: tuple[str, ...] = ()
    """More hosts to connect to, like "192.168.1.20" or "robot.lan:7447": for networks without multicast."""
    router: str = ""
    """Address of the router through which this site and others hear each other, like "router.example.org:7447"."""
    site: str = ""
    """Where this host is, by a name that `[router] sites` has. The hosts of one site reach each other directly."""
    local: bool = False
    """Keep off the network: loopback only."""
    keys: str = "/etc/giraff/keys"
    """Folder of this host's bundle of certificates; of a secured network."""
    access: AccessConfig = AccessConfig()
    """Which certificate may do what; of a secured network."""

    def __post_init__(self) -> None:
        if self.mode == "secured" and not self.session_file and not self.access.robot:
            raise ValueError("mode is secured, but [network.access] names no host of the robot: nobody could drive it")
        if self.mode != "secured" and len(self.access.robot) > 1:
            raise ValueError(
                f"[network.access] names several hosts of the robot, but mode is {self.mode}: anybody on the network "
                'could speak for guard and ranger; run them on the host of base, or set mode = "secured"'
            )
        for address in self.connect:
            _require_address("connect", address)
        if self.router:
            _require_address("router", self.router)
            if not self.site:
                raise ValueError("router is given, but not at which site this host is: the router passes between sites")
        if self.site:
            require_site(self.site)

    @property
    def is_split(self) -> bool:
        """Whether guard or ranger may run on another host than base."""
        return self.mode == "secured" and len(self.access.robot) > 1


def link_of(network: NetworkConfig) -> str:
    """Zenoh's word for the links between hosts."""
    return "tls" if network.mode == "secured" else "tcp"


def addresses(network: NetworkConfig) -> tuple[str, ...]:
    """Each HOST:PORT at which a door may be: those that are given, then this host's own."""
    others = () if network.local else (*network.connect, *filter(None, [network.router]))
    return tuple(dict.fromkeys(map(with_port, (*others, network.rendezvous))))


def door_ports(address: str) -> tuple[str, ...]:
    """Return the ports of the door at HOST:PORT, as addresses; the usual one first."""
    host, _, port = address.rpartition(":")
    further = [int(port) + more for more in _FURTHER] if port.isdecimal() else []
    return address, *(f"{host}:{each}" for each in further if each < 1 << 16)


def ports_of(network: NetworkConfig, role: str) -> Sequence[int]:
    """Ports of which a process of this role takes the first free one; 0: any, or none at all."""
    return (
        HAND_PORTS
        if not network.local and (role in {"outside", "apart"} or (role == "inside" and network.is_split))
        else (0,)
    )


def _require_address(field: str, address: str) -> None:
    """ValueError unless it is HOST or HOST:PORT, also as Zenoh writes it: tcp/HOST:PORT."""
    address = _plain(address)
    if not address or any(mark in address for mark in "/#? "):
        raise ValueError(f"{field}: {address!r} is no address; give HOST or HOST:PORT, like 192.168.1.20:7447")


def _plain(address: str) -> str:
    return address.removeprefix("tcp/")


def with_port(address: str) -> str:
    """HOST:PORT; an IPv6 address stands in brackets."""
    address = _plain(address)
    _, colon, port = address.rpartition(":")
    return address if colon and not port.endswith("]") else f"{address}:{_PORT}"

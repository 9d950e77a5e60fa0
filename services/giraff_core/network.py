"""Table `[network]` of the robot file."""

from __future__ import annotations

from typing import Final, Literal

import msgspec

from giraff_core.access import AccessConfig
from giraff_core.site import require_site

_PORT: Final = 7447  # Zenoh's own


class NetworkConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How this process meets the others."""

    mode: Literal["lan", "fixed", "secured"] = "lan"
    """`lan`: trusted, found by multicast. `fixed`: trusted, found at the addresses in `connect`. `secured`: as fixed,
    with certificates and rules."""
    session_file: str = ""
    """A Zenoh JSON5 file; when given, it alone counts."""
    rendezvous: str = "127.0.0.1:7447"
    """Where the processes of one host find each other, with or without a network. Any of them may own it."""
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
        for address in self.connect:
            _require_address("connect", address)
        if self.router:
            _require_address("router", self.router)
            if not self.site:
                raise ValueError("router is given, but not at which site this host is: the router passes between sites")
        if self.site:
            require_site(self.site)


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

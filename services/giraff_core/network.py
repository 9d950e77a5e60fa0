"""Table `[network]` of the robot file."""

import ipaddress
import re
from collections.abc import Sequence
from typing import Final, Literal

import msgspec

from giraff_core.access import AccessConfig
from giraff_schemas.trouble import Trouble

_PORT: Final = 7447  # Zenoh's own
HAND_PORTS: Final = range(7448, 7457)
"""Other hosts reach a door at 7447, and hands and whatever else stays at the first free one of these."""
_FURTHER: Final = (10, 11, 12)
"""A door listens at so much more than its port, too: who calls one port all the time shuts that one alone."""
IPV4_ALONE: Final = Trouble("robots listen at IPv4 alone", "give its IPv4 address")
"""Nobody listens at [::]: a host without IPv6 could not, and IPv4 addresses would have a second form there, by which
a process of this host looks like one of another."""
_FORM: Final = "give HOST or HOST:PORT, like 192.168.1.20:7447 or [fd00::2]:7447"
_NAME: Final = re.compile(r"\w[\w-]{0,62}(?:\.\w[\w-]{0,62})*\.?")
_ZONE: Final = re.compile(r"[\w.-]+")
_LONGEST_SITE: Final = 32  # bytes that Zenoh has for the name of a region
_NO_INTERFACE: Final = re.compile(r"fe[89ab][0-9a-f]:([^%]*$|.*%25[a-z])", re.IGNORECASE)
"""An address of one link alone, fe80::/10, without an interface, or with one as a URL has it: %25eth0."""


def require_site(name: str) -> None:
    """Raise ValueError unless a place can be named so, whose hosts reach each other directly."""
    if not name or not name.isprintable() or len(name.encode()) > _LONGEST_SITE:
        raise ValueError(f"site {name!r}: give a name of 1 to {_LONGEST_SITE} letters, like home")


class NetworkConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How this process meets the others."""

    mode: Literal["lan", "fixed", "secured"] = "lan"
    """`lan`: trusted, found by multicast. `fixed`: trusted, found at the addresses in `connect`. `secured`: as fixed,
    with certificates and rules."""
    session_file: str = ""
    """A Zenoh JSON5 file; when given, it alone counts."""
    rendezvous: str = "127.0.0.1:7447"
    """Where the door of this host listens, on its loopback; at the same port it listens to other hosts, by IPv4."""
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
        for field, given in (("connect", self.connect), ("router", (self.router,) if self.router else ())):
            for address in given:
                host_and_port(address, field)
        if ":" in host_and_port(self.rendezvous, "rendezvous")[0] or not re.search(r":\d+$", self.rendezvous):
            raise ValueError(f"rendezvous: {self.rendezvous!r}: give HOST:PORT by IPv4, like 127.0.0.1:7447")
        if self.router and not self.site:
            raise ValueError("router is given, but not at which site this host is: the router passes between sites")
        if self.site:
            require_site(self.site)

    @property
    def is_open(self) -> bool:
        """Return whether another host may speak in base's name. A file of Zenoh's own may permit it."""
        return bool(self.session_file) or not (self.local or self.mode == "secured")

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


def host_and_port(address: str, field: str = "") -> tuple[str, int]:
    """Return host and port of HOST or HOST:PORT, also as Zenoh writes it: tcp/HOST:PORT. Raises ValueError.

    An IPv6 address stands in brackets where a port follows. It is returned without them. `field`: named in an error.
    """
    refused = f"{field and field + ': '}{address!r}"
    text = address.removeprefix("tcp/")
    if text.startswith("["):
        host, end, rest = text[1:].partition("]")
        is_sound = bool(end) and _is_ipv6(host)
    elif text.count(":") > 1:
        host, rest, is_sound = text, "", _is_ipv6(text)
    else:
        host, colon, port = text.partition(":")
        rest, is_sound = colon + port, _is_name(host)
    if not is_sound or "/" in text or rest[:1] not in ("", ":"):
        raise ValueError(f"{refused} is no address; {_FORM}")
    if _NO_INTERFACE.match(host):
        raise ValueError(f"{refused} needs its interface, like fe80::1%eth0")
    if rest and not (re.fullmatch(r":[0-9]{1,5}", rest) and 0 < int(rest[1:]) < 1 << 16):
        raise ValueError(f"{refused}: {rest[1:]!r} is no port from 1 to 65535; {_FORM}")
    return host, int(rest[1:] or _PORT)


def with_port(address: str) -> str:
    """Return HOST:PORT; an IPv6 address stands in brackets."""
    host, port = host_and_port(address)
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"


def _is_name(host: str) -> bool:
    """Tell whether a text is a name or an IPv4 address."""
    if re.fullmatch(r"[\d.]+", host) is None:
        return _NAME.fullmatch(host) is not None
    try:
        ipaddress.IPv4Address(host)
    except ValueError:
        return False
    return True


def _is_ipv6(host: str) -> bool:
    """Tell whether a text is an IPv6 address, also with an interface at its end."""
    try:
        zone = ipaddress.IPv6Address(host).scope_id
    except ValueError:
        return False
    return zone is None or _ZONE.fullmatch(zone) is not None

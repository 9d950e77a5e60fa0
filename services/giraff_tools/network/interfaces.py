"""This machine's networks, as the kernel has them for this process: its own namespace's, whatever /sys shows."""

import contextlib
import fcntl
import ipaddress
import socket
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import msgspec

from giraff_core.network import IPV4_ALONE
from giraff_node.network.host_addresses import flags_up
from giraff_schemas.trouble import Trouble

_ADDRESS: Final = 0x8915  # SIOCGIFADDR
_NETMASK: Final = 0x891B  # SIOCGIFNETMASK
_MULTICAST: Final = 0x1000
_REQUEST: Final = struct.Struct("16s24x")  # struct ifreq


class Interface(msgspec.Struct, frozen=True, kw_only=True):
    """One that is up, besides the loopback."""

    name: str
    address: str
    """IPv4 with the length of its network's prefix."""
    multicast: bool


def interfaces() -> tuple[Interface, ...]:
    """Those that are up and have an IPv4 address, without the loopback."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        return tuple(_each(asked))


def ipv6_alone(own: tuple[Interface, ...], listed: Path = Path("/proc/self/net/if_inet6")) -> tuple[str, ...]:
    """Return the names of interfaces that have IPv6 addresses alone, without the loopback. `own`: those with IPv4."""
    with contextlib.suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        names = dict.fromkeys(line.split()[-1] for line in listed.read_text(encoding="utf-8").splitlines())
        return tuple(name for name in names if flags_up(asked, name) and name not in {each.name for each in own})
    return ()  # a kernel without IPv6


def no_network(alone: tuple[str, ...]) -> Trouble:
    """Return why no robot can be reached without an IPv4 address. `alone`: interfaces that have IPv6 alone."""
    if not alone:
        return Trouble("this machine has no network: no interface is up", "plug the cable in, or join the Wi-Fi")
    fix = f"give it an IPv4 address: by DHCP, or ip address add 169.254.7.1/16 dev {alone[0]} on a cable"
    return Trouble(f"this machine has IPv6 addresses alone ({', '.join(alone)}), and {IPV4_ALONE.what}", fix)


def on_link(address: str, own: tuple[Interface, ...]) -> bool:
    """Whether an IP address is this machine's, or in one of its networks; True for a name: that is not known."""
    with contextlib.suppress(ValueError):
        there = ipaddress.ip_address(address)
        return there.is_loopback or any(there in ipaddress.ip_interface(each.address).network for each in own)
    return True


def is_own(address: str, own: tuple[Interface, ...]) -> bool:
    """Whether an IP address is this machine's."""
    with contextlib.suppress(ValueError):
        there = ipaddress.ip_address(address.strip("[]").partition("%")[0])
        local = there.is_loopback or there.is_link_local  # of a link-local one nothing tells whose it is
        return local or any(there == ipaddress.ip_interface(each.address).ip for each in own)
    return False


def _each(asked: socket.socket) -> Iterator[Interface]:
    for _, name in socket.if_nameindex():
        request = _REQUEST.pack(name.encode())
        with contextlib.suppress(OSError):  # it is gone since it was listed, or has no address
            if not (flags := flags_up(asked, name)):
                continue
            # A struct sockaddr_in: family and port, 2 bytes each, before the address.
            address, mask = (
                socket.inet_ntoa(fcntl.ioctl(asked, what, request)[20:24]) for what in (_ADDRESS, _NETMASK)
            )
            network = ipaddress.ip_interface(f"{address}/{mask}")
            yield Interface(name=name, address=network.with_prefixlen, multicast=bool(flags & _MULTICAST))

"""What a host may be called in a certificate: its own name, and the addresses at which others reach it."""

import re
from collections.abc import Iterable
from ipaddress import IPv4Address, IPv6Address, ip_address
from typing import Final

from giraff_schemas.topics import require_chunk

Address = IPv4Address | IPv6Address | str  # a string is a DNS name

# Where the processes of a host meet each other.
LOCAL: Final[tuple[Address, ...]] = (IPv4Address("127.0.0.1"), IPv6Address("::1"), "localhost")

_NAME: Final = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,62}")  # of a folder, too; X.509 has room for 64 characters
_LABEL: Final = "[a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?"
_DNS_NAME: Final = re.compile(rf"({_LABEL}\.)*(?=[a-z0-9-]*[a-z]){_LABEL}")  # one that ends in a number is no name
_DNS_LENGTH: Final = 253


def require_name(name: str) -> str:
    """`name`, if it can stand in the access rules' keys and name a folder; else ValueError."""
    if not _NAME.fullmatch(require_chunk(name)):
        raise ValueError(f"{name!r} cannot be a host's name: use letters, digits, '-' and '_', 63 at most")
    return name


def require_address(text: str) -> Address:
    """An address as it stands in an endpoint; else ValueError."""
    try:
        address = ip_address(text)
    except ValueError:
        return _require_dns_name(text)
    if isinstance(address, IPv6Address) and address.scope_id is not None:
        raise ValueError(f"{text}: an address with an interface behind % counts on one host only: leave it out")
    if address.is_unspecified or address.is_multicast:
        raise ValueError(f"{text} is no host's address: `ip -brief address` shows them, on that host")
    return address


def with_local(addresses: Iterable[Address]) -> tuple[Address, ...]:
    """Each of them once, and the host's own."""
    return tuple(dict.fromkeys((*addresses, *LOCAL)))


def without_local(addresses: Iterable[Address]) -> tuple[Address, ...]:
    """Those that others use."""
    return tuple(address for address in addresses if address not in LOCAL)


def _require_dns_name(text: str) -> str:
    name = text.lower()
    if len(name) > _DNS_LENGTH or not _DNS_NAME.fullmatch(name):
        raise ValueError(
            f"{text!r} is neither an IP address nor a DNS name: write it bare, like 192.168.1.20 or robot.lan, "
            "without tls/, port, mask or *"
        )
    return name

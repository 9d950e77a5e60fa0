"""The table `[router]` of the router host's robot file, which needs no other table."""

import ipaddress
from typing import Literal

import msgspec

from giraff_core.access import AccessConfig
from giraff_core.network import require_site
from giraff_schemas.topics import require_chunk


class RouterConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where the router listens, between which sites it passes on, and what it lets through."""

    sites: tuple[str, ...]
    """Each `[network] site` of those who dial in; nobody from elsewhere gets a link."""
    robots: dict[str, AccessConfig] = {}
    """Name of a robot -> the table `[network.access]` of its robot file."""
    listen: tuple[str, ...] = ("0.0.0.0:7447",)
    """ADDRESS:PORT, of this host; 0.0.0.0 and [::] are all it has."""
    keys: str = "/etc/giraff/keys"
    """Folder of this host's bundle of certificates."""
    mode: Literal["secured", "fixed"] = "secured"
    """`fixed`: no certificates, no rules. Whoever can reach the router can drive every robot behind it."""

    def __post_init__(self) -> None:
        for site in self.sites:
            require_site(site)
        if len(set(self.sites)) < max(2, len(self.sites)):
            raise ValueError(
                "sites: name two or more, each once, like home and away; a router passes from one to others"
            )
        if not self.listen:
            raise ValueError("listen: give one ADDRESS:PORT at least, like 0.0.0.0:7447")
        for robot, access in self.robots.items():
            require_chunk(robot)
            if not access.robot:
                raise ValueError(f"[router.robots.{robot}] names no host of the robot: copy its [network.access]")
        reachable = [text for text in self.listen if _is_reachable_from_the_internet(text)]
        if self.mode == "secured" and not self.robots:
            raise ValueError("nobody may do anything: give [router.robots.NAME] for each robot behind the router")
        if self.mode == "fixed" and self.robots:
            raise ValueError('mode "fixed" knows no certificates, so the rules in [router.robots] would not hold')
        if self.mode == "fixed" and reachable:
            raise ValueError(
                f'listen: mode "fixed" asks nobody who they are, and {reachable[0]} may be reached from the internet: '
                'set mode to "secured" (giraff keys), or listen at this host\'s private address only, like '
                "192.168.1.5:7447"
            )


def _is_reachable_from_the_internet(text: str) -> bool:
    """Whether ADDRESS:PORT may be. Raises ValueError."""
    address, _, port = text.rpartition(":")
    in_brackets = address.startswith("[") and address.endswith("]")
    try:
        found = ipaddress.ip_address(address.strip("[]"))
        sound = (found.version == 6) == in_brackets and 1 <= int(port) <= 65535
    except ValueError:
        sound, found = False, None
    if found is None or not sound:
        raise ValueError(f"listen: {text!r} is no ADDRESS:PORT of this host; numbers only, like 0.0.0.0:7447")
    return found.is_unspecified or found.is_global

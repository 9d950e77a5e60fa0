"""What the router asks of Zenoh so that it passes on what it may, and what it says of those who dial in."""

from collections.abc import Iterable, Mapping
from typing import Any

import msgspec

from giraff_core.access import AccessConfig, access_control
from giraff_schemas.trouble import NO_TROUBLE, Trouble


def gateway(sites: Iterable[str]) -> dict[str, Any]:
    """Zenoh's regions: what comes from one is passed on to all others, and not within it, where all are linked."""
    return {"south": [{"filters": [{"region_names": [site]}]} for site in sites]}


def rules(robots: Mapping[str, AccessConfig]) -> dict[str, Any]:
    """Zenoh's access control: the rules of each robot's own nodes, for its keys and its hosts.

    No router counts as one of them: whoever dials in speaks for itself.
    """
    together: dict[str, Any] = {"rules": [], "subjects": [], "policies": []}
    for robot, access in robots.items():
        own = access_control(msgspec.structs.replace(access, routers=()), robot)
        for rule in own["rules"]:
            together["rules"].append(rule | {"id": f"{robot}: {rule['id']}"})
        for subject in own["subjects"]:
            together["subjects"].append(subject | {"id": f"{robot}: {subject['id']}"})
        for policy in own["policies"]:
            together["policies"].append({part: [f"{robot}: {name}" for name in policy[part]] for part in policy})
    return together


class Visitors:
    """Who is linked to the router, by the names in their certificates; each has a link for each of its processes."""

    def __init__(self, robots: Mapping[str, AccessConfig]) -> None:
        self._known = {host for access in robots.values() for host in access.hosts}
        self._secured = bool(robots)
        self._here: dict[str, set[str]] = {}

    def update(self, links: Iterable[tuple[str, str]]) -> list[str]:
        """What to log, of the (host, address) of all links there are now."""
        now: dict[str, set[str]] = {}
        for host, address in links:
            now.setdefault(host, set()).add(address.rpartition(":")[0])
        news = [
            f"{host} is here, from {', '.join(sorted(now[host]))}" for host in now if self._here.get(host) != now[host]
        ]
        news += [f"{host} is gone" for host in self._here if host not in now]
        self._here = now
        return news

    @property
    def strangers(self) -> Trouble:
        """Why some of those who are here hear and say nothing."""
        unnamed = sorted(set(self._here) - self._known) if self._secured else []
        if not unnamed:
            return NO_TROUBLE
        told = "has a certificate, but no part in any [router.robots]: it can do nothing here"
        return Trouble(told).of(", ".join(unnamed))

"""Networks with no route between them, on one machine: a namespace for each site and one for the router's host."""

import os
import subprocess
import time
from pathlib import Path
from types import TracebackType
from typing import Final, Self

from tests.support.waiting import wait

ROUTER: Final = "router"
_SOCKETS: Final = Path("/tmp/giraff-sites")  # noqa: S108  nothing is written to it: each site has a memory of its own there
OWN_SOCKETS: Final = {"GIRAFF_NETWORK_SOCKETS": str(_SOCKETS)}
"""For the environment of each process: no host sees the Unix sockets of another."""
_PATIENCE: Final = 10.0  # s


class Sites:
    """Each site is a network of its own with one cable, to the router's host. All is gone with the block.

    `routed`: the router's host passes packets on, as that of one large network would.
    Needs root, or a kernel that lets users have namespaces of their own.
    """

    def __init__(self, *sites: str, routed: bool = False) -> None:
        self._sites = sites
        self._routed = routed
        self._holders: dict[str, subprocess.Popen[bytes]] = {}
        self._as_user = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]

    def __enter__(self) -> Self:
        _SOCKETS.mkdir(exist_ok=True)
        try:
            self._hold(ROUTER, ["unshare", *self._as_user, "--net", "--mount"])
            self._run(ROUTER, "sh", "-c", f"echo {self._routed:d} > /proc/sys/net/ipv4/ip_forward")
            self._run(ROUTER, "ip", "link", "set", "lo", "up")
            for site in self._sites:
                self._hold(site, [*self._into(ROUTER), "unshare", "--net", "--mount"])
                self._wire(site)
            for site in self._sites:
                self.await_link(site, "UP")
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """A namespace ends with the last process in it."""
        for holder in self._holders.values():
            holder.kill()
            holder.wait()

    def command(self, site: str, *words: str) -> list[str]:
        """The command line that runs `words` in a site's network."""
        return [*self._into(site), *words]

    def address(self, site: str) -> str:
        """Of the site's host."""
        return f"10.71.{self._sites.index(site)}.2"

    def router(self, site: str) -> str:
        """The router's address, as this site knows it."""
        return f"10.71.{self._sites.index(site)}.1"

    def pull(self, site: str) -> None:
        """The site's cable: nothing is closed, nothing comes."""
        self._run(ROUTER, "ip", "link", "set", _leg(site), "down")

    def plug(self, site: str) -> None:
        self._run(ROUTER, "ip", "link", "set", _leg(site), "up")

    def await_link(self, site: str, state: str) -> None:
        """Until the site's host has noticed its cable, UP or DOWN: the kernel takes up to a second."""

        def is_so() -> bool:
            return f"state {state}" in self._run(site, "ip", "-o", "link", "show", "uplink")

        wait(is_so, _PATIENCE, what=f"the link of {site} {state}", every=0.05)

    @property
    def router_addresses(self) -> list[str]:
        return [self.router(site) for site in self._sites]

    def _hold(self, site: str, command: list[str]) -> None:
        holder = subprocess.Popen([*command, "sh", "-c", f"mount -t tmpfs tmpfs {_SOCKETS} && exec sleep infinity"])
        self._holders[site] = holder
        deadline = time.monotonic() + _PATIENCE
        while (
            Path(f"/proc/{holder.pid}/comm").read_text(encoding="utf-8").strip() != "sleep"
        ):  # before, it is not yet in its own
            assert holder.poll() is None, "no network namespace: unshare says why; root may make them"
            assert time.monotonic() < deadline, "no network namespace in time"
            time.sleep(0.01)

    def _into(self, site: str) -> list[str]:
        user = ["--user", "--preserve-credentials"] if self._as_user else []
        return ["nsenter", "--target", str(self._holders[site].pid), *user, "--net", "--mount", "--wd=.", "--"]

    def _wire(self, site: str) -> None:
        leg, peer = _leg(site), str(self._holders[site].pid)
        self._run(ROUTER, "ip", "link", "add", leg, "type", "veth", "peer", "name", "uplink", "netns", peer)
        self._run(ROUTER, "ip", "address", "add", f"{self.router(site)}/24", "dev", leg)
        self._run(site, "ip", "address", "add", f"{self.address(site)}/24", "dev", "uplink")
        for place, name in ((ROUTER, leg), (site, "uplink"), (site, "lo")):
            self._run(place, "ip", "link", "set", name, "up")
        if self._routed:
            self._run(site, "ip", "route", "add", "default", "via", self.router(site))

    def _run(self, site: str, *words: str) -> str:
        done = subprocess.run(
            self.command(site, *words), check=False, capture_output=True, text=True, timeout=_PATIENCE
        )
        assert done.returncode == 0, f"{' '.join(words)}: {done.stderr}"
        return done.stdout


def _leg(site: str) -> str:
    """The router's interface to a site."""
    return f"to-{site}"

"""A router between sites: its process, and hosts behind it, each with a certificate, a robot file and a session."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

from giraff_setup.keys.manage import make_authority, make_bundle
from tests.support.elsewhere import clean
from tests.support.sites import OWN_SOCKETS, ROUTER, Sites

_SESSION: Final = Path(__file__).with_name("site_session.py")


class Host:
    """One session of a host, in a process in its site's network."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def ask(self, word: str, *arguments: str) -> Any:
        """What `site_session.SiteSession` answers."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps([word, *arguments]) + "\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        assert line, f"the session ended with {self._process.wait()}; see its log"
        return json.loads(line)

    def end(self) -> None:
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            pipe.close()


class BehindRouter:
    """`access`: robot -> its table `[network.access]`; none: without certificates. All is gone with `close`."""

    def __init__(self, directory: Path, sites: Sites, names: tuple[str, ...], access: Mapping[str, Any]) -> None:
        self._directory = directory
        self._sites = sites
        self._names = names
        self._access = access
        self._mode = "secured" if access else "fixed"
        self._hosts: list[Host] = []
        self._router: subprocess.Popen[bytes] | None = None
        self.keys = directory / "keys"
        make_authority(self.keys, datetime.now(UTC))
        self.certify(ROUTER, *sites.router_addresses)

    def certify(self, host: str, *addresses: str) -> None:
        make_bundle(self.keys, host, addresses, days=30, renew=False, moment=datetime.now(UTC))

    def address(self, site: str) -> str:
        """Of the hosts at this site."""
        return self._sites.address(site)

    def start_router(self) -> None:
        path = self._directory / "router.toml"
        listen = [f"{address}:7447" for address in self._sites.router_addresses]
        path.write_text(
            f"[router]\nsites = {json.dumps(self._names)}\nkeys = {json.dumps(str(self.keys / ROUTER))}\n"
            f"mode = {json.dumps(self._mode)}\nlisten = {json.dumps(listen)}\n"
            + "".join(_table(f"router.robots.{robot}", access) for robot, access in self._access.items())
        )
        command = self._sites.command(ROUTER, sys.executable, "-m", "giraff_node", "router")
        with self.router_log.open("ab") as log:
            self._router = subprocess.Popen(command, env=_environment(path), stderr=log)

    def kill_router(self) -> None:
        assert self._router is not None
        self._router.send_signal(signal.SIGKILL)
        self._router.wait()
        self._router = None

    @property
    def router_log(self) -> Path:
        return self._directory / "router.log"

    def rogue_router(self) -> Host:
        """Its certificate and address in other hands: nothing that dials in is asked for its rights."""
        path = self._directory / "rogue.toml"
        robot, access = next(iter(self._access.items()))
        path.write_text(
            f'[network]\nmode = "secured"\nkeys = {json.dumps(str(self.keys / ROUTER))}\n'
            + _table("network.access", access)
        )
        listen = {"endpoints": ["tls/0.0.0.0:7447"]}
        south = {"south": [{"filters": [{"region_names": [site]}]} for site in self._names]}
        lawless = {"enabled": False}
        return self.open(ROUTER, path, robot, mode="router", listen=listen, gateway=south, access_control=lawless)

    def reaches(self, site: str, other: str) -> bool:
        """Whether a host at a site gets any answer from the other one's."""
        address = self._sites.router(site) if other == ROUTER else self._sites.address(other)
        knock = f"import socket; socket.create_connection(({address!r}, 7447), timeout=2.0)"
        command = self._sites.command(site, sys.executable, "-c", knock)
        return subprocess.run(command, check=False, capture_output=True).returncode == 0

    def robot_file(self, host: str, site: str, robot: str) -> Path:
        """Of a host at a site, which has a certificate by now."""
        path = self._directory / f"{host}-{robot}.toml"
        path.write_text(
            f'[network]\nmode = "{self._mode}"\nsite = "{site}"\nrouter = "{self._sites.router(site)}"\n'
            f"keys = {json.dumps(str(self.keys / host))}\n{_table('network.access', self._access.get(robot, {}))}"
        )
        return path

    def join(self, host: str, site: str, robot: str, **changes: Any) -> Host:
        """A session of `host`, as one of its processes would open it for `robot`. `changes`: to its Zenoh settings."""
        path = self.robot_file(host, site, robot)
        return self.open(site if host != ROUTER else ROUTER, path, robot, **changes)

    def open(self, place: str, robot_file: Path, robot: str, **changes: Any) -> Host:
        command = self._sites.command(place, sys.executable, str(_SESSION), robot, json.dumps(changes))
        with (self._directory / f"{place}.log").open("ab") as log:
            process = subprocess.Popen(
                command,
                env=_environment(robot_file),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
            )
        self._hosts.append(Host(process))
        return self._hosts[-1]

    def close(self) -> None:
        for host in self._hosts:
            host.end()
        if self._router is not None:
            self.kill_router()


def _environment(robot_file: Path) -> dict[str, str]:
    """Of a process that is started for itself: this one's own threads are no word for it."""
    given = {name: value for name, value in os.environ.items() if name != "ZENOH_RUNTIME"}
    return clean(given) | OWN_SOCKETS | {"GIRAFF_CONFIG": str(robot_file)}


def _table(name: str, access: Mapping[str, Any]) -> str:
    """`[network.access]` or the same for the router, as TOML."""
    lists = [f"{part} = {json.dumps(hosts)}" for part, hosts in access.items() if part != "operators"]
    operators = [f"{host} = {json.dumps(names)}" for host, names in access.get("operators", {}).items()]
    return "\n".join([f"[{name}]", *lists, f"[{name}.operators]", *operators, ""])

"""A robot's computer and other hosts as namespaces on a switch, with the services as processes and no Docker.

Each host has a folder of sockets of its own, as computers have. The simulator runs on none of them: its record of the
motors is the judge.
"""

import os
import subprocess
import sys
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Final, Self

from giraff_core.estop.latch import RELEASED
from giraff_node.process.state import write_latch
from giraff_sim.board import ROOT
from tests.hosts.hardware import ROBOT, Hardware
from tests.hosts.machine import Machine, kill, run
from tests.hosts.switch import Switch
from tests.support.waiting import wait

NAME: Final = "sim-site"
NUMBERS: Final = {"robot": 12, "laptop": 11, "stranger": 13}
"""Host -> the end of its address."""
INSIDE: Final = ("base", "guard", "ranger", "odometry")
PYTHON: Final = (sys.executable, "-P")
_FIREWALL: Final = "inet giraff_firewall"
_PATIENCE: Final = 60.0  # s


class ProcessSite:
    """Hosts that are on, a simulator, and no service yet."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self._running: dict[str, subprocess.Popen[bytes]] = {}
        write_latch(directory / "state", RELEASED)
        with ExitStack() as end:
            self.hardware = Hardware(directory, directory / "ports")
            end.callback(self.hardware.close)
            switch = Machine("switch", directory / "switch")
            self.switch = Switch(switch)
            end.callback(self.switch.off)
            self.machines = {name: Machine(name, directory / name) for name in NUMBERS}
            for name, machine in self.machines.items():
                end.callback(machine.power_off)
                machine.power_on()
                self.switch.plug(machine, NUMBERS[name])
            self._end = end.pop_all()

    def environment(self, network: Mapping[str, str]) -> dict[str, str]:
        """Of a process: the robot's file, and what this says about the table `[network]`."""
        return {
            **{name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")},
            **ROBOT,
            **{f"GIRAFF_NETWORK_{name.upper()}": value for name, value in network.items()},
            "GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"),
            "GIRAFF_ROBOT_NAME": NAME,
            "STATE_DIRECTORY": str(self.directory / "state"),
            "XDG_RUNTIME_DIR": "/run",  # of the machine alone
            **{f"GIRAFF_{board.upper()}_PORT": str(self.directory / "ports" / board) for board in ("base", "ranger")},
            "GIRAFF_JOYSTICK_PORT": str(self.directory / "ports" / "joystick"),
            "GIRAFF_CAMERA_DEVICE": str(self.directory / "camera"),
        }

    def giraff(self, host: str, network: Mapping[str, str], *words: str) -> str:
        """Run a command on a host that has no robot file; what it printed. AssertionError where it fails."""
        return self.run(host, network, ["-m", "giraff_cli", *words, "--robot", NAME])

    def run(self, host: str, network: Mapping[str, str], words: list[str]) -> str:
        """The same, of a program in Python."""
        streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        env = self.environment(network) | {"GIRAFF_CONFIG": "/dev/null"}
        process = self.machines[host].start([*PYTHON, *words], env=env, cwd=self.directory, **streams)
        try:
            out, err = process.communicate(timeout=_PATIENCE)
        finally:
            kill(process)
        assert process.returncode == 0, f"{words}: {process.returncode}: {out[-2000:]}{err[-2000:]}"
        return f"{out}{err}"

    def start(self, network: Mapping[str, str], *services: str, host: str = "robot") -> None:
        for service in services:
            self.begin(service, host, [*PYTHON, "-m", "giraff_node", service], network)

    def begin(self, name: str, host: str, command: list[str], network: Mapping[str, str]) -> subprocess.Popen[bytes]:
        """Start a program on a host; its log is NAME.log, its standard output NAME.out."""
        with (self.directory / f"{name}.log").open("wb") as log, (self.directory / f"{name}.out").open("wb") as out:
            self._running[name] = self.machines[host].start(
                command,
                env=self.environment(network),
                cwd=self.directory,
                stdin=subprocess.PIPE,
                stdout=out,
                stderr=log,
            )
        return self._running[name]

    def kill(self, *names: str) -> None:
        """SIGKILL; no name: all that run."""
        for name in names or list(self._running):
            with self._running.pop(name) as process:  # which closes its standard input
                kill(process)

    def shut(self, host: str, *, but: str = "") -> None:
        """A firewall on a host that lets no other begin anything, except what nft calls `but`."""
        rules = "\n".join(
            [
                f"table {_FIREWALL} {{",
                "chain input { type filter hook input priority 0; policy drop;",
                "iif lo accept",
                "ct state established,related accept",
                *([f"{but} accept"] if but else []),
                "}",
                "}",
            ]
        )
        self._in_network(host, "nft", "--file", "-", given=f"table {_FIREWALL}\ndelete table {_FIREWALL}\n{rules}\n")

    def open(self, host: str) -> None:
        """No firewall any more; none is fine."""
        self._in_network(host, "nft", "--file", "-", given=f"table {_FIREWALL}\ndelete table {_FIREWALL}\n")

    def bound(self, host: str) -> None:
        """Load the rules against floods, as their unit does."""
        self._in_network(host, "nft", "--file", str(ROOT / "deploy" / "firewall" / "giraff.nft"))
        self._in_network(host, "sysctl", "--quiet", "--write", "net.netfilter.nf_conntrack_acct=1")

    def pid(self, name: str) -> int:
        """Return the number of a running program. It is a child of what was started."""
        first = self._running[name].pid
        children = Path(f"/proc/{first}/task/{first}/children")
        wait(children.read_text, 20.0, what=f"the child of {name}")
        return int(children.read_text(encoding="utf-8"))

    def ip(self, host: str, *commands: str) -> None:
        """Run commands of ip(8) on a host."""
        for command in commands:
            self._in_network(host, "ip", *command.split())

    def _in_network(self, host: str, *command: str, given: str = "") -> str:
        return run(["nsenter", "--target", str(self.machines[host].pid), "--net", *command], input=given)

    def log(self, name: str) -> str:
        return (self.directory / f"{name}.log").read_text()

    def output(self, name: str) -> str:
        return (self.directory / f"{name}.out").read_text()

    def close(self) -> None:
        self.kill()
        self._end.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

"""The network between the machines: one switch, and a cable to each."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Final

from tests.hosts.machine import Machine, let_first, run

NETWORK: Final = "10.77.0"
_TABLE: Final = "netdev giraff_hosts"
_CALLS: Final = "netdev giraff_calls"
_BAD_CABLE: Final = Path(__file__).with_name("bad_cable.py")


class Switch:
    """A machine that is nothing but a bridge. A cable's end at the switch is called as the machine at its other end."""

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self._plugged: set[str] = set()
        self._bad_cables: dict[str, subprocess.Popen[bytes]] = {}
        machine.power_on()
        self._ip("link", "set", "lo", "up")
        self._ip("link", "add", "bridge", "type", "bridge", "mcast_snooping", "0")  # a plain switch floods multicast
        self._ip("link", "set", "bridge", "up")

    def plug(self, machine: Machine, number: int) -> None:
        """Connect a machine that is on; its address ends in `number`."""
        ends = [
            "eth0",
            "netns",
            str(machine.pid),
            "type",
            "veth",
            "peer",
            machine.name,
            "netns",
            str(self._machine.pid),
        ]
        run(["ip", "link", "add", *ends])
        self._connect(machine, number)

    def plug_badly(self, machine: Machine, number: int, cable: str = "bad") -> None:
        """As `plug`, with a cable of bad_cable.py."""
        ends = [cable, str(self._machine.pid), machine.name, str(machine.pid), "eth0"]
        process = subprocess.Popen(
            [sys.executable, "-I", str(_BAD_CABLE), *ends], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self._bad_cables[machine.name] = process
        let_first(process.pid)
        assert process.stdout is not None
        assert process.stdout.readline() == b"ready\n", "no TAP devices: see above"
        self._connect(machine, number)

    def _connect(self, machine: Machine, number: int) -> None:
        self._plugged.add(machine.name)
        self._ip("link", "set", machine.name, "master", "bridge", "up")
        for words in (
            ["link", "set", "lo", "up"],
            ["address", "add", f"{NETWORK}.{number}/24", "dev", "eth0"],
            ["link", "set", "eth0", "up"],
            ["route", "add", "default", "via", f"{NETWORK}.1"],  # as a home's router has it; multicast takes it, too
        ):
            self._ip(*words, of=machine)

    def unplug(self, machine: Machine) -> None:
        """Take the cable away for good: the last thing that a machine without power sends is nothing. None is fine."""
        if machine.name not in self._plugged:
            return
        self._plugged.remove(machine.name)
        if cable := self._bad_cables.pop(machine.name, None):
            cable.communicate()
        else:
            self._ip("link", "delete", machine.name)

    def cut(self, machine: Machine) -> None:
        """Cut its cable: it has its address, and nobody answers."""
        self._ip("link", "set", machine.name, "down")

    def join(self, machine: Machine) -> None:
        self._ip("link", "set", machine.name, "up")

    def lose(self, machine: Machine, percent: int) -> None:
        """Lose so many of the packets that the machine sends and of those that are sent to it; 0: none."""
        rules = f"table {_TABLE}\ndelete table {_TABLE}\n"
        if percent:
            drop = f"priority 0; numgen random mod 100 < {percent} drop"
            rules += f"""table {_TABLE} {{
                chain from_it {{ type filter hook ingress device "{machine.name}" {drop}; }}
                chain to_it {{ type filter hook egress device "{machine.name}" {drop}; }}
            }}"""
        self._run("nft", "--file", "-", given=rules)

    def count_calls(self, by: Machine, *to: str) -> None:
        """From now on count the TCP connections that a machine tries to open to these addresses."""
        self._run(
            "nft",
            "--file",
            "-",
            given=f"""table {_CALLS}
            delete table {_CALLS}
            table {_CALLS} {{
                chain from_it {{ type filter hook ingress device "{by.name}" priority 0;
                    ip daddr {{ {", ".join(to)} }} tcp flags & (syn | ack) == syn counter; }}
            }}""",
        )

    def calls(self) -> int:
        """Counted so far."""
        told = json.loads(self._run("nft", "--json", "list", "table", *_CALLS.split()))
        [rule] = [one["rule"] for one in told["nftables"] if "rule" in one]
        [counter] = [one["counter"] for one in rule["expr"] if "counter" in one]
        return int(counter["packets"])

    def off(self) -> None:
        for cable in self._bad_cables.values():
            cable.communicate()
        self._machine.power_off()

    def _ip(self, *words: str, of: Machine | None = None) -> None:
        self._run("ip", *words, of=of)

    def _run(self, *command: str, of: Machine | None = None, given: str = "") -> str:
        return run(["nsenter", "--target", str((of or self._machine).pid), "--net", *command], input=given)

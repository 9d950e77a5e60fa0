"""Three hosts on one machine: laptop, robot and desk, a switch between them, and the robot's boards beside them."""

import json
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, Self

import msgspec

from tests.hosts.clone import clone, write_env
from tests.hosts.containers import Container, container
from tests.hosts.hardware import BOARDS, PORTS, ROBOT, Hardware
from tests.hosts.images import KEPT, Images
from tests.hosts.machine import COMPOSE, LabError, Machine, kill, run
from tests.hosts.switch import NETWORK, Switch
from tests.support.waiting import wait

NAME: Final = "sim-lab"
NUMBERS: Final = {"laptop": 11, "robot": 12, "desk": 13}
"""Host -> the end of its address."""
IMAGES: Final = {"laptop": ("laptop",), "robot": ("robot",), "desk": ("laptop",)}
"""Host -> the images that it has from the start."""
PATIENCE: Final = 120.0  # s; other tests may run beside these
_LISTENER: Final = Path(__file__).with_name("listener.py")
_FRESH: Final = 0.2  # s


class Heard(msgspec.Struct, frozen=True):
    """A line of listener.py."""

    at: float
    age: float
    sample: dict[str, Any]


_decode_heard: Final = msgspec.json.Decoder(Heard).decode


class Listener:
    """Hears one key on one host, and knows when."""

    def __init__(self, process: subprocess.Popen[bytes], output: Path) -> None:
        self._process = process
        self._output = output

    def heard(self, since: float = 0.0) -> list[Heard]:
        """All that arrived after `since`, s of time.monotonic()."""
        lines = self._output.read_bytes().rpartition(b"\n")[0].splitlines()
        return [one for one in map(_decode_heard, lines) if one.at > since]

    def said(self, since: float, until: float) -> list[dict[str, Any]]:
        """The samples that arrived in a window."""
        return [one.sample for one in self.heard(since) if one.at < until]

    def flows_after(self, moment: float, within: float) -> float:
        """Wait for a sample that is no older than a hop; s after `moment` that it arrived."""
        fresh: list[Heard] = []

        def arrived() -> bool:
            fresh[:] = [one for one in self.heard(moment) if one.age < _FRESH]
            return bool(fresh)

        def told() -> str:
            heard = self.heard()
            newest = f"the newest came at {heard[-1].at:.2f}, {heard[-1].age:.2f} s old" if heard else "none ever came"
            return f"a fresh sample after {moment:.2f}; {newest}"

        wait(arrived, within, what=told)
        return fresh[0].at - moment

    def longest_gap(self, since: float, until: float) -> float:
        """s without a sample, in a window."""
        times = [since, *(one.at for one in self.heard(since) if one.at < until), until]
        return max(later - earlier for earlier, later in pairwise(times))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        kill(self._process)


class Lab:
    """Made with the hosts on and their images there; no container runs."""

    def __init__(self, kinds: Mapping[str, tuple[str, ...]] = IMAGES, images: Images | None = None) -> None:
        """`images`: in which these kinds are being built already. The lab closes it."""
        self._kinds = dict(kinds)
        self._images = images or Images()
        self._end = ExitStack()
        self.directory = KEPT / "lab"
        try:
            self._make()
        except BaseException:
            self.close()
            raise

    def _make(self) -> None:
        self._end.callback(self._images.close)
        self._images.build(kind for each in self._kinds.values() for kind in each)
        self._remove_directory()  # of a lab that was killed
        self.directory.mkdir()
        self._end.callback(self._remove_directory)
        # The hosts' disks: 100 000 files of images, which a disk took half a minute to write and to remove.
        run(["mount", "-t", "tmpfs", "tmpfs", str(self.directory)])
        self.hardware = Hardware(self._folder("hardware"))
        self._end.callback(self.hardware.close)
        self.machines = {host: Machine(host, self._folder(host)) for host in NUMBERS}
        switch = Machine("switch", self._folder("switch"))
        self._end.callback(switch.power_off)  # whatever it comes to
        self.switch = Switch(switch)
        self._end.callback(self.switch.off)
        for host, machine in self.machines.items():
            self._images.give(machine, self._kinds[host])
            self._end.callback(machine.power_off)
            self._boot(machine)
        for machine in self.machines.values():
            machine.wait_for_docker()
        for host in NUMBERS:
            clone(self.clone(host))
            self.write_env(host)

    def write_env(
        self, host: str, changes: Mapping[str, str] | None = None, more: Mapping[str, str] | None = None
    ) -> None:
        """The host's `.env`, as its technician writes it. `more`: lines that its example has not."""
        ports = {"laptop": ["joystick"], "robot": ["base", "ranger"], "desk": []}[host]
        own = {"GIRAFF_ROBOT_NAME": NAME} | {f"GIRAFF_{port.upper()}_PORT": str(PORTS / port) for port in ports}
        if host != "robot":
            own["GIRAFF_NETWORK_CONNECT"] = json.dumps([address("robot")])
        write_env(self.clone(host), host, {**own, **(changes or {})}, {**ROBOT, **(more or {})})

    def clone(self, host: str) -> Path:
        return self.directory / host / "giraff"

    def up(self, host: str, program: str | Path = COMPOSE) -> float:
        """`docker-compose up` on a host; when it returned."""
        self.compose(host, "up", "--detach", program=program)
        return time.monotonic()

    def compose(self, host: str, *words: str, within: float = 120.0, program: str | Path = COMPOSE) -> str:
        return self.machines[host].compose(self.clone(host), *words, within=within, program=program)

    def containers(self, host: str) -> list[Container]:
        """Of a host, as its Docker has them; none while it has no Docker."""
        machine = self.machines[host]
        try:
            names = machine.docker("ps", "--all", "--quiet").split()
            return [container(one) for one in json.loads(machine.docker("inspect", *names))] if names else []
        except LabError:
            return []

    def wait_until_healthy(self, *hosts: str, within: float = PATIENCE) -> float:
        """When the last of their containers was, s of time.monotonic()."""
        told: list[Container] = []

        def well() -> bool:
            on_each = [self.containers(host) for host in hosts]
            told[:] = [one for each in on_each for one in each]
            return all(on_each) and None not in (one.well_since for one in told)

        try:
            wait(well, within, what="healthy containers", every=0.5)  # to ask costs some 0.1 s of a core
        except AssertionError as error:
            logs = "".join(self.compose(host, "logs", "--tail", "20") for host in hosts)
            raise AssertionError(f"{error}: {told}\n{logs}") from error
        return max(one.well_since for one in told if one.well_since is not None)

    def down(self, *hosts: str) -> None:
        """`docker-compose down` on them: the latch stays."""
        self.on_each(hosts, lambda host: self.compose(host, "down", "--remove-orphans"))

    def do_without_multicast(self, mode: str, profiles: str = "robot") -> None:
        """Hosts that are down get the `.env` of a network without multicast."""
        met = {"GIRAFF_NETWORK_MODE": mode}
        self.write_env("robot", met | {"COMPOSE_PROFILES": profiles})
        for host in ("laptop", "desk"):
            self.write_env(host, met)

    def clear(self, host: str) -> None:
        """Remove its containers at once, where their end is not what is tested."""
        docker = self.machines[host].docker
        if names := docker("ps", "--all", "--quiet").split():
            docker("rm", "--force", *names)

    def reset_emergency_stop(self, host: str = "laptop") -> None:
        """Which is engaged after the robot's first start."""
        self.compose(host, "run", "--rm", "giraff", "estop", "reset")

    def listen(self, host: str, key: str, robot: str = NAME, network: Mapping[str, Any] | None = None) -> Listener:
        """`network`: fields of the table `[network]` on that host; none: as in its `.env` on an open network."""
        if network is None:
            network = {} if host == "robot" else {"connect": [address("robot")]}
        output = self.directory / f"{host}-{key.replace('/', '-')}-{time.monotonic_ns()}.jsonl"
        with output.open("wb") as out, output.with_suffix(".log").open("wb") as log:
            command = [sys.executable, str(_LISTENER), robot, key, json.dumps(network)]
            listener = Listener(self.machines[host].start(command, stdout=out, stderr=log), output)
        self._end.callback(listener.close)
        return listener

    def power_off(self, host: str) -> int:
        """The simulated us of it. Its cable is out before: the kernel of a host without power takes leave of nobody."""
        self.switch.unplug(self.machines[host])
        off_us = self.hardware.simulator.now()
        self.machines[host].power_off()
        return off_us

    def power_on(self, host: str, *, cable: bool = True) -> None:
        self._boot(self.machines[host], cable=cable)

    def mend(self) -> None:
        """All hosts on, all cables in, all boards plugged: what a test has broken, another does not find so."""
        for host, machine in self.machines.items():
            if not machine.is_on:
                self.power_on(host)
                self.wait_until_healthy(host)
            self.switch.join(machine)
            self.switch.lose(machine, 0)
        self.hardware.plug(*BOARDS)

    def load(self, host: str, kind: str) -> None:
        """Give a host whose containers are down another kind's image; its power is off meanwhile."""
        self._images.build([kind])
        self._kinds[host] = (*self._kinds[host], kind)
        self.power_off(host)
        self._images.give(self.machines[host], self._kinds[host])
        self.power_on(host)
        self.machines[host].wait_for_docker()

    @contextmanager
    def simulation(self, host: str) -> Iterator[None]:
        """The host, which has that image, has a simulation's `.env` meanwhile; before and after it has no container."""
        self.clear(host)
        write_env(self.clone(host), "sim", {})
        try:
            yield
        finally:
            self.clear(host)
            self.write_env(host)

    def close(self) -> None:
        self._end.close()

    @staticmethod
    def on_each(hosts: Iterable[str], do: Callable[[str], Any]) -> dict[str, Any]:
        """On all of them at once; what each gave."""
        names = list(hosts)
        with ThreadPoolExecutor(len(names)) as pool:
            return dict(zip(names, pool.map(do, names), strict=True))

    def _remove_directory(self) -> None:
        while self.directory.is_mount():
            run(["umount", "--lazy", str(self.directory)])
        shutil.rmtree(self.directory, ignore_errors=True)

    def _folder(self, name: str) -> Path:
        folder = self.directory / name
        folder.mkdir()
        return folder

    def _boot(self, machine: Machine, *, cable: bool = True) -> None:
        machine.power_on()
        self.switch.plug(machine, NUMBERS[machine.name])
        if not cable:
            self.switch.unplug(machine)
        machine.start_docker()


def address(host: str) -> str:
    return f"{NETWORK}.{NUMBERS[host]}"

"""A robot of processes at one site and its joystick's at another, or at the same, also with a router between them."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, Final

from giraff_core.estop.latch import RELEASED
from giraff_node.process.state import write_latch
from giraff_sim.board import ROOT
from giraff_sim.bodies.wheels.body import KNOWN
from giraff_sim.control.client import SimulatorClient
from tests.support.behind_router import BehindRouter
from tests.support.elsewhere import clean
from tests.support.process_robot import FULL_TILT, PATIENCE, PROVING_ROOM
from tests.support.sites import OWN_SOCKETS, ROUTER, Sites
from tests.support.waiting import wait

_ROBOT_FILE: Final = (ROOT / "deploy" / "robot.toml").read_text()
_HOSTS: Final = {
    "robot": ("base,ranger", ("door", "base", "guard", "ranger", "odometry")),
    "operator": ("joystick", ("joystick",)),
}
"""Host -> boards, services."""

HOME, AWAY = "home", "away"
ROBOT = "sim-remote"
ACCESS: dict[str, Any] = {
    "robot": ["robot-pc"],
    "operators": {"laptop": ["joystick"]},
    "viewers": ["desk"],
    "routers": [ROUTER],
}
"""Behind a router: the robot at home, its laptop and a desk away."""

Faults = dict[str, tuple[Callable[[], None], Callable[[], None]]]


class RemoteRobot:
    """`robot`, `operator`: the site and the robot file's table `[network]` of their services."""

    def __init__(self, directory: Path, name: str, sites: Sites, robot: tuple[str, Path], operator: tuple[str, Path]):
        self._directory = directory
        self._sites = sites
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._name = name
        (directory / "world.toml").write_text(PROVING_ROOM)
        write_latch(directory, RELEASED)
        with ExitStack() as end:
            end.callback(self._stop_all)
            self.simulator = end.enter_context(self._start_host("robot", *robot))
            self._hand = end.enter_context(self._start_host("operator", *operator))
            self._end = end.pop_all()

    def tilt(self, x: float) -> None:
        """The hand's tilt forward, m/s²."""
        self._hand.tilt(x, 0.0)

    def drives(self) -> bool:
        says = self.simulator.state().base
        return says is not None and (says.left_pwm_counts != 0 or says.right_pwm_counts != 0)

    def drive(self, seconds: float = PATIENCE) -> float:
        """Level, then tilt, again and again as a person would, until the wheels turn. The wall seconds it took."""
        began = time.monotonic()
        while True:
            self.tilt(0.0)
            time.sleep(1.0)
            self.tilt(FULL_TILT)
            tilted_until = time.monotonic() + 1.0
            while time.monotonic() < tilted_until:
                if self.drives():
                    return time.monotonic() - began
                time.sleep(0.01)
            assert time.monotonic() - began < seconds, f"does not drive within {seconds:g} s{self._last_words()}"

    def run(self, seconds: float) -> None:
        """Let simulated time pass."""
        until = self.simulator.now() + seconds * 1e6
        self.wait("the simulator's time", lambda: self.simulator.now() >= until)

    def wait(self, what: str, holds: Callable[[], bool]) -> float:
        """Wait until `holds`; the wall seconds that took. AssertionError with the logs' ends."""
        return wait(holds, PATIENCE, what=lambda: f"{what}{self._last_words()}", every=0.01)

    def says(self, service: str) -> str:
        """Its log so far."""
        return (self._directory / f"{service}.log").read_text()

    def close(self) -> None:
        self._end.close()

    def _stop_all(self) -> None:
        for process in self._processes.values():
            process.terminate()
        codes: dict[str, int] = {}
        for name, process in self._processes.items():
            try:
                codes[name] = process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                process.kill()
                codes[name] = process.wait()
        assert set(codes.values()) <= {0}, f"{codes}{self._last_words()}"

    def _start_host(self, host: str, site: str, network: Path) -> SimulatorClient:
        boards, services = _HOSTS[host]
        ports = self._directory / host
        control, file = self._directory / f"{host}.control", self._directory / f"{host}.toml"
        stock, rest = _ROBOT_FILE.split("[network]")
        file.write_text(stock + network.read_text(encoding="utf-8") + rest.partition("\n\n")[2])
        environment = {
            **clean(dict(os.environ)),
            **KNOWN,
            **OWN_SOCKETS,
            "GIRAFF_CONFIG": str(file),
            "GIRAFF_ROBOT_NAME": self._name,
            "GIRAFF_BASE_DRIVE__BATTERY_VOLTS_PER_COUNT": "0.03",
            "STATE_DIRECTORY": str(self._directory),
            **{f"GIRAFF_{board.upper()}_PORT": str(ports / board) for board in ("joystick", "base", "ranger")},
        }
        world = str(self._directory / "world.toml")
        words = ["--ports", str(ports), "--control", str(control), "--world", world, "--seed", "1", "--hand", "still"]
        self._start(f"{host}-sim", site, environment, "giraff_sim", *words, "--boards", "host", "--only", boards)

        def is_ready() -> bool:
            assert self._processes[f"{host}-sim"].poll() is None, f"{host}-sim has ended{self._last_words()}"
            return control.exists()

        self.wait(f"the simulator of {host}", is_ready)
        for service in services:
            self._start(service, site, environment, "giraff_node", service)
        return SimulatorClient(control, timeout=PATIENCE)

    def _start(self, name: str, site: str, environment: dict[str, str], module: str, *words: str) -> None:
        command = self._sites.command(site, sys.executable, "-P", "-m", module, *words)
        with (self._directory / f"{name}.log").open("wb") as log:
            self._processes[name] = subprocess.Popen(
                command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=log
            )

    def _last_words(self) -> str:
        return "".join(f"\n{path.name}: {path.read_text()[-600:]}" for path in self._directory.glob("*.log"))


class Stage:
    """The robot at home, its laptop away, and what can happen to the way between them."""

    def __init__(self, directory: Path, sites: Sites, end: ExitStack) -> None:
        self.behind = BehindRouter(directory, sites, (HOME, AWAY), {ROBOT: ACCESS})
        end.callback(self.behind.close)
        for host, site in (("robot-pc", HOME), ("laptop", AWAY), ("desk", AWAY)):
            self.behind.certify(host, sites.address(site))
        self.behind.start_router()
        at_home, away = (
            (site, self.behind.robot_file(host, site, ROBOT)) for host, site in (("robot-pc", HOME), ("laptop", AWAY))
        )
        (directory / "robot").mkdir()
        self.robot = RemoteRobot(directory / "robot", ROBOT, sites, at_home, away)
        end.callback(self.robot.close)
        self.faults: Faults = {
            "the router is killed": (self.behind.kill_router, self.behind.start_router),
            "the operator's cable is pulled": (lambda: sites.pull(AWAY), lambda: sites.plug(AWAY)),
        }


@contextmanager
def remote_stage(directory: Path) -> Iterator[Stage]:
    with Sites(HOME, AWAY) as sites, ExitStack() as end:
        yield Stage(directory, sites, end)

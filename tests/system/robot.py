"""The whole robot as it really runs: simulator and services as processes of their own, on a loopback of their own."""

from __future__ import annotations

import json
import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from giraff_cli.children import Children
from giraff_cli.watcher import free_port
from giraff_sim.board import ROOT
from giraff_sim.client import SimulatorClient

SERVICES = ("base", "guard", "joystick", "ranger", "odometry")
FULL_TILT = 7.5
"""m/s² along one axis: more than the default curve's full speed needs."""

EMPTY_ROOM = """
name = "empty"
start = { x = 0.0, y = 0.0, yaw_deg = 0.0 }
"""


class ProcessRobot:
    """Starts, kills and watches the processes; the world is the simulator's control socket."""

    def __init__(self, directory: Path, world: Path, boards: str) -> None:
        self.directory = directory
        self.ports = directory / "ports"
        self.environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")},
            "GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"),
            "GIRAFF_ROBOT_NAME": "sim-test",
            "GIRAFF_NETWORK_RENDEZVOUS": f"127.0.0.1:{free_port()}",
            "GIRAFF_NETWORK_LOCAL": "true",
            **{f"GIRAFF_{name.upper()}_PORT": str(self.ports / name) for name in ("joystick", "base", "ranger")},
        }
        self._children = Children(directory)
        control = directory / "control"
        arguments = ["--ports", str(self.ports), "--control", str(control), "--world", str(world)]
        arguments += ["--seed", "1", "--boards", boards, "--hand", "still"]
        self._children.start("simulator", "giraff_sim", arguments, self.environment)
        self.wait("the simulator", lambda: b"\n" in self._children.output("simulator").read_bytes(), 20.0)
        self.simulator = SimulatorClient(control)

    def start(self, service: str) -> None:
        self._children.start(service, f"giraff_{service}", (), self.environment)

    def pid(self, service: str) -> int:
        return self._children.pid(service)

    def signal(self, service: str, number: int) -> None:
        os.kill(self.pid(service), number)

    def kill(self, service: str) -> None:
        """SIGKILL, and wait until it is gone."""
        self.signal(service, signal.SIGKILL)
        self.wait(f"the end of {service}", lambda: bool(self._children.reap()), 5.0)

    def log(self, service: str) -> str:
        return self._children.log(service).read_text()

    def messages(self, service: str) -> list[str]:
        """What a service has logged."""
        return [json.loads(line)["message"] for line in self.log(service).splitlines()]

    def wait(self, what: str, holds: Callable[[], bool], seconds: float) -> float:
        """Wait until `holds`; the wall seconds that took. AssertionError with the logs' ends after `seconds`."""
        began = time.monotonic()
        while not holds():
            if time.monotonic() - began > seconds:
                logs = "".join(f"\n{path.name}: {path.read_text()[-600:]}" for path in self.directory.glob("*.log"))
                raise AssertionError(f"{what}: not within {seconds:g} s{logs}")
            time.sleep(0.01)
        return time.monotonic() - began

    def run(self, seconds: float) -> None:
        """Let simulated time pass."""
        until = self.simulator.now() + seconds * 1e6
        self.wait("the simulator's time", lambda: self.simulator.now() >= until, 20.0 + 4.0 * seconds)

    def accepted(self) -> int:
        """Drive frames the base board has accepted."""
        says = self.simulator.state().base
        return says.accepted if says else 0

    def drives(self) -> bool:
        says = self.simulator.state().base
        return says is not None and (says.left_pwm_counts != 0 or says.right_pwm_counts != 0)

    def drive_forward(self) -> None:
        """Arm by a level hand, then tilt until the wheels turn at full speed."""
        self.simulator.tilt(0.0, 0.0)
        self.run(2.0)
        self.simulator.tilt(FULL_TILT, 0.0)
        self.wait("driving", self.drives, 10.0)
        self.run(1.5)

    def close(self) -> None:
        self.simulator.close()
        troubles = self._children.stop_all(grace=5.0)
        assert not troubles, troubles


@contextmanager
def process_robot(directory: Path, world: str = EMPTY_ROOM, boards: str = "avr") -> Iterator[ProcessRobot]:
    """A robot with all its services; they end with the block."""
    path = directory / "world.toml"
    path.write_text(world)
    robot = ProcessRobot(directory, path, boards)
    try:
        for service in SERVICES:
            robot.start(service)
        robot.wait("the first accepted drive frame", lambda: robot.accepted() > 0, 20.0)
        yield robot
    finally:
        robot.close()

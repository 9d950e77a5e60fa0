"""The robot and the joystick as things: one simulated world with the three boards, whose cables end in /dev."""

import os
import shutil
import time
from pathlib import Path
from typing import Final

from giraff_cli.run.processes import ProcessGroup
from giraff_sim.board import ROOT
from giraff_sim.bodies.wheels.body import KNOWN
from giraff_sim.control.client import SimulatorClient
from giraff_sim.control.messages import BoardName
from tests.hosts.machine import LabError, let_first
from tests.support.process_robot import FULL_TILT, PROVING_ROOM
from tests.support.waiting import wait

PORTS: Final = Path("/dev/giraff-hosts")
"""As udev's rules have it for real boards: of the host's folders, containers see /dev alone."""
BOARDS: Final[tuple[BoardName, ...]] = ("base", "joystick", "ranger")
DIALOUT: Final = 20
ROBOT: Final = KNOWN
"""What a technician has found out about this robot."""

_START: Final = (-3.0, 0.0)
"""m; from there it is ten seconds to the wall."""
_READY_WITHIN: Final = 60.0  # s
_PATIENCE: Final = 60.0  # s


class Hardware:
    """Runs on no machine of the lab: whatever happens to those, the boards go on, and their record is the judge."""

    def __init__(self, directory: Path, ports: Path = PORTS) -> None:
        self._processes = ProcessGroup(directory)
        self._ports = ports
        shutil.rmtree(ports, ignore_errors=True)  # of a lab that was killed
        world = directory / "world.toml"
        world.write_text(PROVING_ROOM)
        control = directory / "control"
        arguments = ["--ports", str(ports), "--control", str(control), "--world", str(world)]
        arguments += ["--seed", "1", "--boards", "host", "--hand", "still"]
        environment = os.environ | ROBOT | {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml")}
        self._processes.start("simulator", "giraff_sim", arguments, environment)
        let_first(self._processes.pid("simulator"))
        deadline = time.monotonic() + _READY_WITHIN
        while b"\n" not in self._processes.output("simulator").read_bytes():
            if self._processes.reap() or time.monotonic() > deadline:
                raise LabError(f"no simulator: {self._processes.log('simulator').read_text()}")
            time.sleep(0.01)
        self.simulator = SimulatorClient(control)
        for board in BOARDS:
            permit(ports / board)

    def unplug(self, *boards: BoardName) -> None:
        for board in boards:
            self.simulator.unplug(board)

    def plug(self, *boards: BoardName) -> None:
        for board in boards:
            self.simulator.plug(board)
            permit(self._ports / board)

    def run(self, seconds: float) -> None:
        """Let simulated time pass."""
        until_us = self.simulator.now() + seconds * 1e6
        wait(lambda: self.simulator.now() >= until_us, _PATIENCE, what="the simulator's time")

    def drives(self) -> bool:
        """Whether the motors are given anything now."""
        state = self.simulator.state()
        return state.base is not None and bool(state.base.left_pwm_counts or state.base.right_pwm_counts)

    def last_driven(self, since_us: int) -> float | None:
        """s after `since_us` that the motors were last given anything; None: never since."""
        verdict = self.simulator.record(since_us)
        return None if verdict.last_driven_us is None else (verdict.last_driven_us - since_us) * 1e-6

    def drive(self, within: float = _PATIENCE) -> float:
        """What an operator does who wants to drive: level, then forward, and again until it does. s that it took.

        On a busy machine each attempt is longer than the one before.
        """
        began = time.monotonic()
        while True:
            longer = (time.monotonic() - began) / 20
            self.simulator.tilt(0.0, 0.0)
            time.sleep(0.6 + longer)
            self.simulator.place(*_START)
            self.simulator.tilt(FULL_TILT, 0.0)
            until = time.monotonic() + 1.0 + longer
            while time.monotonic() < until:
                if self.drives():
                    return time.monotonic() - began
                time.sleep(0.01)
            waited = time.monotonic() - began
            assert waited < within, f"a tilted joystick does not turn the wheels within {within:g} s"

    def close(self) -> None:
        self.simulator.close()
        troubles = self._processes.stop_all(grace=5.0)
        shutil.rmtree(self._ports, ignore_errors=True)
        assert not troubles, troubles


def permit(port: Path) -> None:
    """Give a port to the group dialout, as udev's rule does."""
    device = os.path.realpath(port)
    os.chown(device, 0, DIALOUT)
    Path(device).chmod(0o660)

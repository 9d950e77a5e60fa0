"""The simulated robot of a run: the simulator, the services, on its serial ports, and the world's truth."""

import os
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import msgspec

from giraff_cli.run.demonstration import JoystickHold
from giraff_cli.run.page import ROOM_FILE, Page, write_room
from giraff_cli.run.plan import Plan
from giraff_cli.run.processes import Driver, Ended, ProcessGroup
from giraff_cli.run.telemetry import Truth
from giraff_core.estop.latch import RELEASED
from giraff_core.kinematics.pose import Pose
from giraff_node import robot_now_ns
from giraff_node.process.state import write_latch
from giraff_schemas.services import DOOR, WEB
from giraff_schemas.text import plain
from giraff_sim.control.client import SimulatorClient, SimulatorError
from giraff_sim.truth import Truth as Drawn
from giraff_sim.world.room import read_room
from giraff_tools.terminal.signals import StopSignal

SIMULATOR: Final = "simulator"
_CAMERA: Final = "simulated-camera"

_PUSH: Final = 5.0  # N s
_READY_WITHIN: Final = 20.0  # s
_ASK_AGAIN: Final = 0.02  # s
_GRACE: Final = 3.0  # s; a service's own end is bounded at about one
_LONGEST_SOCKET_PATH: Final = 107  # bytes that Linux takes


class StartError(Exception):
    """The run cannot begin. The message says why."""


class _Ready(msgspec.Struct):
    """What the simulator prints when its ports are there."""

    ready: bool
    ports: dict[str, str]


class SimulatedRobot:
    """Its processes end with the one that made it, however that ends."""

    def __init__(self, plan: Plan, rendezvous: str, directory: Path) -> None:
        """`directory` takes ports, control socket, state and logs."""
        self._plan = plan
        self._rendezvous = rendezvous
        self._directory = directory
        self._pictures = directory / "camera.sock"
        self._environment = plan.environment | {
            "GIRAFF_NETWORK_RENDEZVOUS": rendezvous,
            "GIRAFF_LOCALIZATION_MAP": str(plan.world),  # whatever map the robot file names
            "GIRAFF_CAMERA_DEVICE": str(self._pictures),
            "GIRAFF_VISION_CAMERA": plan.camera,
            "GIRAFF_WEB_ROOM": str(directory / ROOM_FILE),
        }
        self._control = directory / "control"
        self._processes = ProcessGroup(directory)
        self._client: SimulatorClient | None = None
        self.drawn: Drawn | None = None
        """How this robot differs from its file; None before it is there."""
        self.page: Page | None = None
        if WEB.name in plan.services:
            everywhere = not plan.environment["GIRAFF_WEB_ADDRESS"]
            self.page = Page(self._processes.log(WEB.name), everywhere=everywhere)

    def start_simulator(self, stopping: StopSignal) -> bool:
        """Start boards and world; False when the end was asked for meanwhile. Raises StartError."""
        if len(os.fsencode(self._control)) > _LONGEST_SOCKET_PATH:
            raise StartError(f"{self._control}: too long for a socket's path; set TMPDIR to a shorter one")
        plan = self._plan
        arguments = {
            "--ports": self._directory / "ports",
            "--control": self._control,
            "--world": plan.world,
            "--seed": plan.options.seed,
            "--truth": plan.options.truth,
            "--boards": plan.boards,
            "--hand": plan.hand,
        }
        self._start(DOOR.name)  # it is there when the others look for it
        self._processes.start(SIMULATOR, "giraff_sim", _words(arguments), plan.environment)
        deadline = time.monotonic() + _READY_WITHIN
        while (ready := self._ready()) is None:
            for ended in self._processes.reap():
                raise StartError(str(ended))
            if time.monotonic() > deadline:
                said = "\n    ".join(self._processes.last_words(SIMULATOR))
                raise StartError(f"the simulator is not ready after {_READY_WITHIN:g} s; its log ends:\n    {said}")
            if stopping.wait(_ASK_AGAIN):
                return False
        self._client = SimulatorClient(self._control)
        self.drawn = self._client.truth()
        self._start_services(ready.ports)
        return True

    def _start_services(self, ports: dict[str, str]) -> None:
        self._environment |= {f"GIRAFF_{name.upper()}_PORT": port for name, port in ports.items()}
        write_latch(self._directory / "state", RELEASED)  # nobody can be hurt by a robot that is none
        if self.page is not None:
            write_room(read_room(self._plan.world), self._directory / ROOM_FILE)
        if self._plan.camera:
            arguments = {"--control": self._control, "--at": self._pictures, "--seed": self._plan.options.seed}
            self._processes.start(_CAMERA, "giraff_sim.camera", _words(arguments), self._environment)
        for service in self._plan.services:
            if service != DOOR.name:
                self._start(service)

    def _start(self, service: str) -> None:
        own = {"STATE_DIRECTORY": str(self._directory / "state")}
        if service == WEB.name:  # a phone that trusts the page once does so in the next run, too
            own = {}
        self._processes.start(service, "giraff_node", [service], self._environment | own)

    def truth(self) -> Truth:
        """The robot as the world has it now. Raises SimulatorError."""
        client = self._connected()
        before = robot_now_ns()
        state = client.state()
        return Truth(
            robot_ns=(before + robot_now_ns()) // 2,
            simulated_us=state.now_us,
            pose=Pose(state.x, state.y, state.yaw),
            speed=state.speed,
            turn=state.turn,
            path=state.path_length,
            closest=state.closest,
            contacts=state.contacts,
            balance=state.balance,
            drawn=state.drawn,
        )

    def push(self) -> None:
        """Push a robot that balances, as a person does who bumps into it. Raises SimulatorError."""
        self._connected().push(_PUSH)

    def drain(self, volts: float) -> None:
        """Have the battery run down to `volts`. Raises SimulatorError."""
        self._connected().battery(volts)

    def hold_joystick(self, grip: JoystickHold) -> None:
        """Raises SimulatorError."""
        client = self._connected()
        client.hand(self._plan.hand if grip.drives else "still")
        client.button(pressed=grip.presses)

    def start_driver(self) -> Driver:
        """`giraff drive` for this robot, in the terminal of this process."""
        environment = self._plan.environment | {"GIRAFF_NETWORK_RENDEZVOUS": self._rendezvous}
        robot = ["--robot", self._plan.robot.name, "--connect", self._rendezvous]
        return Driver([sys.executable, "-P", "-m", "giraff_cli", "drive", *robot], environment)

    def reap(self) -> list[Ended]:
        """The processes that have ended by themselves since the last call."""
        return self._processes.reap()

    @property
    def ended(self) -> dict[str, Ended]:
        """All that have, by name."""
        return self._processes.ended

    def stop(self) -> list[str]:
        """End the services, then the simulator. Bounded. Returns what went wrong."""
        troubles = self._processes.stop((*self._plan.services, _CAMERA), _GRACE)
        if self._client is not None:
            self._client.close()
        return troubles + self._processes.stop([SIMULATOR], _GRACE)

    def _ready(self) -> _Ready | None:
        line, end, _ = self._processes.output(SIMULATOR).read_bytes().partition(b"\n")
        if not end:
            return None
        try:
            return msgspec.json.decode(line, type=_Ready)
        except msgspec.DecodeError as error:
            raise StartError(f"the simulator said {line!r} where its ready line belongs: {plain(error)}") from error

    def _connected(self) -> SimulatorClient:
        if self._client is None:
            raise SimulatorError("the simulator has not been started")
        return self._client


def _words(options: Mapping[str, object]) -> list[str]:
    return [str(part) for pair in options.items() for part in pair]

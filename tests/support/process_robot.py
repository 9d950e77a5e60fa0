"""The whole robot as it really runs: simulator and services as processes of their own, on a loopback of their own."""

import json
import math
import os
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, Final

from giraff_cli.run.processes import ProcessGroup
from giraff_core.estop.latch import RELEASED
from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import load
from giraff_node.network.session import session_config
from giraff_node.process.state import write_latch
from giraff_schemas import services as table
from giraff_schemas.topics import ATTITUDE, BASE, GUARD, LEASE
from giraff_sim.board import ROOT
from giraff_sim.bodies.wheels.body import KNOWN
from giraff_sim.control.client import SimulatorClient
from giraff_sim.truth import Level
from giraff_tools.network.ports import free_port
from tests.support.cable import Cable
from tests.support.observer import Observer
from tests.support.waiting import wait
from tests.support.zygote import run_giraff

SERVICES = ("base", "guard", "joystick", "ranger", "odometry")
FULL_TILT = 7.5
"""m/s² along one axis: more than the default curve's full speed needs."""

PROVING_ROOM = """
name = "proving"
start = { x = 0.0, y = 0.0, yaw_deg = 0.0 }

[[walls]]
name = "room"
points = [[4.0, 4.0], [-4.0, 4.0], [-4.0, -4.0], [4.0, -4.0]]
closed = true
"""
"""Walls near enough for each sensor to prove that it hears: in an empty room the guard only lets the robot creep."""

_RADIUS, _CORNERS = 4.0, 36
ARENA: Final = f"""
name = "arena"
start = {{ x = 0.0, y = 0.0, yaw_deg = 0.0 }}
[[walls]]
name = "round"
closed = true
points = [{
    ", ".join(
        f"[{_RADIUS * math.cos(math.tau * k / _CORNERS):.4f}, {_RADIUS * math.sin(math.tau * k / _CORNERS):.4f}]"
        for k in range(_CORNERS)
    )
}]
"""
"""A round room: from its middle every sensor hears the wall, wherever the robot looks."""

SAID: Final = frozenset(
    topic.key
    for service in table.SERVICES
    if service.name in SERVICES
    for topic in service.publishes
    if "*" not in topic.key and topic is not ATTITUDE
)
"""Keys of one name that the robot's parts and its joystick say, where it stands on two wheels by itself."""
BRIEF: Final = 0.3
"""s of a drive that shows no more than that it drives."""
PATIENCE: Final = 60.0
"""s for whatever comes about: a wait ends at once when it does, and a busy machine is slow."""
_LEVEL: Final = 1.5
"""s of a level hand, that arms within 0.4 s where nothing is wrong."""
_RELEASED: Final = 10.0
"""s within which a robot arms whose emergency stop is reset."""


class ProcessRobot:
    """Starts, kills and watches the processes; the world is the simulator's control socket."""

    def __init__(
        self,
        directory: Path,
        world: Path,
        boards: str,
        truth: Level = "calibrated",
        *,
        apart: bool = False,
        parts: Mapping[str, str] | None = None,
    ) -> None:
        """`truth`: how far it differs from its file; `apart`: the operator's side is another host, behind `cables`.

        `parts`: variables of more than its file has.

        One that does not come about leaves nothing open, and says why.
        """
        self.directory = directory
        self.cables: list[Cable] = []
        self._session_files: dict[str, Path] = {}
        self.ports = directory / "ports"
        self.state = directory / "state"
        write_latch(self.state, RELEASED)
        self.environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("GIRAFF_")},
            **KNOWN,
            "GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml"),
            "GIRAFF_ROBOT_NAME": "sim-test",
            "GIRAFF_NETWORK_RENDEZVOUS": f"127.0.0.1:{free_port()}",
            "GIRAFF_NETWORK_LOCAL": "true",
            "GIRAFF_BASE_DRIVE__BATTERY_VOLTS_PER_COUNT": "0.03",
            "GIRAFF_ROBOT_FRAMES": "{ laser = { x = -0.115, z = 0.226, pitch = 0.1 } }",
            "STATE_DIRECTORY": str(self.state),
            **(parts or {}),
            **{f"GIRAFF_{name.upper()}_PORT": str(self.ports / name) for name in ("joystick", "base", "ranger")},
        }
        self._processes = ProcessGroup(directory)
        with ExitStack() as end:
            if apart:
                self._set_apart(end)
            end.callback(self._stop_all)
            self.observer = Observer(self.environment)
            end.callback(self.observer.close)
            for topic in (BASE, GUARD, LEASE):
                self.observer.follow(topic)
            words = ["--world", str(world), "--seed", "1", "--truth", truth, "--boards", boards]
            self.simulator = self._start_simulator("simulator", directory, words)
            end.callback(self.simulator.close)
            self._end = end.pop_all()

    def start(self, service: str) -> None:
        self._processes.start(service, "giraff_node", (service,), self._apart(service))

    def _apart(self, service: str) -> dict[str, str]:
        """The environment of whatever runs where this service does."""
        environment = dict(self.environment)
        if service in self._session_files:
            environment["GIRAFF_NETWORK_SESSION_FILE"] = str(self._session_files[service])
        return environment

    def start_second(self, service: str, **changes: str) -> None:
        """Another process of a service beside the first, "second SERVICE", that has joined the network."""
        name = f"second {service}"
        self._processes.start(name, "giraff_node", (service,), self.environment | changes)
        self.wait(f"a {name}", lambda: "robot sim-test" in self.log(name), PATIENCE)

    def start_second_hand(self) -> SimulatorClient:
        """Another joystick board in another hand, and a second joystick service on it."""
        words = ["--world", str(self.directory / "world.toml"), "--only", "joystick", "--boards", "host"]
        other = self._start_simulator("second simulator", self.directory / "second", words)
        ports = self.directory / "second" / "ports"
        self.start_second("joystick", GIRAFF_JOYSTICK_PORT=str(ports / "joystick"))
        return other

    def _start_simulator(self, name: str, directory: Path, words: list[str]) -> SimulatorClient:
        """Its ports and its control socket are in `directory`."""
        directory.mkdir(exist_ok=True)
        control = directory / "control"
        words = ["--ports", str(directory / "ports"), "--control", str(control), *words, "--hand", "still"]
        self._processes.start(name, "giraff_sim", words, self.environment)

        def is_ready() -> bool:
            self.require_all()
            return b"\n" in self._processes.output(name).read_bytes()

        self.wait(f"the {name}", is_ready, PATIENCE)
        return SimulatorClient(control, timeout=PATIENCE)

    def require_all(self) -> None:
        """None of the processes has ended by itself."""
        ended = self._processes.reap()
        assert not ended, "\n".join(map(str, ended))

    def giraff(self, *words: str) -> int:
        """Run the command line on the robot's host; its exit code."""
        done = run_giraff(words, Path.cwd(), self.environment, PATIENCE)
        with (self.directory / "giraff.log").open("a") as log:
            log.write(f"giraff {' '.join(words)}: {done.returncode}\n{done.stdout}{done.stderr}")
        return done.returncode

    def stop(self, service: str) -> None:
        """SIGTERM, and wait until it has ended well."""
        troubles = self._processes.stop([service], grace=PATIENCE)
        assert not troubles, troubles

    def pid(self, service: str) -> int:
        return self._processes.pid(service)

    def signal(self, service: str, number: int) -> None:
        os.kill(self.pid(service), number)

    def kill(self, service: str) -> None:
        """SIGKILL, and wait until it is gone."""
        self.signal(service, signal.SIGKILL)
        self.wait(f"the end of {service}", lambda: bool(self._processes.reap()), PATIENCE)

    def log(self, service: str) -> str:
        return self._processes.log(service).read_text()

    def messages(self, service: str) -> list[str]:
        """What a service has logged."""
        return [json.loads(line)["message"] for line in self.log(service).splitlines()]

    def wait(self, what: str, holds: Callable[[], object], seconds: float) -> float:
        """Wait until `holds`; the wall seconds that took. AssertionError with the logs' ends after `seconds`."""
        return wait(holds, seconds, what=lambda: f"{what}{self._last_words()}", every=0.04)

    def run(self, seconds: float) -> None:
        """Let simulated time pass."""
        until = self.simulator.now() + seconds * 1e6
        self.wait("the simulator's time", lambda: self.simulator.now() >= until, PATIENCE + 4.0 * seconds)

    def accepted(self) -> int:
        """Drive frames the base board has accepted."""
        says = self.simulator.state().base
        return says.accepted if says else 0

    def drives(self) -> bool:
        says = self.simulator.state().base
        return says is not None and (says.left_pwm_counts != 0 or says.right_pwm_counts != 0)

    def ranged(self) -> bool:
        """The guard has heard each sensor: a tilt before that relies on ranges that are not there, and disarms."""
        state = self.observer.newest(GUARD)
        return state is not None and not any("has not been heard" in str(why) for why in state.sensors.values())

    def wait_until_it_can_drive(self) -> None:
        """Its services were started, and do what they are for."""

        def is_sound() -> bool:
            self.require_all()
            return self.accepted() > 0 and self.ranged()

        self.wait("the first accepted drive frame and the first ranges at the guard", is_sound, PATIENCE)

    def hold(self, x: float, y: float) -> int:
        """Hold the joystick so that its sensor feels this, m/s². The simulated us."""
        return self.simulator.tilt(x, y)

    def why(self) -> str:
        """What base and guard say about why the robot does not do what is asked."""
        base, guard = self.observer.newest(BASE), self.observer.newest(GUARD)
        return f"base: {base and base.reason!r}; guard: {guard and guard.reason!r}"

    def ready(self) -> bool:
        """Armed, and standing: it would drive at the next tilt."""
        state = self.observer.newest(BASE)
        return state is not None and state.armed and not state.driving and state.board.drive_state == "active"

    def arm(self, seconds: float = PATIENCE) -> float:
        """What an operator does who wants to drive: level, and where that does not do, a tilt to ask and level again.

        Returns the wall seconds it took.
        """
        began = time.monotonic()
        while True:
            self.hold(0.0, 0.0)
            level_until = time.monotonic() + _LEVEL
            while time.monotonic() < level_until:
                if self.ready():
                    return time.monotonic() - began
                time.sleep(0.01)
            waited = time.monotonic() - began
            assert waited < seconds, f"not armed within {seconds:g} s{self._last_words()}"
            self.hold(FULL_TILT, 0.0)
            self.run(0.3)

    def release(self) -> None:
        """Reset the emergency stop and arm, as a person does.

        All over again where this machine stood still before the board knew of the reset: base takes what the board
        kept for a new stop.
        """
        began = time.monotonic()
        while True:
            assert self.giraff("estop", "reset", "--timeout", "30") == 0, "not reset; see giraff.log"
            try:
                self.arm(_RELEASED)
                return
            except AssertionError:
                if time.monotonic() - began > PATIENCE:
                    raise

    def drive(self, x: float, y: float, seconds: float = 1.5) -> None:
        """Arm by a level hand, then tilt until the wheels have turned for `seconds`: at full speed, after a second.

        Where a machine that stood still has stopped the robot meanwhile, all over again, as a person would.
        """
        began = time.monotonic()
        while True:
            self.arm()
            self.hold(x, y)
            tilted_until = time.monotonic() + _LEVEL
            while not self.drives() and time.monotonic() < tilted_until:
                time.sleep(0.01)
            if self.drives():
                self.run(seconds)
                if self.drives():
                    return
            assert time.monotonic() - began < PATIENCE, f"does not drive for {seconds:g} s{self._last_words()}"

    def drive_forward(self, seconds: float = 1.5) -> None:
        self.drive(FULL_TILT, 0.0, seconds)

    def move_forward(self, seconds: float) -> None:
        """Have `giraff move`, "requester", move the robot, for so long by the simulator's time so far.

        It is where the joystick was, which has ended: what lies still on a desk has the robot for half a minute.
        """
        self.stop("joystick")
        self.wait("a robot that nobody has", self._is_free, PATIENCE)
        name = self.environment["GIRAFF_ROBOT_NAME"]
        self._processes.start(
            "requester", "giraff_cli", ("move", "3", "--speed", "0.5", "--robot", name), self._apart("joystick")
        )
        self.wait("a motion", self.drives, PATIENCE)
        self.run(seconds)
        assert self.drives(), f"it does not move for {seconds:g} s{self._last_words()}"

    def end_motion(self) -> None:
        """Whether or not that has ended by itself, the joystick is there again."""
        self._processes.stop(["requester"], grace=PATIENCE)
        self.start("joystick")

    def _is_free(self) -> bool:
        lease = self.observer.newest(LEASE)
        return lease is not None and not lease.operator

    def put_up_wall(self, name: str, ahead: float, half_width: float) -> int:
        """A wall square to the robot's heading, `ahead` m from its centre; the simulator's moment (us) of it."""
        at = self.simulator.state()
        x, y = at.x + ahead * math.cos(at.yaw), at.y + ahead * math.sin(at.yaw)
        along = (-half_width * math.sin(at.yaw), half_width * math.cos(at.yaw))
        return self.simulator.add_wall(name, [(x + along[0], y + along[1]), (x - along[0], y - along[1])])

    def close(self) -> None:
        self._end.close()

    def _stop_all(self) -> None:
        troubles = self._processes.stop_all(grace=PATIENCE)
        assert not troubles, troubles

    def _last_words(self) -> str:
        logs = "".join(f"\n{path.name}: {path.read_text()[-600:]}" for path in self.directory.glob("*.log"))
        return f"\n{self.why()}{logs}"

    def _set_apart(self, end: ExitStack) -> None:
        """Let the joystick reach base, guard and motion through a cable each, and nothing else."""
        network = load("network", NetworkConfig, self.environment)
        name = self.environment["GIRAFF_ROBOT_NAME"]
        operators = session_config(network, name, "outside")
        operators["transport"]["link"]["protocols"] = ["tcp"]
        operators["listen"]["endpoints"] = []
        operators["connect"]["endpoints"] = []
        del operators["id"]  # another one each time it starts
        operators["scouting"]["gossip"] = {"enabled": False}  # it would tell the others' own ports
        for service in ("base", "guard", "motion"):
            port = free_port()
            self.cables.append(end.enter_context(Cable(free_port(), port)))
            settings = session_config(network, name, "inside")
            settings["listen"]["endpoints"].append(f"tcp/127.0.0.1:{port}")
            self._write_session(service, settings)
            operators["connect"]["endpoints"].append(f"tcp/127.0.0.1:{self.cables[-1].port}")
        self._write_session("joystick", operators)

    def _write_session(self, service: str, settings: dict[str, Any]) -> None:
        self._session_files[service] = self.directory / f"{service}.session.json5"
        self._session_files[service].write_text(json.dumps(settings))


@contextmanager
def process_robot(
    directory: Path,
    world: str = PROVING_ROOM,
    boards: str = "avr",
    truth: Level = "calibrated",
    *,
    apart: bool = False,
    parts: Mapping[str, str] | None = None,
) -> Iterator[ProcessRobot]:
    """A robot with all its services; they end with the block. `apart`: the operator is on another host."""
    path = directory / "world.toml"
    path.write_text(world)
    robot = ProcessRobot(directory, path, boards, truth, apart=apart, parts=parts)
    try:
        for service in SERVICES:
            robot.start(service)
        robot.wait_until_it_can_drive()
        yield robot
    finally:
        robot.close()

"""A run of the simulated robot: its services as processes, watched from the network.

The order matters. Services start when the simulator is ready, end before it, and the run is judged, with the robot at
rest, before anything is told to end.
"""

import contextlib
import math
import secrets
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

from giraff_cli.run.announcer import Announcer
from giraff_cli.run.demonstration import DRIVES, FLAT, Demonstration
from giraff_cli.run.page import CODE_KEY
from giraff_cli.run.plan import Plan
from giraff_cli.run.processes import Driver, Ended
from giraff_cli.run.screen import Frame, RunView
from giraff_cli.run.simulated_robot import SIMULATOR, SimulatedRobot, StartError
from giraff_cli.run.summary import summarize, to_json, to_text
from giraff_cli.run.telemetry import RunTelemetry
from giraff_node import robot_now_ns
from giraff_node.network.query_client import EStopClient, QueryClient, request_estop
from giraff_node.process.state import write_file_durably
from giraff_schemas.localization import LocalizationAnswer, LocalizationSetPose
from giraff_schemas.messages import Sample
from giraff_schemas.services import DEMONSTRATION, LOCALIZATION, WEB
from giraff_schemas.text import printable_lines
from giraff_schemas.topics import LEASE, LOCALIZATION_SET_POSE, POSE, TOPICS, TRUE_POSE, Topic
from giraff_sim.control.client import SimulatorError
from giraff_sim.world.room import read_room
from giraff_telemetry.layout import ServiceStatus
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal import addresses
from giraff_tools.terminal.keys import Keys
from giraff_tools.terminal.screen import LineScreen, NullScreen, Screen, Terminal, as_svg, open_screen, say
from giraff_tools.terminal.signals import StopSignal


class Joystick:
    """Holds the joystick of a run: by the demonstration as long as nobody else drives. Times are monotonic, s."""

    def __init__(self, robot: SimulatedRobot, *, is_driven: bool) -> None:
        """`is_driven`: by the demonstration; else it lies flat all the time."""
        self._robot = robot
        self._demonstration = Demonstration()
        self._grip = DRIVES if is_driven else FLAT
        if not is_driven:
            self._demonstration.end()

    @property
    def note(self) -> str:
        """What a person is told of it; empty: nothing."""
        return self._demonstration.note

    def on_sample(self, sample: Sample, now: float) -> None:
        """Take anything that is heard of the robot."""
        self._demonstration.on_sample(sample, now)

    def hold(self, now: float) -> None:
        """Have it held as is due now. Raises SimulatorError."""
        grip = self._demonstration.grip(now)
        if grip != self._grip:
            self._robot.hold_joystick(grip)
            self._grip = grip

    def lay_flat(self) -> None:
        """For good. Raises SimulatorError."""
        self._demonstration.end()
        self.hold(0.0)


_LOOK_EVERY: Final = 0.2  # s
_SERVICES_WITHIN: Final = 20.0  # s
_REST_WITHIN: Final = 4.0  # s
_PUSH_AFTER: Final = 8.0  # s; a robot that balances has got up and drives by then
_LOOKS_AT_REST: Final = 4  # in a row, by when odometry has caught up

DONE: Final = 0
FAILED: Final = 1


class _Viewers:
    """Whoever is told what is heard."""

    def __init__(self, telemetry: RunTelemetry, joystick: Joystick) -> None:
        self._telemetry = telemetry
        self._joystick = joystick

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        self._telemetry.on_sample(topic, key, sample, at_ns)
        self._joystick.on_sample(sample, at_ns * 1e-9)

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        self._telemetry.on_liveliness(service, instance, present=present)


class Run:
    """From the first process to the summary."""

    def __init__(
        self,
        plan: Plan,
        robot: SimulatedRobot,
        connection: RobotConnection,
        stopping: StopSignal,
        *,
        hints: Sequence[str],
        look: str,
    ) -> None:
        """`hints`: what a person can do, a line each. `look`: how to see by its camera; empty: it has none."""
        self._plan = plan
        self._robot = robot
        self._connection = connection
        self._stopping = stopping
        self._hints = hints
        self._look_hint = look
        self._placing: QueryClient[LocalizationSetPose, LocalizationAnswer] | None = None
        self._is_placed = LOCALIZATION.name not in plan.services
        self._joystick = Joystick(robot, is_driven=plan.options.hand == "demo")
        self._announcer: Announcer | None = None
        self._driver: Driver | None = None
        self._page = robot.page
        self._awaited = {*plan.services} - {WEB.name}
        self._screen: Screen = NullScreen()
        self._keys: Keys | None = None
        """None: nobody can type, or a hand reads the keys."""
        self._failures: list[str] = []
        self._ended: Ended | None = None
        """The service that ended last."""
        self._said: set[str] = set()
        self._began_ns: int | None = None
        """Robot's clock when all services were there."""

    def run(self) -> int:
        """The whole of it; the exit code."""
        telemetry: RunTelemetry | None = None
        try:
            if self._robot.start_simulator(self._stopping):
                room = read_room(self._plan.world)
                telemetry = RunTelemetry(self._plan.robot.sensor_types, self._robot.truth(), room.outlines(), room.name)
                self._watch(telemetry)
        except (StartError, SimulatorError) as error:
            self._note_ended()
            self._failures.append(str(error))
        finally:
            self._end_driver()
            self._failures += self._robot.stop()
        self._failures += self._connection.decode_errors
        for failure in self._failures:
            self._say_on_stderr(failure)
        if telemetry is not None:
            self._conclude(telemetry)
        return FAILED if self._failures else DONE

    def _watch(self, telemetry: RunTelemetry) -> None:
        self._connection.subscribe_all(topic for topic in TOPICS if topic is not TRUE_POSE)  # its own word
        self._announcer = Announcer(self._connection.session, self._plan.robot.name)
        self._await_page()
        if self._plan.options.hand != "keyboard":  # whoever drives has the terminal
            self._screen = open_screen()
            if self._page is not None and isinstance(self._screen, Terminal) and sys.stdin.isatty():
                self._keys = Keys()
        try:
            self._await_services(telemetry)
            self._began_ns = robot_now_ns()
            telemetry.begin()
            if self._plan.options.hand == "keyboard" and not (self._stopping.asked or self._failures):
                self._driver = self._robot.start_driver()
            self._drive(telemetry)
            self._end_driver()
            if self._plan.options.picture is not None:
                write_file_durably(self._plan.options.picture, as_svg(self._view(telemetry).render()).encode())
            self._come_to_rest(telemetry)
        finally:
            self._screen.close()
            if self._keys is not None:
                self._keys.close()

    def _await_services(self, telemetry: RunTelemetry) -> None:
        deadline = time.monotonic() + _SERVICES_WITHIN
        while missing := self._awaited - telemetry.alive - self._robot.ended.keys():
            if time.monotonic() > deadline:
                self._failures.append(f"not on the network after {_SERVICES_WITHIN:g} s: {', '.join(sorted(missing))}")
                return
            if self._stopping.wait(_LOOK_EVERY) or not self._update(telemetry):
                return

    def _await_page(self) -> None:
        """On a terminal its addresses are told before the live view takes all of it."""
        if self._page is None:
            return
        deadline = time.monotonic() + _SERVICES_WITHIN
        while not self._page.update():
            self._note_ended()
            if WEB.name in self._robot.ended or self._stopping.wait(_LOOK_EVERY):
                return
            if time.monotonic() > deadline:
                self._failures.append(f"the page has told no address after {_SERVICES_WITHIN:g} s")
                return
        addresses.print_addresses(self._page.addresses)

    def _tell_place(self, telemetry: RunTelemetry) -> None:
        """Tell localization once where the robot is, as a person does who puts it on its mark. Never waits."""
        said = telemetry.latest(POSE, robot_now_ns())
        if self._is_placed or said is None or said.sample.state == "no_map":
            return
        if self._placing is None:
            place = self._robot.truth().pose
            asked = LocalizationSetPose(by="giraff run", id=secrets.randbits(63), x=place.x, y=place.y, yaw=place.yaw)
            self._placing = QueryClient(self._connection.session, self._plan.robot.name, LOCALIZATION_SET_POSE, asked)
        if (answer := self._placing.poll(time.monotonic())) is not None:
            self._is_placed, self._placing = answer.done, None  # after a refusal the robot may be elsewhere

    def _drive(self, telemetry: RunTelemetry) -> None:
        until = math.inf if self._plan.options.seconds is None else time.monotonic() + self._plan.options.seconds
        push_at = time.monotonic() + _PUSH_AFTER if self._plan.options.hand == "demo" else math.inf
        while self._update(telemetry):
            if time.monotonic() >= push_at and telemetry.balance is not None:
                self._robot.push()
                push_at = math.inf
            left = until - time.monotonic()
            if self._driver is not None and not self._driver.is_there:
                return
            if left <= 0.0 or self._stopping.wait(min(_LOOK_EVERY, left)):
                return

    def _come_to_rest(self, telemetry: RunTelemetry) -> None:
        """Have nobody drive and let odometry catch up: a moving robot is never where it was last heard of."""
        if SIMULATOR in self._robot.ended:
            return
        self._joystick.lay_flat()
        stop = None
        if _driver(telemetry) not in ("", DEMONSTRATION):
            stop = request_estop(
                self._connection.session, self._plan.robot.name, by="giraff run", reason="the run ends"
            )
        if self._rests(telemetry, stop) and telemetry.balance is not None and telemetry.balance.stands:
            telemetry.sit()
            self._robot.drain(telemetry.balance.sits_down_at)  # without power, which it loses now, it would fall
            self._rests(telemetry, stop)

    def _rests(self, telemetry: RunTelemetry, stop: EStopClient | None) -> bool:
        """Wait until the robot is at rest, for a while; False when the world has ended, or a person cannot wait."""
        deadline = time.monotonic() + _REST_WITHIN
        asked = self._stopping.asked
        looks = 0
        while looks < _LOOKS_AT_REST and (now := time.monotonic()) < deadline:
            if stop is not None:
                stop.poll(now)
            if self._stopping.wait(_LOOK_EVERY, patience=asked + 1) or not self._update(telemetry):
                return False
            looks = looks + 1 if telemetry.is_at_rest else 0
        return True

    def _update(self, telemetry: RunTelemetry) -> bool:
        """Take in what there is and show it; False when the world has ended."""
        self._note_ended()
        if SIMULATOR in self._robot.ended:
            return False
        self._connection.dispatch(_Viewers(telemetry, self._joystick))
        self._joystick.hold(robot_now_ns() * 1e-9)
        telemetry.see(self._robot.truth())
        self._tell_place(telemetry)
        if self._announcer is not None:
            self._announcer.publish(telemetry.true_pose, telemetry.walls)
        if self._page is not None and self._page.update() and isinstance(self._screen, LineScreen):
            addresses.print_addresses(self._page.addresses)
        if self._page is not None and self._keys is not None:
            self._page.on_keys(self._keys.read())
        try:
            self._screen.show(replace(self._view(telemetry), code=self._page.code if self._page else None))
        except OSError:  # whoever watched has gone
            self._screen = NullScreen()
            self._stopping.ask()
        return True

    def _end_driver(self) -> None:
        if self._driver is not None:
            self._failures += filter(None, [self._driver.end()])
            self._driver = None

    def _note_ended(self) -> None:
        for ended in self._robot.reap():
            self._failures.append(str(ended))
            self._ended = ended
            if self._driver is None and not isinstance(self._screen, Terminal):
                self._say_on_stderr(str(ended))

    def _say_on_stderr(self, failure: str) -> None:
        """Say it, once. A live view has the terminal to itself until it closes, and shows it meanwhile."""
        if failure not in self._said:
            self._said.add(failure)
            with contextlib.suppress(OSError):  # nobody reads it
                print(printable_lines(f"giraff run: {failure}"), file=sys.stderr, flush=True)

    def _view(self, telemetry: RunTelemetry) -> RunView:
        now_ns = robot_now_ns()
        told = () if self._page is None else self._page.addresses
        hints = [f"drive it: {addresses.of_others(told) or told[0]}", *self._hints[1:]] if told else self._hints
        frame = Frame(
            robot=self._plan.robot.name,
            boards=self._plan.boards,
            seed=self._plan.options.seed,
            elapsed=0.0 if self._began_ns is None else (now_ns - self._began_ns) * 1e-9,
            seconds=self._plan.options.seconds,
            hints=hints,
            note=self._joystick.note,
            code_key=CODE_KEY if self._keys is not None and self._keys.are_heard else "",
            services={service: self._status(service, telemetry) for service in self._plan.services},
            look=self._look_hint,
            ended="" if self._ended is None else self._ended.headline,
            notices=tuple(self._failures[-1:]) if self._ended is None else (self._ended.cause,),
        )
        return RunView(telemetry.snapshot(now_ns), frame)

    def _status(self, service: str, telemetry: RunTelemetry) -> ServiceStatus:
        if service in self._robot.ended:
            return "ended"
        if service in telemetry.alive:
            return "alive"
        return "starting" if self._began_ns is None else "silent"

    def _conclude(self, telemetry: RunTelemetry) -> None:
        summary = summarize(
            telemetry,
            robot=self._plan.robot.name,
            boards=self._plan.boards,
            seed=self._plan.options.seed,
            truth=self._plan.options.truth,
            drawn=self._robot.drawn,
            began_ns=self._began_ns or telemetry.truth.robot_ns,
            failures=self._failures,
        )
        say(to_text(summary))
        if self._plan.options.summary is not None:
            write_file_durably(self._plan.options.summary, to_json(summary).encode())


def _driver(telemetry: RunTelemetry) -> str:
    """Name of the operator that holds the lease; empty: none."""
    lease = telemetry.latest(LEASE, robot_now_ns())
    return "" if lease is None else lease.sample.operator

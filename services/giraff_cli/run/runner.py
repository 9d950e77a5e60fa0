"""`giraff run`: the simulated robot and its five services as processes, watched from the network.

The order matters. Nothing is started before the name is known to be free; services start when the simulator is
ready, end before it, and the run is judged, with the robot at rest, before anything is told to end.
"""

from __future__ import annotations

import math
import os
import socket
import sys
import time
from pathlib import Path
from typing import Any, Final

import msgspec
import zenoh

from giraff_cli.network.connection import RobotConnection
from giraff_cli.network.interfaces import interfaces
from giraff_cli.network.ports import claim, free_port
from giraff_cli.run.demonstration import DRIVES, FLAT, OPERATOR, Demonstration
from giraff_cli.run.directory import RunDirectory
from giraff_cli.run.driver import Driver
from giraff_cli.run.invitation import Invitation, invite
from giraff_cli.run.plan import Plan
from giraff_cli.run.screen import Frame, RunView
from giraff_cli.run.simulated_robot import SIMULATOR, START_ORDER, SimulatedRobot, StartError
from giraff_cli.run.summary import summarize, to_json, to_text
from giraff_cli.run.telemetry import RunTelemetry
from giraff_cli.terminal.layout import Standing
from giraff_cli.terminal.program import called_anywhere
from giraff_cli.terminal.screen import NullScreen, Screen, as_svg, open_screen, say
from giraff_cli.terminal.signals import StopSignal
from giraff_core.network import NetworkConfig
from giraff_node import robot_now_ns
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.discovery import list_robots, simulated_name
from giraff_node.network.query_client import request_estop
from giraff_node.network.session import open_session
from giraff_node.process.state import write_file_durably
from giraff_schemas.messages import Sample
from giraff_schemas.topics import LEASE, Topic
from giraff_sim.control.client import SimulatorError

_LOOK_EVERY: Final = 0.2  # s
_SEEK_NAMESAKE: Final = 0.5  # s; a peer on the network is met within some ten ms
_SERVICES_WITHIN: Final = 20.0  # s
_REST_WITHIN: Final = 4.0  # s
_LOOKS_AT_REST: Final = 4  # in a row, by when odometry has caught up
_NOTICES: Final = 1  # more would not fit 24 lines

_DONE: Final = 0
_FAILED: Final = 1
_REFUSED: Final = 2
_WAY_OUT: Final = "; end it, or give this one another name with GIRAFF_ROBOT_NAME"


def drive(plan: Plan) -> int:
    """Do the run; the exit code."""
    network = msgspec.structs.replace(plan.network, rendezvous=f"127.0.0.1:{free_port()}")
    robot = plan.robot.name
    with StopSignal() as stopping:
        held = None if network.local else claim(robot)
        if held is None and not network.local:
            return _refuse(f"a run of {robot} is going on on this host{_WAY_OUT}")
        try:
            connection = RobotConnection(robot, open_session(network, robot))
        except ConfigError as error:
            return _refuse(str(error))
        except zenoh.ZError as error:
            return _refuse(f"no Zenoh session: {error}; check the table [network] of the robot file")
        try:
            token = None if network.local else connection.find_duplicate(_SEEK_NAMESAKE)
            if token is not None:
                code = _refuse(f"a robot called {robot} is on the network already ({token}){_WAY_OUT}")
            else:
                code = _with_directory(plan, network, connection, stopping)
        finally:
            is_closed = connection.close()
        if held is not None:
            held.close()
        if not is_closed:  # Zenoh would hold the process, and nothing is left to do
            sys.stdout.flush()
            os._exit(code)
        return code


def _refuse(why: str) -> int:
    print(f"giraff run: {why}", file=sys.stderr)
    return _REFUSED


def _with_directory(plan: Plan, network: NetworkConfig, connection: RobotConnection, stopping: StopSignal) -> int:
    invitation = _invitation(plan, network, connection)
    say(f"starting {plan.robot.name} with {plan.boards} boards" + (f": {plan.why_boards}" if plan.why_boards else ""))
    say("meanwhile, in another terminal: drive it, stop it, ask why it does not move, watch it")
    for command in invitation.lines():
        say(f"    {command}")
    directory = RunDirectory()
    code = _FAILED
    try:
        code = Run(
            plan, SimulatedRobot(plan, network.rendezvous, directory.path), connection, stopping, invitation
        ).run()
    finally:
        if code == _DONE:
            directory.remove()
        else:
            directory.keep()
            print(f"giraff run: the logs are in {directory.path}", file=sys.stderr)
    return code


def _invitation(plan: Plan, network: NetworkConfig, connection: RobotConnection) -> Invitation:
    return invite(
        called_anywhere(),
        plan.robot.name,
        network,
        Path(plan.environment["GIRAFF_CONFIG"]),
        interfaces=interfaces(),
        is_only_here=plan.robot.name == simulated_name(socket.gethostname()) and not list_robots(connection.session),
    )


class _Audience:
    """Tells the demonstration, too."""

    def __init__(self, telemetry: RunTelemetry, demonstration: Demonstration | None) -> None:
        self._telemetry = telemetry
        self._demonstration = demonstration

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        self._telemetry.on_sample(topic, key, sample, at_ns)
        if self._demonstration is not None:
            self._demonstration.on_sample(sample, at_ns * 1e-9)

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
        invitation: Invitation,
    ) -> None:
        self._plan = plan
        self._robot = robot
        self._connection = connection
        self._stopping = stopping
        self._hint = f"drive it: {invitation.command('drive')}"
        self._demonstration = Demonstration() if plan.driver == "demo" else None
        self._grip = FLAT if self._demonstration is None else DRIVES
        self._driver: Driver | None = None
        self._screen: Screen = NullScreen()
        self._failures: list[str] = []
        self._began_ns: int | None = None
        """Robot's clock when all services were there."""

    def run(self) -> int:
        """The whole of it; the exit code."""
        telemetry: RunTelemetry | None = None
        try:
            if self._robot.start_simulator(self._stopping):
                telemetry = RunTelemetry(tuple(self._plan.robot.sensors), self._robot.truth())
                self._watch(telemetry)
        except (StartError, SimulatorError) as error:
            self._note_ended()
            self._failures.append(str(error))
        finally:
            self._end_driver()
            self._failures += self._robot.stop()
        self._failures += self._connection.decode_errors
        for failure in self._failures:
            print(f"giraff run: {failure}", file=sys.stderr)
        if telemetry is not None:
            self._conclude(telemetry)
        return _FAILED if self._failures else _DONE

    def _watch(self, telemetry: RunTelemetry) -> None:
        self._connection.subscribe_all()
        if self._plan.driver != "keyboard":  # whoever drives has the terminal
            self._screen = open_screen()
        try:
            self._await_services(telemetry)
            self._began_ns = robot_now_ns()
            telemetry.begin()
            if self._plan.driver == "keyboard" and not (self._stopping.asked or self._failures):
                self._driver = self._robot.start_driver()
            self._drive(telemetry)
            self._end_driver()
            if self._plan.picture is not None:
                write_file_durably(self._plan.picture, as_svg(self._view(telemetry).render()).encode())
            self._come_to_rest(telemetry)
        finally:
            self._screen.close()

    def _await_services(self, telemetry: RunTelemetry) -> None:
        deadline = time.monotonic() + _SERVICES_WITHIN
        while missing := set(START_ORDER) - telemetry.alive - self._robot.ended.keys():
            if time.monotonic() > deadline:
                self._failures.append(f"not on the network after {_SERVICES_WITHIN:g} s: {', '.join(sorted(missing))}")
                return
            if self._stopping.wait(_LOOK_EVERY) or not self._look(telemetry):
                return

    def _drive(self, telemetry: RunTelemetry) -> None:
        until = math.inf if self._plan.seconds is None else time.monotonic() + self._plan.seconds
        while self._look(telemetry):
            left = until - time.monotonic()
            if self._driver is not None and not self._driver.is_there:
                return
            if left <= 0.0 or self._stopping.wait(min(_LOOK_EVERY, left)):
                return

    def _come_to_rest(self, telemetry: RunTelemetry) -> None:
        """Have nobody drive and let odometry catch up: a moving robot is never where it was last heard of."""
        if SIMULATOR in self._robot.ended:
            return
        if self._demonstration is not None:
            self._demonstration.end()
        self._hold_joystick()
        stop = None
        if _driver(telemetry) not in ("", OPERATOR):
            stop = request_estop(
                self._connection.session, self._plan.robot.name, by="giraff run", reason="the run ends"
            )
        deadline = time.monotonic() + _REST_WITHIN
        asked = self._stopping.asked
        looks = 0
        while looks < _LOOKS_AT_REST and (now := time.monotonic()) < deadline:
            if stop is not None:
                stop.poll(now)
            if self._stopping.wait(_LOOK_EVERY, patience=asked + 1) or not self._look(telemetry):
                return
            looks = looks + 1 if telemetry.truth.is_at_rest else 0

    def _look(self, telemetry: RunTelemetry) -> bool:
        """Take in what there is and show it; False when the world has ended."""
        self._note_ended()
        if SIMULATOR in self._robot.ended:
            return False
        self._connection.dispatch(_Audience(telemetry, self._demonstration))
        self._hold_joystick()
        telemetry.see(self._robot.truth())
        try:
            self._screen.show(self._view(telemetry))
        except OSError:  # whoever watched has gone
            self._screen = NullScreen()
            self._stopping.ask()
        return True

    def _hold_joystick(self) -> None:
        """As the demonstration has it now."""
        grip = FLAT if self._demonstration is None else self._demonstration.grip(robot_now_ns() * 1e-9)
        if grip != self._grip:
            self._robot.hold_joystick(grip)
            self._grip = grip

    def _end_driver(self) -> None:
        if self._driver is not None:
            self._failures += filter(None, [self._driver.end()])
            self._driver = None

    def _note_ended(self) -> None:
        self._failures += [str(ended) for ended in self._robot.reap()]

    def _view(self, telemetry: RunTelemetry) -> RunView:
        now_ns = robot_now_ns()
        frame = Frame(
            robot=self._plan.robot.name,
            boards=self._plan.boards,
            seed=self._plan.seed,
            elapsed=0.0 if self._began_ns is None else (now_ns - self._began_ns) * 1e-9,
            seconds=self._plan.seconds,
            hint=self._hint,
            note="" if self._demonstration is None else self._demonstration.note,
            services={service: self._standing(service, telemetry) for service in START_ORDER},
            notices=tuple(failure.partition("\n")[0] for failure in self._failures[-_NOTICES:]),
        )
        return RunView(telemetry.snapshot(now_ns), frame)

    def _standing(self, service: str, telemetry: RunTelemetry) -> Standing:
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
            seed=self._plan.seed,
            truth=self._plan.truth,
            drawn=self._robot.drawn,
            began_ns=self._began_ns or telemetry.truth.robot_ns,
            failures=self._failures,
        )
        say(to_text(summary))
        if self._plan.summary is not None:
            write_file_durably(self._plan.summary, to_json(summary).encode())


def _driver(telemetry: RunTelemetry) -> str:
    """Name of the operator that holds the lease; empty: none."""
    lease = telemetry.newest(LEASE, robot_now_ns())
    return "" if lease is None else lease.sample.operator

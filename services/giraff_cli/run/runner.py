"""`giraff run`: the simulated robot and its five services as processes, watched from the network.

The order matters. Nothing is started before the name is known to be free; services start when the simulator is
ready, end before it, and the run is judged, with the robot at rest, before anything is told to end.
"""

from __future__ import annotations

import math
import os
import sys
import time
from typing import Final

import msgspec
import zenoh

from giraff_cli.network.connection import RobotConnection
from giraff_cli.network.ports import claim, free_port
from giraff_cli.run.directory import RunDirectory
from giraff_cli.run.plan import Plan
from giraff_cli.run.screen import Frame, RunView
from giraff_cli.run.simulated_robot import SIMULATOR, START_ORDER, SimulatedRobot, StartError
from giraff_cli.run.summary import summarize, to_json, to_text
from giraff_cli.run.telemetry import RunTelemetry
from giraff_cli.terminal.layout import Standing
from giraff_cli.terminal.screen import NullScreen, Screen, as_svg, open_screen, say
from giraff_cli.terminal.signals import StopSignal
from giraff_node import robot_now_ns
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.session import open_session
from giraff_node.process.state import write_file_durably
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
                code = _with_directory(plan, network.rendezvous, connection, stopping)
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


def _with_directory(plan: Plan, rendezvous: str, connection: RobotConnection, stopping: StopSignal) -> int:
    say(f"starting {plan.robot.name} with {plan.boards} boards" + (f": {plan.why_boards}" if plan.why_boards else ""))
    say(f"meanwhile, in another terminal: giraff why --robot {plan.robot.name} --connect tcp/{rendezvous}")
    directory = RunDirectory()
    code = _FAILED
    try:
        code = Run(plan, SimulatedRobot(plan, rendezvous, directory.path), connection, stopping).run()
    finally:
        if code == _DONE:
            directory.remove()
        else:
            directory.keep()
            print(f"giraff run: the logs are in {directory.path}", file=sys.stderr)
    return code


class Run:
    """From the first process to the summary."""

    def __init__(self, plan: Plan, robot: SimulatedRobot, connection: RobotConnection, stopping: StopSignal) -> None:
        self._plan = plan
        self._robot = robot
        self._connection = connection
        self._stopping = stopping
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
            self._failures += self._robot.stop()
        self._failures += self._connection.decode_errors
        for failure in self._failures:
            print(f"giraff run: {failure}", file=sys.stderr)
        if telemetry is not None:
            self._conclude(telemetry)
        return _FAILED if self._failures else _DONE

    def _watch(self, telemetry: RunTelemetry) -> None:
        self._connection.subscribe_all()
        self._screen = open_screen()
        try:
            self._await_services(telemetry)
            self._began_ns = robot_now_ns()
            telemetry.begin()
            self._drive(telemetry)
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
            if left <= 0.0 or self._stopping.wait(min(_LOOK_EVERY, left)):
                return

    def _come_to_rest(self, telemetry: RunTelemetry) -> None:
        """Lay the joystick flat and let odometry catch up: a moving robot is never where it was last heard of."""
        if SIMULATOR in self._robot.ended:
            return
        self._robot.lay_joystick_flat()
        deadline = time.monotonic() + _REST_WITHIN
        asked = self._stopping.asked
        looks = 0
        while looks < _LOOKS_AT_REST and time.monotonic() < deadline:
            if self._stopping.wait(_LOOK_EVERY, patience=asked + 1) or not self._look(telemetry):
                return
            looks = looks + 1 if telemetry.truth.is_at_rest else 0

    def _look(self, telemetry: RunTelemetry) -> bool:
        """Take in what there is and show it; False when the world has ended."""
        self._note_ended()
        if SIMULATOR in self._robot.ended:
            return False
        self._connection.dispatch(telemetry)
        telemetry.see(self._robot.truth())
        try:
            self._screen.show(self._view(telemetry))
        except OSError:  # whoever watched has gone
            self._screen = NullScreen()
            self._stopping.ask()
        return True

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

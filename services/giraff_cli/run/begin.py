"""`giraff run`: nothing is started before the robot's name is known to be free."""

import os
import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Final

import msgspec
import zenoh

from giraff_cli.run.directory import RunDirectory, remove_run_sockets
from giraff_cli.run.plan import Plan
from giraff_cli.run.runner import DONE, FAILED, Run
from giraff_cli.run.simulated_robot import SimulatedRobot
from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.discovery import is_simulated_here
from giraff_node.network.host_addresses import loopback_fault
from giraff_node.network.session import open_session
from giraff_node.network.tokens import list_robots
from giraff_schemas.services import LOCALIZATION, RUN
from giraff_schemas.text import printable_lines
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.interfaces import Interface, interfaces
from giraff_tools.network.ports import claim, free_port
from giraff_tools.terminal.program import called_anywhere
from giraff_tools.terminal.screen import say
from giraff_tools.terminal.signals import StopSignal

_VERBS = (("drive",), ("stop",), ("why",), ("watch",))


def _camera_verb() -> tuple[str, ...]:
    """Return the verb that shows what the camera sees: in a window where its library is here, else as a file."""
    return ("camera", "view") if find_spec("rerun") else ("camera", "view", "--save", "look.jpg")


@dataclass(frozen=True, kw_only=True)
class Invitation:
    """Command lines that find the robot of the run."""

    giraff: Sequence[str]
    """The words that call it."""
    robot: str
    """Empty: it is found without its name, being the simulation of this host, and alone where it is called."""
    connect: str
    """Address at which the run is called; empty: it is found without."""
    robot_file: Path | None
    """The file that leads to its network; None: no file is needed."""

    def command(self, *verb: str) -> str:
        """A command line."""
        file = [f"GIRAFF_CONFIG={self.robot_file}"] if self.robot_file else []
        robot = ["--robot", self.robot] if self.robot else []
        connect = ["--connect", self.connect] if self.connect else []
        return shlex.join([*file, *self.giraff, *verb, *robot, *connect])

    @property
    def hints(self) -> list[str]:
        """What must be at hand at any moment."""
        return [f"drive it: {self.command('drive')}", f"stop it:  {self.command('stop')}"]

    @property
    def how_to_see(self) -> str:
        """How to see what its camera sees."""
        return f"see by it: {self.command(*_camera_verb())}"

    def lines(self, *, camera: bool = False) -> list[str]:
        """Drive it, stop it, ask it why it does not move, watch it; with a camera, see by it."""
        return [self.command(*verb) for verb in (*_VERBS, *([_camera_verb()] if camera else []))]


def invite(
    giraff: Sequence[str],
    robot: str,
    network: NetworkConfig,
    robot_file: Path,
    *,
    interfaces: Sequence[Interface],
    is_only_here: bool,
) -> Invitation:
    """`network`: of the run, with its rendezvous; `robot_file`: its own; `interfaces`: of this host.

    `is_only_here`: it has the name of this host's simulation, no other robot is heard, and no GIRAFF_CONFIG names one.
    """
    is_plain = network.mode == "lan" and not network.session_file
    # With addresses of its own, a command does not ask by multicast.
    is_announced = is_plain and not (network.local or network.connect) and any(each.multicast for each in interfaces)
    # A session file leads to the network alone, and a run has a rendezvous of its own, which no other file names.
    connect = "" if is_announced or network.session_file else network.rendezvous
    return Invitation(
        giraff=giraff,
        robot="" if is_only_here and is_plain else robot,
        connect=connect,
        robot_file=None if is_plain else robot_file,
    )


_SEEK_NAMESAKE: Final = 0.5  # s; a peer on the network is met within some ten ms

_REFUSED: Final = 2
_REMEDY: Final = "; end it, or give this one another name with GIRAFF_ROBOT_NAME"


def drive(plan: Plan) -> int:
    """Do the run; the exit code."""
    if fault := loopback_fault():
        return _refuse(f"{fault.what}, where the robot's parts meet; {fault.remedy}")
    network = msgspec.structs.replace(plan.network, rendezvous=f"127.0.0.1:{free_port()}")
    robot = plan.robot.name
    with StopSignal() as stopping:
        held = None if network.local else claim(robot)
        if held is None and not network.local:
            return _refuse(f"a run of {robot} is going on on this host{_REMEDY}")
        try:
            token, others = (None, []) if network.local else _look_around(network, robot)
            if token is not None:
                return _refuse(f"a robot called {robot} is on the network already ({token}){_REMEDY}")
            # Its own processes speak to it at sockets, whatever becomes of this host's addresses and of its door.
            connection = RobotConnection(robot, open_session(network, robot, "inside", name=RUN.name))
        except ConfigError as error:
            return _refuse(str(error))
        except zenoh.ZError as error:
            return _refuse(f"no Zenoh session: {error}; check the table [network] of the robot file")
        try:
            code = _with_directory(plan, network, connection, stopping, others)
        finally:
            connection.close()
            remove_run_sockets(network)
        if held is not None:
            held.close()
        return code


def _refuse(why: str) -> int:
    print(printable_lines(f"giraff run: {why}"), file=sys.stderr)
    return _REFUSED


def _look_around(network: NetworkConfig, robot: str) -> tuple[str | None, list[str]]:
    """Return the liveliness token of a robot of this name, and the names of all robots that are heard."""
    visit = RobotConnection(robot, open_session(network, robot, "outside", visits=True))
    try:
        return visit.find_duplicate(_SEEK_NAMESAKE), list_robots(visit.session)
    finally:
        visit.close()


def _with_directory(
    plan: Plan, network: NetworkConfig, connection: RobotConnection, stopping: StopSignal, others: list[str]
) -> int:
    invitation = _invitation(plan, network, others)
    say(f"starting {plan.robot.name} with {plan.boards} boards" + (f": {plan.why_boards}" if plan.why_boards else ""))
    see = ", see by it" if plan.camera else ""
    say(f"in another terminal: drive it, stop it, ask why it stands, watch it{see}")
    for command in invitation.lines(camera=bool(plan.camera)):
        say(f"    {command}")
    if LOCALIZATION.name in plan.services:
        say("localization is told where the robot starts; to have it look anywhere instead:")
        say(f"    {invitation.command('localize', '--global')}")
    directory = RunDirectory()
    code = FAILED
    try:
        robot = SimulatedRobot(plan, network.rendezvous, directory.path)
        look = invitation.how_to_see if plan.camera else ""
        code = Run(plan, robot, connection, stopping, hints=invitation.hints, look=look).run()
    finally:
        if code == DONE:
            directory.remove()
        else:
            directory.keep()
            print(f"giraff run: the logs are in {directory.path}", file=sys.stderr)
    return code


def _invitation(plan: Plan, network: NetworkConfig, others: list[str]) -> Invitation:
    # Another terminal may have the variable, too, and a stop goes to the robot of that file unless one is named.
    has_usual_name = is_simulated_here(plan.robot.name) and not os.environ.get("GIRAFF_CONFIG")
    return invite(
        called_anywhere(),
        plan.robot.name,
        network,
        Path(plan.environment["GIRAFF_CONFIG"]),
        interfaces=interfaces(),
        is_only_here=has_usual_name and not others,
    )

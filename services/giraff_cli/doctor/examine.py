"""`giraff doctor`: looks at this machine, its network and a robot, and tells what is wrong."""

import threading
import time
from collections.abc import Callable, Sequence
from itertools import chain
from typing import Final, Generic, TypeVar

import msgspec
import zenoh

from giraff_cli.doctor.findings import Finding, as_document, findings
from giraff_cli.doctor.inspection import Inspection, Machine, Network, Robot
from giraff_cli.doctor.machine import CORRECT_IT, geometry_of, look_at_boards, look_at_machine, wiring_problem
from giraff_cli.doctor.probe import call_all, call_pages, has_free_port
from giraff_cli.doctor.robot import listen
from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import Target, resolve_target, select_robot, target_of
from giraff_node.network.host_addresses import host_addresses
from giraff_node.network.scouting import scout
from giraff_node.network.session import NobodyError, open_session
from giraff_node.network.sockets import PROTOCOL
from giraff_node.network.tokens import list_robots
from giraff_schemas.services import BASE, WEB
from giraff_schemas.text import printable
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_tools.network.command import print_error
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.interfaces import is_own
from giraff_tools.terminal.output import guard_stdout
from giraff_tools.terminal.text import counted

FoundT = TypeVar("FoundT")

_NO_FAULT: Final = 0
_FAULT: Final = 1
_FIND_WITHIN: Final = 2.0  # s
_SCOUT_FOR: Final = 1.5  # s
_ASK_AGAIN: Final = 0.1  # s
_SETTLED: Final = 0.5  # s
_CLOSE_WITHIN: Final = 0.3  # s
_NOT_ASKED: Final = Trouble(
    "nobody was asked, because the robot file, or a variable, may mean another network", "correct it"
)


def examine(robot: str | None, connect: Sequence[str], seconds: float, *, as_json: bool) -> int:
    """The whole of it; the exit code."""
    connection: RobotConnection | None = None
    try:
        way, wrong = _find_way(robot, connect)
        machine = look_at_machine(way.robot, way.network, wrong)
        connection, problem = (None, _NOT_ASKED) if wrong else _join(way)
        look = _inspect(way, machine, connection, problem, seconds)
    except NoRobotError as error:
        return print_error(str(error))
    else:
        found = findings(look)
        verdict = _FAULT if any(each.severity == "fault" for each in found) else _NO_FAULT
        return guard_stdout(lambda: _print(as_document(look, found) if as_json else _page(look, found), verdict))
    finally:
        if connection is not None:
            connection.close(_CLOSE_WITHIN)


def _print(text: str, code: int) -> int:
    print(text)
    return code


def _find_way(robot: str | None, connect: Sequence[str]) -> tuple[Target, str]:
    """With what is wrong with robot file or environment: then the way is the command line's alone."""
    try:
        return resolve_target(robot, connect), ""
    except ConfigError as error:
        return target_of(robot, connect, NetworkConfig()), str(error)


def _join(way: Target) -> tuple[RobotConnection | None, Trouble]:
    """A connection to a door; or why there is none, where that is not the network's doing."""
    try:
        return RobotConnection(way.robot, open_session(way.network, way.robot or "*", "client"), way.filed), NO_TROUBLE
    except NobodyError:
        return None, NO_TROUBLE
    except ConfigError as error:
        return None, Trouble(str(error), CORRECT_IT)
    except zenoh.ZError as error:
        return None, Trouble(f"no Zenoh session: {error}", "check the table [network] of the robot file, and --connect")


def _inspect(
    way: Target, machine: Machine, connection: RobotConnection | None, problem: Trouble, seconds: float
) -> Inspection:
    """Raises NoRobotError where several are there and none is named."""
    has_doors = not way.network.local and not way.network.session_file
    scouted = has_doors and way.network.mode == "lan" and not problem
    calls = _Beside(lambda: call_all(way.network, machine))
    scouts = _Beside(lambda: scout(_SCOUT_FOR) if scouted else {})
    robot = None if connection is None else _meet(connection, seconds)
    heard = scouts.result()
    link = None if connection is None else next(iter(connection.session.info.links()), None)
    zid = "" if link is None else str(link.zid)
    protocol, _, door = ("" if link is None else link.dst).partition("/")
    is_far = bool(door) and protocol != PROTOCOL and not is_own(door.rpartition(":")[0], machine.interfaces)
    is_own_door = door == way.network.rendezvous and zid in heard
    answers = robot.answers if robot else ()
    webs = {each.health.host for each in answers if each.health.service == WEB.name} - {machine.host}
    running = [service for service, count in (robot.services if robot else {}).items() if count]
    based_here = any(each.health.service == BASE.name and each.health.host == machine.host for each in answers)
    return Inspection(
        machine=msgspec.structs.replace(
            machine,
            ports=() if robot is None else look_at_boards(running),
            wiring_problem=wiring_problem(running) if based_here else NO_TROUBLE,
            geometry=geometry_of(robot.name) if robot is not None and based_here else None,
        ),
        network=Network(
            has_doors=has_doors,
            problem=problem,
            calls=calls.result(),
            pages=call_pages(sorted(webs)),
            door=door,
            is_far=is_far,
            untold=tuple(sorted(host_addresses() - _hosts(heard[zid]))) if is_own_door else (),
            has_free_port=has_free_port(way.network),
            scouted=scouted,
            is_found=zid in heard,
            protocols=tuple(sorted({each.partition("/")[0] for each in chain(*heard.values())} - {PROTOCOL})),
            protocol="tls" if way.network.mode == "secured" else "tcp",
            robots=() if connection is None else tuple(list_robots(connection.session)),
        ),
        robot=robot,
        wanted=way.robot,
    )


def _meet(connection: RobotConnection, seconds: float) -> Robot | None:
    """Find the robot that is meant, and listen to it."""
    if not connection.robot:
        deadline = time.monotonic() + _FIND_WITHIN
        while not (found := list_robots(connection.session)):
            if time.monotonic() > deadline:
                return None
            time.sleep(_ASK_AGAIN)
        time.sleep(_SETTLED)
        found = sorted({*found, *list_robots(connection.session)})
        connection.robot = select_robot(connection.session, found, connection.filed)
    return listen(connection, seconds)


def _hosts(locators: Sequence[str]) -> set[str]:
    """The addresses in "tcp/ADDRESS:PORT"."""
    return {each.partition("/")[2].rpartition(":")[0] for each in locators}


class _Beside(Generic[FoundT]):
    """Work that goes on beside other work."""

    def __init__(self, work: Callable[[], FoundT]) -> None:
        self._found: list[FoundT] = []
        self._thread = threading.Thread(target=lambda: self._found.append(work()), daemon=True)
        self._thread.start()

    def result(self) -> FoundT:
        """What it has found, when it has ended."""
        self._thread.join()
        return self._found[0]


def _page(look: Inspection, found: list[Finding]) -> str:
    """For people."""
    lines = []
    for each in found:
        lines += [f"{each.severity.upper():7}  {each.about}: {each.what}", f"         -> {each.fix}"]
    lines.append(f"{_subject(look)}: {sum_up(found)} found")
    return "\n".join(printable(line) for line in lines)


def sum_up(found: list[Finding]) -> str:
    """Return how many faults there are, and how many warnings where there are any."""
    faults, warnings = (sum(each.severity == kind for each in found) for kind in ("fault", "warning"))
    told = counted(faults, "fault") if faults else "no fault"
    return f"{told}, {counted(warnings, 'warning')}" if warnings else told


def _subject(look: Inspection) -> str:
    """What was looked at."""
    machine = f"{look.machine.host}, giraff {look.machine.version}"
    if look.robot is None:
        return machine
    hosts = {answer.health.host for answer in look.robot.answers}
    services, keys = sum(look.robot.services.values()), sum(rate.heard > 0 for rate in look.robot.rates)
    running = f"{counted(services, 'service')} on {counted(len(hosts), 'host')}"
    return f"{look.robot.name}: {running}, {counted(keys, 'key')} heard; {machine}"

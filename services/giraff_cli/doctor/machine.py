"""Looks at this machine: its networks, disks and keys, and the boards of services that do not run."""

import contextlib
import os
import socket
import time
from collections.abc import Collection, Mapping
from datetime import UTC, datetime
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import msgspec

from giraff_base.config import BaseConfig
from giraff_cli.doctor.inspection import Disk, Geometry, Machine, Port
from giraff_core.network import NetworkConfig
from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_node.config.robot_file import ConfigError, expects_robot_file, load, read_tables
from giraff_node.network.discovery import is_simulated_here
from giraff_node.network.host_addresses import loopback_fault
from giraff_node.network.key_bundle import CA_CERTIFICATE, COPY_AGAIN, BundleError, ExpiryWatch, read_bundle
from giraff_node.network.sockets import live_sockets, socket_folder
from giraff_node.process.state import state_directory
from giraff_node.process.version import version
from giraff_ranger.config import RangerConfig
from giraff_schemas.boards import BOARDS, BoardType
from giraff_schemas.services import BASE, HANDS, RANGER, ROBOTS_OWN, RUN, SERVICES
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_tools.network.interfaces import interfaces, ipv6_alone

_HELLO_WITHIN: Final = 3.0  # s; an Arduino starts anew when its port is opened: a Mega after 1 to 2 s
_TURN: Final = 0.01  # s
CORRECT_IT: Final = "correct the robot file, or the variable"


def look_at_machine(
    robot: str, network: NetworkConfig, wrong: str = "", environment: Mapping[str, str] = os.environ
) -> Machine:
    """Without its boards: whether a service holds them is known when the network was looked at.

    `wrong`: what is known to be, with robot file or environment.
    """
    keys, expired = _keys(network) if network.mode == "secured" and not network.session_file else (NO_TROUBLE, False)
    return Machine(
        host=socket.gethostname(),
        version=version(),
        interfaces=(own := interfaces()),
        ipv6_alone=ipv6_alone(own),
        services=_services(network),
        disks=(_disk(state_directory(robot or "giraff", environment)), _disk(Path.cwd())),
        settings_problem=_settings_problem(wrong, environment),
        loopback_problem=loopback_fault(),
        keys_problem=keys,
        keys_expired=expired,
        unranked_hands=_unranked_hands(environment),
    )


def look_at_boards(running: Collection[str], environment: Mapping[str, str] = os.environ) -> tuple[Port, ...]:
    """Of the services that do not run and whose port is there: whether the right board answers.

    A port that is not there may be another machine's, but for that of a process whose folder is there; one that is in
    use is not touched. `giraff run` simulates all.
    """
    found = []
    for service in SERVICES:
        if service.board is None or service.name in running or RUN.name in running:
            continue
        path = str(_tables(environment).get(service.table, {}).get("port", ""))
        board = _board_of(service.name, BOARDS[service.board], environment)
        if path and (Path(path).exists() or (board.is_process and Path(path).parent.is_dir())):
            problem = _greet(path, board)
            if problem is not None:
                found.append(Port(service=service.name, problem=problem))
    return tuple(found)


def wiring_problem(running: Collection[str], environment: Mapping[str, str] = os.environ) -> Trouble:
    """Return why nobody knows yet whether the robot moves as it is asked; NO_TROUBLE where there is no robot file.

    `running`: services. `giraff run` brings the wiring of its simulated boards.
    """
    with contextlib.suppress(ConfigError):
        if RUN.name in running:
            return NO_TROUBLE
        return load(BASE.table, BaseConfig, environment, port="").drive.unchecked
    return NO_TROUBLE


def geometry_of(robot: str, environment: Mapping[str, str] = os.environ) -> Geometry | None:
    """What this machine's robot file says of wheels and track now; None: there is none, or it is another robot's.

    The robot that `giraff run` simulates here has its geometry from the file, too, and a name of its own.
    """
    with contextlib.suppress(ConfigError):
        told = load("robot", RobotConfig, environment)
        if robot == told.name or is_simulated_here(robot):
            return Geometry(
                track_width=told.track_width, ticks_per_metre=told.ticks_per_metre, calibration=told.calibration
            )
    return None


def _board_of(service: str, usual: BoardType, environment: Mapping[str, str]) -> BoardType:
    """Return the board of a service. Of base, its drive names it; of ranger, its table."""
    with contextlib.suppress(ConfigError):
        if service == BASE.name:
            return load(BASE.table, BaseConfig, environment, port="").drive.board_type
        if service == RANGER.name:
            return load(RANGER.table, RangerConfig, environment).board_type
    return usual


def _greet(path: str, board: BoardType) -> Trouble | None:
    """Why no such board says hello there; None: another process has the port."""
    if find_spec("serial") is None:
        return NO_TROUBLE  # a desk without boards
    from giraff_node.boards.board_link import BoardLink  # noqa: PLC0415  of the extra `serial`
    from giraff_node.boards.serial_link import IN_USE  # noqa: PLC0415

    link = BoardLink(path, board)
    try:
        deadline = time.monotonic() + _HELLO_WITHIN
        while link.hello is None and time.monotonic() < deadline:
            link.poll(time.monotonic())
            time.sleep(_TURN)
        if link.hello is not None:
            return NO_TROUBLE
        silent = Trouble(
            f"{path}: no {board.name} board says hello",
            f"see its power and its cable, or {board.flash_advice(path)}",
        )
        problem = link.mismatch or (silent if link.opened else link.fault)
        return None if problem == IN_USE.of(path) else problem
    finally:
        link.close()


def _disk(folder: Path) -> Disk:
    """Of the folder, or the nearest above it that is there."""
    there = next(each for each in (folder, *folder.absolute().parents) if each.exists())
    try:
        told = os.statvfs(there)
    except OSError as error:
        problem = Trouble(f"{there}: {error.strerror}", "see that this user may look there")
        return Disk(folder=str(folder), free_bytes=0, total_bytes=0, problem=problem)
    free, total = told.f_bavail * told.f_frsize, told.f_blocks * told.f_frsize
    return Disk(folder=str(folder), free_bytes=free, total_bytes=total)


def _keys(network: NetworkConfig) -> tuple[Trouble, bool]:
    """What is wrong with this host's bundle, and whether no link comes about with it."""
    folder, now = Path(network.keys), datetime.now(UTC)
    if find_spec("cryptography") is not None:
        from giraff_keys.files import KeyFileError, read_certificate  # noqa: PLC0415
        from giraff_setup.keys.status import State, host_status  # noqa: PLC0415

        try:
            status = host_status(folder, read_certificate(folder / CA_CERTIFICATE), now)
        except KeyFileError as error:
            return Trouble(str(error), COPY_AGAIN), True
        if status.state is State.OK:
            return NO_TROUBLE, False
        grave = status.state not in (State.SOON, State.EXPOSED)
        what = f"{folder}, keys of {status.name}: {status.state}"
        return Trouble(what, "; ".join(status.to_do)), grave
    warning = ExpiryWatch(folder).warning(now)
    with contextlib.suppress(BundleError):
        return warning, read_bundle(folder).expires < now
    return warning, False


def _services(network: NetworkConfig) -> tuple[str, ...]:
    with contextlib.suppress(ConfigError, OSError):  # a folder that this user may not use tells nothing
        return tuple(each for each in live_sockets(socket_folder(network)) if each in ROBOTS_OWN)
    return ()


def _settings_problem(wrong: str, environment: Mapping[str, str]) -> Trouble:
    if not wrong and expects_robot_file(environment):
        try:
            robot = load("robot", RobotConfig, environment)
            load("network", NetworkConfig, environment)
            if BASE.table in _tables(environment):
                base = load(BASE.table, BaseConfig, environment, port="another host's")
                base.drive.require_countable(robot)
        except (ConfigError, ValueError) as error:
            wrong = str(error)
    return Trouble(wrong, CORRECT_IT) if wrong else NO_TROUBLE


def _unranked_hands(environment: Mapping[str, str]) -> tuple[str, ...]:
    """Return the names that the robot file gives its hands, and to which it gives no priority."""
    tables = _tables(environment)
    with contextlib.suppress(msgspec.ValidationError):  # the guard that reads it says so
        guard = msgspec.convert(tables.get("guard", {}), GuardConfig, strict=False)
        names = {str(tables.get(hand, {}).get("operator", hand)) for hand in HANDS}
        return tuple(sorted(name for name in names if not guard.ranks(name)))
    return ()


def _tables(environment: Mapping[str, str]) -> dict[str, dict[str, Any]]:
    with contextlib.suppress(ConfigError, msgspec.MsgspecError):
        return read_tables(environment, with_file=expects_robot_file(environment))
    return {}

"""The plan of a stop: where it is tried, also where robot file or environment cannot be used, and what is said then.

The stop comes first. It is tried over all that can still be read of the network; then the command says what is wrong.
"""

import contextlib
import dataclasses
import os
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from giraff_cli.estop.salvage import Readable, has_bundle, read_what_is_left
from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import DEFAULT_FILE, NO_FILE, ConfigError, RawSettings, expects_robot_file
from giraff_node.network.discovery import Target, name_of, named, resolve_target, target_of
from giraff_tools.network.command import not_all_counts
from giraff_tools.network.pages import kept_pages
from giraff_tools.terminal.program import called_here

_NAME, _HOST, _ADDRESS = "NAME", "HOST", "ADDRESS"
_MEANING: Final = {
    _NAME: "the robot's name",
    _HOST: "the name in the certificate of the robot's host",
    _ADDRESS: "where that host is reached",
}
"""What stands in the command for what cannot be known here."""


class StopPlan(NamedTuple):
    """The network on which a stop is tried, and the words that follow it."""

    target: Target | None
    """None: nowhere, for the network looks secured, and its rules are not known."""
    doubt: str
    """Why a robot that answers may be another than the one that is meant; empty: it is the one."""
    complaint: str
    """The fault of file or environment, with the remedy; empty: there is none."""


def plan_stop(robot: str | None, connect: Sequence[str], environment: Mapping[str, str] = os.environ) -> StopPlan:
    """Plan a `giraff stop`. Raises NoRobotError where the command line names no possible robot.

    A network that looks secured is tried with certificates alone: an open session would ask a stranger's robot.
    """
    try:
        sound = resolve_target(robot, connect, environment)
    except ConfigError as error:
        fault = str(error)
    else:
        if sound.example and kept_pages(sound.example):  # somebody has visited that robot, and may mean it
            sound = dataclasses.replace(sound, filed=sound.example)
        return StopPlan(sound, "", not_all_counts(sound.warning) if sound.warning else "")
    found = read_what_is_left(robot, environment)
    target = _target(robot, connect, environment, found)
    return StopPlan(
        target,
        f"whether it is yours is not known: {_unusable(robot, environment)} cannot be read",
        f"{fault}; {_way_to_stop(robot, connect, environment, found, is_tried=target is not None)}",
    )


def _target(
    robot: str | None, connect: Sequence[str], environment: Mapping[str, str], found: Readable
) -> Target | None:
    """Aim at what can be read. None: it looks secured, and nobody knows its rules."""
    try:
        network = msgspec.convert(found.network, NetworkConfig, strict=False)
    except msgspec.ValidationError:
        return None
    name, filed = robot or "", ""
    with contextlib.suppress(ConfigError):  # without a name, every robot that is heard is asked
        if not found.is_name_doubted:
            name, filed = named(found.given, robot, environment)
    return target_of(name, connect, network, filed=filed)


def _unusable(robot: str | None, environment: Mapping[str, str]) -> str:
    """Name the robot file if it is at fault by itself, else the environment."""
    files = {name: value for name, value in environment.items() if name == "GIRAFF_CONFIG"}
    try:
        resolve_target(robot, (), files)
    except ConfigError:
        return files.get("GIRAFF_CONFIG") or str(DEFAULT_FILE)
    return "the environment"


def _way_to_stop(
    robot: str | None, connect: Sequence[str], environment: Mapping[str, str], found: Readable, *, is_tried: bool
) -> str:
    """Return the command that stops the robot without its robot file, and what else to do, in one line.

    The command is told all that can still be read of the network: it is to reach the robot, and no other.
    """
    given, is_lost, doubted, network, in_doubt, is_name_doubted = found
    if network.get("mode") == "secured" and not (network.get("session_file") or "access" in network):
        network = {"access": {"robot": [_HOST]}, **network}
        # A file that can be read has the address, or stands on the robot's host, which needs none.
        is_far = is_lost or not expects_robot_file(environment)
        if is_far and not (connect or network.get("connect") or network.get("router")):
            connect = (_ADDRESS,)
    name = robot or (_NAME if is_name_doubted else _name(given, is_lost=is_lost))
    settings = {f"GIRAFF_NETWORK_{field.upper()}": _text(value) for field, value in network.items()}
    wrong = {each.variable for each in (*given.strange, *doubted) if each.variable}
    other = {each for each in given.variables if each.upper().startswith(("GIRAFF_NETWORK_", "GIRAFF_ROBOT_"))}
    unset = sorted((wrong | other) - settings.keys())
    command = ["env", *(word for each in unset for word in ("-u", each)), f"GIRAFF_CONFIG={NO_FILE}"]
    command += [f"{variable}={text}" for variable, text in settings.items()]
    command += [*called_here(), "stop", *(["--robot", name] if name else [])]
    command += [word for address in connect for word in ("--connect", address)]
    stopped = "NOTHING IS STOPPED FOR SURE" if is_tried else "NOTHING IS STOPPED"
    told = [f"{stopped}: use the battery switch, or without the file: {shlex.join(command)}"]
    told += [f"{word}: {meaning}" for word, meaning in _MEANING.items() if word in (name, *connect)]
    if network.get("access") == {"robot": [_HOST]}:
        told.append(f"{_HOST}: {_MEANING[_HOST]}")
    if network.get("mode") != "secured":
        told += ["a secured network takes more: docs/estop.md"] * in_doubt
    elif not has_bundle(keys := Path(network.get("keys", NetworkConfig().keys))):
        told.append(f"the network is secured, and this host's keys are not in {keys}")
    return "; ".join(told)


def _name(given: RawSettings, *, is_lost: bool) -> str:
    """The robot's; empty: nobody has named one."""
    try:
        return name_of(given) or (_NAME if is_lost else "")
    except ConfigError:
        return _NAME


def _text(value: Any) -> str:
    """As a variable holds it."""
    import tomlkit  # noqa: PLC0415  a plan without a complaint does not wait for it

    if isinstance(value, dict):
        table = tomlkit.inline_table()
        table.update(value)
        return table.as_string()
    return value if isinstance(value, str) else tomlkit.item(value).as_string()

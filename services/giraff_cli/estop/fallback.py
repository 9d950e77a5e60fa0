"""How to stop a robot where robot file or environment cannot be used: a command line that says what they should."""

from __future__ import annotations

import contextlib
import os
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import msgspec
import tomlkit

from giraff_cli.terminal.program import called_here
from giraff_core.network import NetworkConfig
from giraff_node.config.misplaced import find_misplaced
from giraff_node.config.robot_file import NO_FILE, ConfigError, RawSettings, expects_robot_file, read
from giraff_node.network.discovery import name_of
from giraff_node.network.session import CERTIFICATES

_NAME, _HOST, _ADDRESS = "NAME", "HOST", "ADDRESS"
_MEANING: Final = {
    _NAME: "the robot's name",
    _HOST: "the name in the certificate of the robot's host",
    _ADDRESS: "where that host is reached",
}
"""What stands in the command for what cannot be known here."""


def way_to_stop(robot: str | None, connect: Sequence[str], environment: Mapping[str, str] = os.environ) -> str:
    """What to do in the place of a `giraff estop engage` that was refused, in one line.

    The command is told all that can still be read of the network: it is to reach the robot, and no other.
    """
    given, is_lost = _given(environment)
    doubted = find_misplaced(given, environment, is_named=bool(robot))
    is_lost = is_lost or bool(doubted)
    values = given.tables.get("network", {})
    network = _sound(values)
    in_doubt = is_lost or len(network) < len(values)
    keys = Path(network.get("keys", NetworkConfig().keys))
    if in_doubt and "mode" not in network and (_seems_secured(values, keys) or "secur" in str(doubted).lower()):
        network = {"access": {"robot": [_HOST]}, **network, "mode": "secured"}
        is_far = is_lost or not expects_robot_file(
            environment
        )  # else the file has what it takes, if only on the robot's host
        if is_far and not (connect or network.get("connect") or network.get("router")):
            connect = (_ADDRESS,)
    is_name_doubted = len(doubted) > len(find_misplaced(given, environment, is_named=True))
    name = robot or (_NAME if is_name_doubted else _name(given, is_lost=is_lost))
    settings = {f"GIRAFF_NETWORK_{field.upper()}": _text(value) for field, value in network.items()}
    wrong = {each.variable for each in (*given.strange, *doubted) if each.variable}
    other = {each for each in given.variables if each.upper().startswith(("GIRAFF_NETWORK_", "GIRAFF_ROBOT_"))}
    unset = sorted((wrong | other) - settings.keys())
    command = ["env", *(word for each in unset for word in ("-u", each)), f"GIRAFF_CONFIG={NO_FILE}"]
    command += [f"{variable}={text}" for variable, text in settings.items()]
    command += [*called_here(), "estop", "engage", *(["--robot", name] if name else [])]
    command += [word for address in connect for word in ("--connect", address)]
    told = [f"NOTHING IS STOPPED: use the battery switch, or without the file: {shlex.join(command)}"]
    told += [f"{word}: {meaning}" for word, meaning in _MEANING.items() if word in (name, *connect)]
    if network.get("access") == {"robot": [_HOST]}:
        told.append(f"{_HOST}: {_MEANING[_HOST]}")
    if network.get("mode") != "secured":
        told += ["a secured network takes more: docs/estop.md"] * in_doubt
    elif not _has_bundle(keys):
        told.append(f"the network is secured, and this host's keys are not in {keys}")
    return "; ".join(told)


def _given(environment: Mapping[str, str]) -> tuple[RawSettings, bool]:
    """What can be read, and whether the robot file cannot."""
    try:
        return read(environment, with_file=expects_robot_file(environment)), False
    except ConfigError:
        return read(environment, with_file=False), True


def _sound(values: Mapping[str, Any]) -> dict[str, Any]:
    """The fields of [network] that can be used."""
    sound: dict[str, Any] = {}
    for field in reversed(NetworkConfig.__struct_fields__):  # one that asks for another comes after it
        if field in values:
            tried = sound | {field: values[field]}
            try:
                msgspec.convert(tried, NetworkConfig, strict=False)
            except msgspec.ValidationError:
                continue
            sound = tried
    return sound


def _seems_secured(values: Mapping[str, Any], keys: Path) -> bool:
    """Without a mode: by what else says so."""
    return "access" in values or "secur" in str(values.get("mode")).lower() or _has_bundle(keys)


def _has_bundle(keys: Path) -> bool:
    with contextlib.suppress(OSError):  # one may not look: what is there is of no use
        return all((keys / name).is_file() for name in CERTIFICATES.values())
    return False


def _name(given: RawSettings, *, is_lost: bool) -> str:
    """The robot's; empty: nobody has named one."""
    try:
        return name_of(given) or (_NAME if is_lost else "")
    except ConfigError:
        return _NAME


def _text(value: Any) -> str:
    """As a variable holds it."""
    if isinstance(value, dict):
        table = tomlkit.inline_table()
        table.update(value)
        return table.as_string()
    return value if isinstance(value, str) else tomlkit.item(value).as_string()

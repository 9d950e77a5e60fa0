"""What can still be read of a robot file and an environment that cannot be used."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from giraff_core.network import NetworkConfig
from giraff_node.config.misplaced import find_misplaced
from giraff_node.config.robot_file import (
    ConfigError,
    RawSettings,
    UnknownEntry,
    expects_robot_file,
    parse_toml,
    read,
    robot_file,
)
from giraff_node.network.session import CERTIFICATES

_SECURED: Final = re.compile(r"secur|tls|\baccess\b", re.IGNORECASE)
"""Words of a secured network."""


class Readable(NamedTuple):
    """What can still be read of robot file and environment."""

    given: RawSettings
    is_lost: bool
    """The robot file is no TOML, or cannot be read."""
    doubted: list[UnknownEntry]
    network: dict[str, Any]
    """The fields of [network] that can be used; its mode is `secured` where it looks so."""
    in_doubt: bool
    is_name_doubted: bool


def read_what_is_left(robot: str | None, environment: Mapping[str, str]) -> Readable:
    """Read all that can be used. Anything that looks secured makes the network a secured one."""
    text = ""
    try:
        given, is_lost = read(environment, with_file=expects_robot_file(environment)), False
    except ConfigError:
        given, is_lost = read(environment, with_file=False), True
        text = re.sub(r"#.*", "", _text_of_file(environment))
        salvaged = _without_contradiction(_salvaged(text), text)
        given = given._replace(tables=given.tables | {"network": salvaged | given.tables.get("network", {})})
    doubted = find_misplaced(given, environment, is_named=bool(robot))
    values = given.tables.get("network", {})
    network = _sound(values)
    unsound = str(doubted) + str({field: value for field, value in values.items() if field not in network})
    network = _without_contradiction(network, unsound)
    in_doubt = is_lost or bool(doubted) or len(network) < len(values)
    keys = Path(network.get("keys", NetworkConfig().keys))
    is_secured = "access" in values or bool(_SECURED.search(unsound + text)) or has_bundle(keys)
    if in_doubt and "mode" not in network and is_secured:
        network = {**network, "mode": "secured"}
    is_name_doubted = len(doubted) > len(find_misplaced(given, environment, is_named=True))
    return Readable(given, is_lost, doubted, network, in_doubt, is_name_doubted)


def _without_contradiction(values: Mapping[str, Any], other: str) -> dict[str, Any]:
    """Leave out the mode of an open network if another text says that the network is secured."""
    is_contradicted = values.get("mode") != "secured" and "secur" in other.lower()
    return {field: value for field, value in values.items() if not (is_contradicted and field == "mode")}


def _text_of_file(environment: Mapping[str, str]) -> str:
    """The robot file, whatever its letters are; empty: it cannot be read."""
    try:
        return robot_file(environment).read_bytes().decode(errors="replace")
    except (ConfigError, OSError):
        return ""


def _salvaged(text: str) -> dict[str, Any]:
    """Read [network] and the tables in it from a file that is no TOML: each whole, or else those lines that are."""
    network: dict[str, Any] = {}
    for section in re.split(r"^(?=[ \t]*\[)", text, flags=re.MULTILINE):
        if re.match(r"[ \t]*\[[ \t]*network\b", section):
            header, *lines = section.splitlines()
            if not _take(section, network):
                for line in lines:
                    _take(f"{header}\n{line}", network)
    return network


def _take(text: str, network: dict[str, Any]) -> bool:
    """Add to `network` what the text says of it. False: it is no TOML."""
    try:
        told = parse_toml(text).get("network")
    except ValueError:
        return False
    if isinstance(told, dict):
        _merge(network, told)
    return True


def _merge(into: dict[str, Any], more: Mapping[str, Any]) -> None:
    for name, value in more.items():
        if isinstance(value, dict) and isinstance(into.get(name), dict):
            _merge(into[name], value)
        elif isinstance(value, list) and isinstance(into.get(name), list):
            into[name] = into[name] + value
        else:
            into[name] = value


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


def has_bundle(keys: Path) -> bool:
    with contextlib.suppress(OSError):  # one may not look: what is there is of no use
        return all((keys / name).is_file() for name in CERTIFICATES.values())
    return False

"""Read what is left of a robot file and an environment that cannot be used."""

import contextlib
import difflib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import (
    ConfigError,
    RawSettings,
    UnknownEntry,
    expects_robot_file,
    parse_toml,
    read,
    robot_file,
)
from giraff_node.config.typos import find_misplaced
from giraff_node.network.reach import address_fault
from giraff_node.network.session import CERTIFICATES

_OPEN: Final = ("lan", "fixed")
"""Modes of an open network."""
_WORD: Final = re.compile(r"[^\W_]+")
_ENTRY: Final = re.compile(r"""(?<![^\W_])([^\W_]+)["']?[ \t]*[=:][ \t]*["']*([^"'\n,}#]*)""")
"""The last word of a key, and its value as far as one line has it: of TOML, or of a `dict` as text."""
_ALIKE: Final = 0.75
"""Share of common letters from which on a word counts as another one mistyped."""


class Readable(NamedTuple):
    """The readable part of robot file and environment."""

    given: RawSettings
    is_lost: bool
    """The robot file is no TOML, or cannot be read."""
    doubted: list[UnknownEntry]
    network: dict[str, Any]
    """The fields of [network] that can be used; its mode is `secured` where it looks so."""
    in_doubt: bool
    is_name_doubted: bool


def read_what_is_left(robot: str | None, environment: Mapping[str, str]) -> Readable:
    """Read all that can be used. A network whose mode is not known is secured if anything looks secured."""
    text = ""
    try:
        given, is_lost = read(environment, with_file=expects_robot_file(environment)), False
    except ConfigError:
        given, is_lost = read(environment, with_file=False), True
        text = _text_of_file(environment)
        salvaged = _without_contradiction(_salvaged(text), text)
        given = given._replace(tables=given.tables | {"network": salvaged | given.tables.get("network", {})})
    doubted = find_misplaced(given, environment, is_named=bool(robot))
    values = given.tables.get("network", {})
    network = _sound(values)
    misplaced = [{entry.word: entry.value} for entry in doubted]
    unsound = str([*misplaced, {field: value for field, value in values.items() if network.get(field) != value}])
    network = _without_contradiction(network, unsound)
    in_doubt = is_lost or bool(doubted) or network != values
    keys = Path(network.get("keys", NetworkConfig().keys))
    is_secured = _looks_secured(f"{misplaced}\n{values}\n{text}") or has_bundle(keys)
    if in_doubt and "mode" not in network and is_secured and not network.get("session_file"):
        network = {**network, "mode": "secured"}
    is_name_doubted = len(doubted) > len(find_misplaced(given, environment, is_named=True))
    return Readable(given, is_lost, doubted, network, in_doubt, is_name_doubted)


def _without_contradiction(values: Mapping[str, Any], other: str) -> dict[str, Any]:
    """Leave out the mode of an open network if another text says that the network is secured."""
    is_contradicted = values.get("mode") != "secured" and _names_secured_mode(other)
    return {field: value for field, value in values.items() if not (is_contradicted and field == "mode")}


def _names_secured_mode(text: str) -> bool:
    """Tell whether the text says "secured" anywhere, or has a mode that is none of an open network."""
    text = text.lower()
    modes = [value.strip() for key, value in _ENTRY.findall(text) if _is_any({key}, "mode")]
    return "secur" in text or _is_any(_WORD.findall(text), "secured") or not all(map(_is_open, modes))


def _is_open(mode: str) -> bool:
    """Tell whether a mode is one of an open network, as it stands or as the complaint asks: "did you mean 'lan'?"."""
    close = difflib.get_close_matches(mode, (*_OPEN, "secured"), n=1)
    return bool(close) and close[0] in _OPEN


def _looks_secured(text: str) -> bool:
    """Tell whether anything in the text belongs to a secured network, mistyped or not."""
    text = text.lower()
    return _names_secured_mode(text) or "tls" in text or _is_any(_WORD.findall(text), "access", "keys", "session")


def _is_any(words: Iterable[str], *known: str) -> bool:
    """Tell whether one of the words is a known one, or may be one mistyped."""
    return any(difflib.get_close_matches(word, known, n=1, cutoff=_ALIKE) for word in set(words))


def _text_of_file(environment: Mapping[str, str]) -> str:
    """Return the robot file without lines that are comments; empty: it cannot be read.

    Without zero bytes and the mark of an editor, UTF-16 and UTF-32 read like UTF-8.
    """
    try:
        content = robot_file(environment).read_bytes()
    except (ConfigError, OSError):
        return ""
    text = content.replace(b"\0", b"").decode(errors="replace").lstrip("\ufeff\ufffd")
    # A "#" behind something may stand in a text: what follows it counts.
    return "\n".join(line for line in text.splitlines() if not line.lstrip().startswith("#"))


def _salvaged(text: str) -> dict[str, Any]:
    """Read [network] and the tables in it from a file that is no TOML: each whole, or else those lines that are."""
    network: dict[str, Any] = {}
    for section in re.split(r"^(?=[ \t]*\[)", text, flags=re.MULTILINE):
        if re.match(r"[ \t]*\[[ \t]*network\b", section):
            header, *lines = section.splitlines()
            if not _merge_text(section, network):
                for line in lines:
                    _merge_text(f"{header}\n{line}", network)
    return network


def _merge_text(text: str, network: dict[str, Any]) -> bool:
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
            value = values[field]
            if field == "connect" and isinstance(value, list):  # a robot at a sound address is stopped all the same
                value = [each for each in value if not address_fault(str(each))]
            tried = sound | {field: value}
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

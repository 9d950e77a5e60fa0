"""The kinds of TOML files that people write or get. Each is recognized by the tables and fields that it alone has."""

from __future__ import annotations

from collections.abc import Container
from typing import Final, NamedTuple

from giraff_schemas.services import SERVICES


class TomlKind(NamedTuple):
    """One kind of file."""

    name: str
    entries: tuple[str, ...]
    """Names at the top of a file that no other kind has."""
    use: str
    """Where to give such a file instead."""


_TABLES: Final = tuple(service.table for service in SERVICES if service.table)
ROBOT_FILE: Final = TomlKind(
    "a robot file", ("robot", "network", *_TABLES, "sim"), "give it by --file or GIRAFF_CONFIG"
)
ROOM: Final = TomlKind(
    "a room", ("start", "waypoints", "walls", "posts", "thresholds"), "give it by `giraff run --world` or --map"
)
PATTERN: Final = TomlKind("a pattern of steps", ("step",), "drive it by `giraff go`")
_KEY_BUNDLE: Final = TomlKind(
    "the note beside a host's keys", ("made", "expires"), "let keys in [network] name its folder"
)


def wrong_kind(given: Container[str], wanted: TomlKind) -> str:
    """Return why a file with these names at its top is of another kind than `wanted`. Empty: it need not be."""
    kinds = (ROBOT_FILE, ROOM, PATTERN, _KEY_BUNDLE)
    found = [kind for kind in kinds if any(entry in given for entry in kind.entries)]
    if len(found) != 1 or found[0] is wanted:
        return ""
    return f"it is {found[0].name}, not {wanted.name}; {found[0].use}, and name {wanted.name} here"

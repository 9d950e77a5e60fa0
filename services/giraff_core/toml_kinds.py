"""The kinds of TOML files that people write or get. Each is recognized by the tables and fields that it alone has."""

from collections.abc import Container
from typing import Final

from giraff_schemas.services import ROBOT_TABLES

ROBOT_FILE: Final = "a robot file"
ROOM: Final = "a room"
PATTERN: Final = "a pattern of steps"
_KINDS: Final = {
    ROBOT_FILE: (ROBOT_TABLES, "give it by --file or GIRAFF_CONFIG"),
    ROOM: (("start", "waypoints", "walls", "posts", "thresholds"), "give it by `giraff run --world` or --map"),
    PATTERN: (("step",), "drive it by `giraff go`"),
}
"""By kind: names at the top of a file that no other kind has, and where to give such a file instead."""


def wrong_kind(given: Container[str], wanted: str) -> str:
    """Return why a file with these names at its top is of another kind than `wanted`. Empty: it need not be."""
    found = [kind for kind, (entries, _) in _KINDS.items() if any(entry in given for entry in entries)]
    if len(found) != 1 or found[0] == wanted:
        return ""
    return f"it is {found[0]}, not {wanted}; {_KINDS[found[0]][1]}, and name {wanted} here"

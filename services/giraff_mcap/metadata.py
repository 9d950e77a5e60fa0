"""What a recording says of where it is from."""

import platform
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Final

import msgspec

from giraff_mcap.writing import FORMAT_FIELD
from giraff_node.config.robot_file import ConfigError, read_tables
from giraff_schemas.format import FORMAT

ASKED: Final = "asked"
"""Field of a recording whose recorder has asked the services for their parameters."""
_SECRETS = "network"  # where keys lie and who may do what is nobody's business who is given a recording


def metadata_of(robot: str) -> dict[str, str]:
    """Return the metadata of a recording that begins now on this machine.

    `tables`: the robot file with this host's overrides, as JSON.
    """
    told = {
        "robot": robot,
        FORMAT_FIELD: str(FORMAT),
        "version": _version("giraff"),
        "zenoh": _version("eclipse-zenoh"),
        "host": platform.node(),
        "began": datetime.now(UTC).isoformat(timespec="seconds"),
    }
    try:
        tables = read_tables()
    except ConfigError:  # on a desk there is none
        return told
    if tables.get("robot", {}).get("name", robot) != robot:  # of another robot than this
        return told
    tables.pop(_SECRETS, None)
    return told | {"tables": msgspec.json.encode(tables).decode()}


def _version(distribution: str) -> str:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return "unknown"

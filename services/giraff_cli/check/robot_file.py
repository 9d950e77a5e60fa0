"""What a check has found out, written into the robot file. Comments, order and everything else stay."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from giraff_node.process.state import write_file_durably


class RobotFileError(Exception):
    """The file cannot be written. It is as it was."""


def record(path: Path, table: str, fields: Mapping[str, bool]) -> None:
    """Set these fields of a table: the file has all of them and all it had, or is untouched."""
    try:
        before = path.read_text()
        document = tomlkit.parse(before)
        section: Any = document[table]
        for name, value in fields.items():
            section[name] = value
        after = tomlkit.dumps(document)
        _require_only(tomllib.loads(before), tomllib.loads(after), table, fields)
        write_file_durably(path, after.encode())
    except (OSError, TOMLKitError, tomllib.TOMLDecodeError, KeyError, TypeError, ValueError) as error:
        wanted = "".join(f"\n    {name} = {str(value).lower()}" for name, value in fields.items())
        raise RobotFileError(f"{path}: cannot be written: {error}; write into [{table}] by hand:{wanted}") from error


def _require_only(before: dict[str, Any], after: dict[str, Any], table: str, fields: Mapping[str, bool]) -> None:
    """ValueError unless nothing but the fields is different."""
    if after != {**before, table: {**before[table], **fields}}:
        raise ValueError("something else would change with it")

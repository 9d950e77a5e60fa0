"""What a command has found out, written into the robot file. Comments, order and everything else stay."""

import contextlib
import datetime as dt
import os
import re
import stat
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import tomlkit
from tomlkit.exceptions import TOMLKitError

from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import ConfigError, load, path_of, read, robot_file
from giraff_node.network.discovery import name_of
from giraff_node.process.state import write_file_durably
from giraff_schemas.text import plain

Value = bool | float | str | Sequence[float] | Sequence[Sequence[float]]

_ERRORS: Final = (OSError, TOMLKitError, tomllib.TOMLDecodeError, KeyError, TypeError, ValueError)


class RobotFileError(Exception):
    """The file cannot be written. It is as it was."""


def own_robot_file(robot: str, given: Path | None) -> tuple[Path, RobotConfig]:
    """Return where the robot file of `robot` is, and what it says; of an empty name, this machine's.

    `given`: the file that a person has named for it. Raises ConfigError where it cannot be read, or not be written, or
    where this machine's is another robot's.
    """
    environment = os.environ if given is None else {**os.environ, "GIRAFF_CONFIG": str(given)}
    path, filed = robot_file(environment), load("robot", RobotConfig, environment)
    named = name_of(read({"GIRAFF_CONFIG": str(path)}))
    if given is None and robot not in {"", named}:
        raise ConfigError(
            f"{path} is the robot file of {named or 'no robot'}, and {robot} is heard; name the file that is to be "
            f"written for {robot}: --file FILE"
        )
    if not (os.access(path, os.W_OK) and os.access(path.parent, os.W_OK)):
        raise ConfigError(f"{path} or its folder cannot be written; call it as a user who may write there")
    return path, filed


def before_today() -> str:
    """Return what a file that is written today is kept as: before, and the date."""
    return f"before-{dt.datetime.now().astimezone().date().isoformat()}"


def record(path: Path, table: str, fields: Mapping[str, Value], *, kept_as: str = "") -> Path | None:
    """Set these fields of a table: the file has all of them and all it had, or is untouched.

    `table`: like robot, which must be there, or robot.calibration, the last of which is made where it is missing.
    `kept_as`: the file as it was stays beside it, as robot.toml.KEPT_AS; with a number after it where there is one of
    that name already. Returns where.
    """
    return record_all(path, {table: fields}, kept_as=kept_as)


def record_all(path: Path, tables: Mapping[str, Mapping[str, Value]], *, kept_as: str = "") -> Path | None:
    """Set fields of several tables as `record` does: the file has all of them, or is untouched."""
    with _explained(path, tables):
        before = path.read_bytes()
        after = _rewritten(before, tables)
        kept = keep(path, before, kept_as) if kept_as else None
        try:
            write_file_durably(path, after)
        except OSError:
            with contextlib.suppress(OSError):
                if kept is not None and path.read_bytes() == before:
                    kept.unlink()
            raise
    return kept


def document(path: Path, tables: Mapping[str, Mapping[str, Any]], kept: Path | None) -> dict[str, Any]:
    """Return what programs are told of tables that `record_all` has written."""
    return {"robot_file": str(path), "tables": tables, "as_before": None if kept is None else str(kept)}


def rehearse(path: Path, tables: Mapping[str, Mapping[str, Value]]) -> None:
    """Raise RobotFileError where the form of the file does not let `record_all` write these tables. Writes nothing."""
    try:
        _rewritten(path.read_bytes(), tables)
    except _ERRORS as error:
        names = ", ".join(f"[{table}]" for table in tables)
        raise RobotFileError(
            f"{path}: takes no {names}: {plain(error)}; write it, and the table above it, as tables of their own, as "
            "deploy/robot.toml does"
        ) from error


def still_overriding(tables: Mapping[str, Iterable[str]], environment: Mapping[str, str]) -> str:
    """Return a sentence that names the variables which override these fields, or a table with them; empty: none."""
    written = {
        path_of(f"GIRAFF_{first}_{'__'.join((*inner, field))}")
        for table, fields in tables.items()
        for first, *inner in [table.split(".")]
        for field in fields
    }
    names = [name for name in sorted(environment) if name.startswith("GIRAFF_")]
    found = [name for name in names if any(path[: len(path_of(name))] == path_of(name) for path in written)]
    return f"These variables of the environment still override it: {', '.join(found)}." if found else ""


def _rewritten(before: bytes, tables: Mapping[str, Mapping[str, Value]]) -> bytes:
    text = before.decode("utf-8-sig")
    mark = before.removesuffix(text.encode())  # of byte order, where an editor has left one
    after, wanted = text, tomllib.loads(text)
    for table, fields in tables.items():
        after, wanted = _with(after, table, fields), _merged(wanted, table.split("."), fields)
    if tomllib.loads(after) != wanted:
        raise ValueError("something else would change with it")
    return mark + after.encode()


@contextlib.contextmanager
def _explained(path: Path, tables: Mapping[str, Mapping[str, Value]]) -> Iterator[None]:
    try:
        yield
    except _ERRORS as error:
        by_hand = "; ".join(
            f"write into [{table}] by hand:"
            + "".join(f"\n    {name} = {tomlkit.item(value).as_string()}" for name, value in fields.items())
            for table, fields in tables.items()
        )
        raise RobotFileError(f"{path}: cannot be written: {plain(error)}; {by_hand}") from error


def _with(text: str, table: str, fields: Mapping[str, Value]) -> str:
    """Lines end as they did; where all end as on Windows, so do those that are new."""
    document = tomlkit.parse(text)
    *above, last = table.split(".")
    section: Any = document
    for name in above:
        section = section[name]
    if above and last not in section:
        fresh = tomlkit.table()
        fresh.update(fields)
        fresh.add(tomlkit.nl())
        section[last] = fresh
    else:
        for name, value in fields.items():
            section[last][name] = value
    after = tomlkit.dumps(document)
    ends_as_on_windows = 0 < text.count("\n") == text.count("\r\n")
    return re.sub(r"(?<!\r)\n", "\r\n", after) if ends_as_on_windows else after


def _merged(was: Mapping[str, Any], table: Sequence[str], fields: Mapping[str, Any]) -> dict[str, Any]:
    """What the file is to say, and no more."""
    if not table:
        return {**was, **{name: list(value) if isinstance(value, tuple) else value for name, value in fields.items()}}
    first, *rest = table
    return {**was, first: _merged(was.get(first, {}), rest, fields)}


def keep(path: Path, data: bytes, kept_as: str) -> Path:
    """Write a copy beside a file, whole on disk, under a name that was free; return its path. Raises OSError."""
    path = path.resolve()
    number = 1
    while True:
        kept = path.with_name(f"{path.name}.{kept_as}{f'-{number}' if number > 1 else ''}")
        try:
            kept.touch(mode=stat.S_IMODE(path.stat().st_mode), exist_ok=False)
        except FileExistsError:
            number += 1
            continue
        try:
            write_file_durably(kept, data)
        except OSError:
            kept.unlink(missing_ok=True)
            raise
        return kept

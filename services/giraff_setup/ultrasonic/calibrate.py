"""`giraff calibrate ranger`: ultrasonic sensors by a wall, from the first distance to the robot file."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Final, Protocol

from giraff_core.robot import RobotConfig
from giraff_guard.config import GuardConfig
from giraff_node.config.robot_file import ConfigError, load
from giraff_setup.ultrasonic.conclusion import bounded, changed, in_words, placed, warning
from giraff_setup.ultrasonic.procedure import PINGS, Stand, StoppedError, measure
from giraff_setup.ultrasonic.stand import NetworkStand
from giraff_tools.network.command import run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.robot_file import (
    RobotFileError,
    before_today,
    document,
    own_robot_file,
    record_all,
    rehearse,
    still_overriding,
)
from giraff_tools.terminal.document import INTERRUPTED, REFUSED, UNUSABLE, Report, complain, no_report, print_report
from giraff_tools.terminal.human import Human, NobodyError, Terminal, agrees, introduce, signals_interrupt
from giraff_tools.terminal.output import DONE

_complain: Final = partial(complain, "calibrate ranger")
_FIELDS: Final = ("x", "y", "z", "yaw", "scale")
_THEN: Final = "Nothing goes by it yet: copy the file to the robot's other machines, and restart its services at rest."


class HeldRest(Stand, Protocol):
    """A robot before a wall whose motions hold a lease."""

    def wait_released(self) -> None:
        """Wait until giraff_motion has given the lease back. Raises StoppedError."""
        ...


def calibrate_ranger(robot: str | None, connect: Sequence[str], file: Path | None, *, as_json: bool = False) -> int:
    """Do the whole command; return its exit code. `file`: as of `own_robot_file`.

    `as_json`: the talk goes to standard error.
    """
    return print_report(lambda report: _calibrate(robot, connect, file, report), as_json=as_json)


def _calibrate(robot: str | None, connect: Sequence[str], file: Path | None, report: Report) -> int:
    def act(connection: RobotConnection) -> int:
        try:
            path, filed = own_robot_file(connection.robot, file)
            human = Terminal(sys.stdin, sys.stdout)
            stand = NetworkStand(connection)
            stand.place()
            introduce(human, connection.robot, path)
            return guide(human, stand, filed, path, report=report)
        except ConfigError as error:
            return _complain(str(error), UNUSABLE)
        except StoppedError as error:
            return _complain(f"{error}. Nothing was written.", UNUSABLE)
        except KeyboardInterrupt:
            return _interrupted()

    with signals_interrupt():
        try:
            return run_with_robot(robot, connect, act, moves=True, stands_in=False)  # it writes into the file
        except KeyboardInterrupt:  # before a robot was found
            return _interrupted()


def guide(
    human: Human,
    stand: HeldRest,
    filed: RobotConfig,
    path: Path,
    pings: int = PINGS,
    report: Report = no_report,
) -> int:
    """Measure, tell, ask and write into `path`, which says `filed`; return the exit code. Raises ConfigError."""
    guard = load("guard", GuardConfig, {**os.environ, "GIRAFF_CONFIG": str(path)})
    try:
        rehearse(
            path,
            {_table(name): {each: getattr(pose, each) for each in _FIELDS} for name, pose in filed.sensors.items()},
        )
    except RobotFileError as error:
        return _complain(str(error), UNUSABLE)
    try:
        tables = _measure(human, stand, filed, pings)
        if not tables:
            return _complain("nothing was found. Nothing was written.", REFUSED)
        if not agrees(human, f"Write {', '.join(tables)} into {path}? [yes/no]"):
            return _complain("not wanted. Nothing was written.", REFUSED)
        now = filed
        for name, fields in list(tables.items()):
            then = placed(now, name, fields)
            words = warning(name, now, then, guard)
            if words and not agrees(human, f"{words} Write it all the same? [yes/no]"):
                human.show(f"{name} stays as it is.")
                del tables[name]
            else:
                now = then
        if not tables:
            return _complain("not wanted. Nothing was written.", REFUSED)
        stand.wait_released()
    except StoppedError as error:
        return _complain(f"{error}. Nothing was written.", REFUSED)
    except NobodyError:
        return _complain("nobody answers. Nothing was written.", UNUSABLE)
    return _write(human, tables, path, report)


def _measure(human: Human, stand: Stand, filed: RobotConfig, pings: int) -> dict[str, dict[str, float]]:
    """Return the fields to write of each sensor that was found."""
    tables = {}
    for name, measured in measure(human, stand, filed, pings).items():
        before = filed.sensors[name]
        told = bounded(before, measured)
        human.show(in_words(before, name, told))
        if fields := changed(before, told):
            tables[name] = fields
    return tables


def _write(human: Human, tables: Mapping[str, Mapping[str, float]], path: Path, report: Report) -> int:
    """Write all at once."""
    named = {_table(name): fields for name, fields in tables.items()}
    try:
        kept = record_all(path, named, kept_as=before_today())
    except RobotFileError as error:
        return _complain(str(error), REFUSED)
    report(document(path, named, kept))
    human.show(f"Written: {', '.join(tables)} in {path}; as it was before: {kept}. {_THEN}")
    if overriding := still_overriding(named, os.environ):
        human.show(overriding)
    return DONE


def _table(name: str) -> str:
    return f"robot.sensors.{name}"


def _interrupted() -> int:
    return _complain("interrupted. Nothing was written.", INTERRUPTED)

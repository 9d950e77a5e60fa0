"""`giraff tune speed`: a short drive tells the motors of two wheels, and the robot file is told their gains."""

import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Final, Protocol, Self

from giraff_base.config import BaseConfig
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_core.robot import RobotConfig
from giraff_node.config.robot_file import ConfigError, load
from giraff_node.process.state import write_file_durably
from giraff_schemas.messages import Wheels
from giraff_schemas.text import printable
from giraff_setup.wheels.speed.drive import SpeedDrive, UnfitDriveError
from giraff_setup.wheels.speed.fit import (
    DISTANCE,
    RULE,
    CannotTellError,
    Follow,
    Leg,
    fastest,
    follow,
    legs_of,
    measure,
)
from giraff_setup.wheels.speed.report import tell_changes, tell_drive, tell_fastest, tell_follow, tell_motors
from giraff_tools.network.command import UNUSABLE, print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.robot_file import (
    RobotFileError,
    Value,
    before_today,
    document,
    own_robot_file,
    record,
    rehearse,
    still_overriding,
)
from giraff_tools.terminal.document import INTERRUPTED, REFUSED, Report, no_report, print_report
from giraff_tools.terminal.dots import takes_dots
from giraff_tools.terminal.human import Human, NobodyError, Terminal, agrees, signals_interrupt
from giraff_tools.terminal.output import DONE
from giraff_tools.terminal.program import user_at_host

_FREE: Final = DISTANCE + 0.1  # m
_NOT_KEPT: Final = "No gains were changed for good."
TABLE: Final = "base.drive.speed_control"


class Driven(Protocol):
    """Drives the robot, and hears its wheels."""

    wheels: list[Wheels]
    voltage: float | None

    def drive(self) -> None: ...
    def goes_by(self, gains: Mapping[str, float]) -> bool: ...


def tune_speed(robot: str | None, connect: Sequence[str], file: Path | None, *, as_json: bool = False) -> int:
    """Return the exit code of the whole command. `file`: as of `own_robot_file`.

    `as_json`: the talk goes to standard error.
    """
    return print_report(lambda report: _tune(robot, connect, file, report), as_json=as_json)


def _tune(robot: str | None, connect: Sequence[str], file: Path | None, report: Report) -> int:
    def act(connection: RobotConnection) -> int:
        try:
            path, filed = own_robot_file(connection.robot, file)
            drive = drive_of(path)
            present = {name: getattr(drive.speed_control, name) for name in RULE}
            rehearse(path, {TABLE: present})
            driven = SpeedDrive(connection, user_at_host())
            if not driven.wait():
                return complain(
                    f"no wheels of {connection.robot} are heard; check that giraff_base runs, and the network to it",
                    UNUSABLE,
                )
            if not driven.goes_by(present):
                return complain(
                    f"base does not say that it goes by the gains of {path}; restart it with this file. "
                    f"If a trial was killed, the file as it was is {path.name}.before-DATE",
                    UNUSABLE,
                )
            return converse(Terminal(sys.stdin, sys.stdout), driven, connection.robot, filed, drive, path, report)
        except (ConfigError, RobotFileError) as error:
            return complain(str(error), UNUSABLE)
        except KeyboardInterrupt:
            return complain(f"interrupted. {_NOT_KEPT}", INTERRUPTED)

    with signals_interrupt():
        try:
            return run_with_robot(robot, connect, act, moves=True, stands_in=False)  # it writes into the file
        except KeyboardInterrupt:  # before a robot was found
            return complain(f"interrupted. {_NOT_KEPT}", INTERRUPTED)


def drive_of(path: Path) -> WheelsConfig:
    """Return the robot file's drive. Raises ConfigError where its board holds no speeds."""
    drive = load("base", BaseConfig, {**os.environ, "GIRAFF_CONFIG": str(path)}).drive
    if not isinstance(drive, WheelsConfig):
        raise ConfigError(f"{path}: drive.type is no 'wheels': a robot that balances has its own giraff tune balance")
    if not drive.asks_for_speeds:
        raise ConfigError(
            f"{path}: wheel_control is '{drive.wheel_control}', so that the board holds no speeds and has no gains; "
            'write wheel_control = "speed" into [base.drive] and restart base '
            "(docs/commissioning.md, Speeds that are held)"
        )
    return drive


def converse(
    human: Human,
    driven: Driven,
    robot: str,
    filed: RobotConfig,
    drive: WheelsConfig,
    path: Path,
    report: Report = no_report,
) -> int:
    """Ask, drive, tell, ask and write; the exit code."""
    human.show(
        f"Robot {robot}; what is found goes into {path}. It drives {DISTANCE:g} m straight ahead and back, "
        "on the floor it will live on, and once more if it finds better gains. Ctrl-C stops it."
    )
    try:
        if not agrees(human, f"Are {_FREE:g} m ahead of it free? [yes/no]"):
            return complain(f"nothing has moved. {_NOT_KEPT}", REFUSED)
        legs = _drive(driven, filed)
        _print_lines(tell_drive(legs, dots=takes_dots()))
        motors, proposal = measure(legs, drive.speed_control)
        _print_lines(["", *tell_motors(legs, motors), ""])
        ratio = driven.voltage / drive.battery_nominal if driven.voltage else 1.0
        if text := tell_fastest(
            fastest(motors, drive.max_level, ratio),
            filed.max_wheel_speed,
            drive.max_level,
            battery_known=bool(driven.voltage),
        ):
            human.show(text)
        before, changes = follow(legs), proposal.changes(drive.speed_control)
        if before.is_good or not changes:
            human.show(f"Keep what the file has: it drives as well as a drive can tell. {_NOT_KEPT}")
            return DONE
        _print_lines(tell_changes(changes, proposal.bound))
        if not agrees(human, f"Write into [{TABLE}] of {path}, for a second drive to judge them? [yes/no]"):
            return complain(f"not wanted. {_NOT_KEPT}", REFUSED)
        found = {name: after for name, (_, after) in changes.items()}
        return _judge(human, driven, filed, path, found, before, report)
    except (UnfitDriveError, CannotTellError) as error:
        return complain(f"{error}. {_NOT_KEPT}", REFUSED)
    except NobodyError:
        return complain(f"nobody answers. {_NOT_KEPT}", UNUSABLE)
    except RobotFileError as error:
        first, *by_hand = str(error).splitlines()
        complain(first, REFUSED)
        for line in by_hand:
            print(printable(line), file=sys.stderr, flush=True)
        return REFUSED


def _judge(
    human: Human,
    driven: Driven,
    filed: RobotConfig,
    path: Path,
    found: Mapping[str, float],
    before: Follow,
    report: Report,
) -> int:
    """Drive with gains that only a better drive leaves in the file; the exit code."""
    with Trial(human, path, found) as trial:
        human.show(
            f"Written: [{TABLE}] of {path}; as it was before: {trial.copy}. "
            "Restart base now, with the robot at rest, so that it goes by them."
        )
        if overriding := still_overriding({TABLE: found}, os.environ):
            human.show(overriding)
        while agrees(human, f"Is base restarted, and are {_FREE:g} m ahead free again? [yes/no]"):
            if driven.goes_by(found):
                break
            human.show(f"base does not say that it goes by them; restart it with {path}.")
        else:
            return complain("the gains found are not tried", REFUSED)
        after = follow(_drive(driven, filed))
        _print_lines(["", *tell_follow(before, after), ""])
        trial.stays = after.beats(before)
    if trial.stays:
        report(document(path, {TABLE: found}, trial.copy))
        human.show(f"The second drive is better. {path} keeps these gains; as it was before: {trial.copy}.")
    else:
        human.show("The second drive is not better.")
    return DONE if trial.is_settled else REFUSED


def _drive(driven: Driven, filed: RobotConfig) -> list[Leg]:
    driven.drive()
    return legs_of(driven.wheels, (filed.left_ticks_per_metre, filed.right_ticks_per_metre))


def complain(reason: str, code: int) -> int:
    """Print one line on standard error; return the code."""
    print_error(f"tune speed: {reason}")
    return code


def _print_lines(lines: Iterable[str]) -> None:
    """Print rows and pictures, which are not to be wrapped."""
    for line in lines:
        print(line, flush=True)


class Trial:
    """The robot file with other gains. It is put back at the end, whatever ends it, unless its gains stay."""

    def __init__(self, human: Human, path: Path, found: Mapping[str, Value]) -> None:
        """Write the gains. Raises RobotFileError."""
        self._human, self._path = human, path
        self.copy = record(path, TABLE, found, kept_as=before_today())
        """The file as it was."""
        self._written = path.read_bytes()
        self.stays = False
        """The new gains are better."""
        self.is_settled = False
        """At the end the file has the better gains, and no others."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.is_settled = self.stays
        if self.stays:
            return
        why = "it was changed meanwhile"
        try:
            if self.copy is not None and self._path.read_bytes() == self._written:
                write_file_durably(self._path, self.copy.read_bytes())
                self.copy.unlink()
                self.is_settled = True
        except OSError as error:
            why = str(error)
        self._human.show(
            f"The gains on trial are still in {self._path}: {why}. It was before: {self.copy}."
            if not self.is_settled
            else f"{self._path} is as it was. If base has been restarted, restart it once more, at rest."
        )

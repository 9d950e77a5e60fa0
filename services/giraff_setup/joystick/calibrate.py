"""`giraff calibrate joystick`: a person tilts, the board is read, and `[joystick]` of the robot file is told."""

from __future__ import annotations

import math
import os
import sys
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Final

from giraff_core.tilt.clutch import Vector
from giraff_core.tilt.mount import Mount
from giraff_joystick.config import JoystickConfig
from giraff_node.config.robot_file import ConfigError, load, read_tables
from giraff_setup.joystick.attitude import (
    READINGS,
    AttitudeFit,
    DoubtError,
    PoseError,
    find,
    gravity_of,
    require_level,
    require_tilt,
)
from giraff_setup.joystick.board import BoardError, TiltBoard
from giraff_tools.robot_file import RobotFileError, before_today, document, own_robot_file, record, still_overriding
from giraff_tools.terminal.document import Report, no_report, print_report
from giraff_tools.terminal.human import Human, NobodyError, Terminal, agrees, signals_interrupt

_DONE: Final = 0
_REFUSED: Final = 1
_UNUSABLE: Final = 2
_INTERRUPTED: Final = 130
_PATIENCE: Final = 10 * READINGS
"""Readings within which the joystick must keep still for a second."""

_FLAT: Final = "Lay the joystick flat, as it is to be when nothing moves, and press ENTER."
_FORWARD: Final = "Tilt it forward, nose down, by about 30 degrees, hold it still, and press ENTER."
_LEFT: Final = "Lay it flat again, then tilt it to the left by about 30 degrees, hold it still, and press ENTER."


def calibrate_joystick(port: str | None, file: Path | None, *, as_json: bool = False) -> int:
    """Do the whole command; return its exit code. `file`: as of `own_robot_file`.

    `as_json`: the talk goes to standard error.
    """
    return print_report(lambda report: _calibrate(port, file, report), as_json=as_json)


def _calibrate(port: str | None, file: Path | None, report: Report) -> int:
    with signals_interrupt():
        try:
            path, port = _settings(port, file)
            board = TiltBoard(port)
            try:
                next(board.readings())
                human = Terminal(sys.stdin, sys.stdout)
                human.show(f"Joystick board on {port}; what is found goes into {path}.")
                return guide(human, board, path, report)
            finally:
                board.close()
        except (ConfigError, BoardError) as error:
            return _complain(str(error), _UNUSABLE)
        except KeyboardInterrupt:
            return _complain("interrupted. Nothing was written.", _INTERRUPTED)


def _settings(port: str | None, file: Path | None) -> tuple[Path, str]:
    """Return the robot file and the board's port. Raises ConfigError."""
    path, _ = own_robot_file("", file)
    environment = {**os.environ, "GIRAFF_CONFIG": str(path)}
    config = load("joystick", JoystickConfig, environment, **({"port": port} if port else {}))
    if "joystick" not in read_tables({"GIRAFF_CONFIG": str(path)}):
        raise ConfigError(f"{path} has no table [joystick]; add a line with this name")
    return path, port or config.port


def guide(human: Human, board: TiltBoard, path: Path, report: Report = no_report) -> int:
    """Measure, tell, ask and write; return the exit code."""
    try:
        flat = _pose(human, board, _FLAT)
        found = find(flat, _pose(human, board, _FORWARD, flat), _pose(human, board, _LEFT, flat))
        human.show(f"The sensor is {found.words}, and {found.off_level:.1f}° off level.")
        if not agrees(human, f"Write into {path}? [yes/no]", _tilt(board, found)):
            return _complain("not wanted. Nothing was written.", _REFUSED)
        kept = record(path, "joystick", _fields(found), kept_as=before_today())
    except BoardError as error:
        return _complain(f"{error}. Nothing was written.", _REFUSED)
    except DoubtError as error:
        return _complain(f"in doubt: {error}. Nothing was written.", _REFUSED)
    except NobodyError:
        return _complain("nobody answers. Nothing was written.", _UNUSABLE)
    except RobotFileError as error:
        return _complain(str(error), _REFUSED)
    report(document(path, {"joystick": _fields(found)}, kept))
    human.show(f"Written: [joystick] of {path}; as it was before: {kept}. giraff_joystick goes by it when it starts.")
    if overriding := still_overriding({"joystick": _fields(found)}, os.environ):
        human.show(overriding)
    return _DONE


def _pose(human: Human, board: TiltBoard, words: str, flat: Vector | None = None) -> Vector:
    """Return gravity in the pose that `words` ask for; without `flat` it is level, else tilted from it.

    Asks again until it can be used.
    """

    def watch() -> str:
        board.poll()
        return ""

    while True:
        human.ask(words, watch)
        try:
            pose = _gravity(board)
            if flat is None:
                require_level(pose)
            else:
                require_tilt(flat, pose)
        except PoseError as error:
            human.show(f"{error}.")
        else:
            return pose


def _gravity(board: TiltBoard) -> Vector:
    """Return gravity as soon as the joystick has kept still for a second. Raises PoseError where it never does."""
    window: deque[Vector] = deque(maxlen=READINGS)
    for count, vector in enumerate(board.readings()):
        window.append(vector)
        if len(window) == READINGS:
            try:
                return gravity_of(window)
            except PoseError:
                if count >= _PATIENCE:
                    raise
    raise BoardError("the board gives no more readings")


def _tilt(board: TiltBoard, found: AttitudeFit) -> Callable[[], str]:
    """Return what shows the tilt as it is with what was found."""
    mount = Mount(found.roll, found.pitch, found.yaw)
    shown = ""

    def show() -> str:
        nonlocal shown
        if readings := board.poll():
            x, y, z = mount.in_joystick(readings[-1])
            forward, left = (math.degrees(math.atan2(axis, z)) for axis in (x, y))
            shown = f"The joystick as it would be read: forward {forward:.0f}°, left {left:.0f}°."
        return shown

    return show


def _fields(found: AttitudeFit) -> dict[str, float]:
    angles = {"mount_roll": found.roll, "mount_pitch": found.pitch, "mount_yaw": found.yaw}
    return {name: round(angle, 5) + 0.0 for name, angle in angles.items()}


def _complain(reason: str, code: int) -> int:
    """Print one line on standard error; return the code."""
    print(f"giraff calibrate joystick: {reason}", file=sys.stderr, flush=True)
    return code

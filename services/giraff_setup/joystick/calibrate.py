"""`giraff calibrate joystick`: a person tilts, the board is read, and `[joystick]` of the robot file is told."""

import math
import os
import select
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Final

from giraff_core.tilt.clutch import Vector
from giraff_core.tilt.mount import Mount
from giraff_joystick.config import JoystickConfig
from giraff_joystick.policy import reading, trouble_of
from giraff_node.boards.board_link import BoardLink
from giraff_node.config.robot_file import ConfigError, load, read_tables
from giraff_schemas.boards import JOYSTICK_BOARD
from giraff_schemas.wire import TiltFrame
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
from giraff_tools.robot_file import RobotFileError, before_today, document, own_robot_file, record, still_overriding
from giraff_tools.terminal.document import INTERRUPTED, REFUSED, UNUSABLE, Report, complain, no_report, print_report
from giraff_tools.terminal.human import Human, NobodyError, Terminal, agrees, signals_interrupt
from giraff_tools.terminal.output import DONE

_complain: Final = partial(complain, "calibrate joystick")
_PATIENCE: Final = 10 * READINGS
"""Readings within which the joystick must keep still for a second."""

_FLAT: Final = "Lay the joystick flat, as it is to be when nothing moves, and press ENTER."
_FORWARD: Final = "Tilt it forward, nose down, by about 30 degrees, hold it still, and press ENTER."
_LEFT: Final = "Lay it flat again, then tilt it to the left by about 30 degrees, hold it still, and press ENTER."
_SILENCE: Final = 4.0
"""s without a reading. An adapter that resets its board costs half of it, with the start of the sensor."""
_WAIT: Final = 0.05  # s


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
            return _complain(str(error), UNUSABLE)
        except KeyboardInterrupt:
            return _complain("interrupted. Nothing was written.", INTERRUPTED)


def _settings(port: str | None, file: Path | None) -> tuple[Path, str]:
    """Return the robot file and the board's port. Raises ConfigError."""
    path, _ = own_robot_file("", file)
    environment = {**os.environ, "GIRAFF_CONFIG": str(path)}
    config = load("joystick", JoystickConfig, environment, **({"port": port} if port else {}))
    if "joystick" not in read_tables({"GIRAFF_CONFIG": str(path)}):
        raise ConfigError(f"{path} has no table [joystick]; add a line with this name")
    return path, port or config.port


def guide(human: Human, board: "TiltBoard", path: Path, report: Report = no_report) -> int:
    """Measure, tell, ask and write; return the exit code."""
    try:
        flat = _pose(human, board, _FLAT)
        found = find(flat, _pose(human, board, _FORWARD, flat), _pose(human, board, _LEFT, flat))
        human.show(f"The sensor is {found.words}, and {found.off_level:.1f}° off level.")
        if not agrees(human, f"Write into {path}? [yes/no]", _tilt(board, found)):
            return _complain("not wanted. Nothing was written.", REFUSED)
        kept = record(path, "joystick", _fields(found), kept_as=before_today())
    except BoardError as error:
        return _complain(f"{error}. Nothing was written.", REFUSED)
    except DoubtError as error:
        return _complain(f"in doubt: {error}. Nothing was written.", REFUSED)
    except NobodyError:
        return _complain("nobody answers. Nothing was written.", UNUSABLE)
    except RobotFileError as error:
        return _complain(str(error), REFUSED)
    report(document(path, {"joystick": _fields(found)}, kept))
    human.show(f"Written: [joystick] of {path}; as it was before: {kept}. giraff_joystick goes by it when it starts.")
    if overriding := still_overriding({"joystick": _fields(found)}, os.environ):
        human.show(overriding)
    return DONE


def _pose(human: Human, board: "TiltBoard", words: str, flat: Vector | None = None) -> Vector:
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


def _gravity(board: "TiltBoard") -> Vector:
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


def _tilt(board: "TiltBoard", found: AttitudeFit) -> Callable[[], str]:
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


class BoardError(Exception):
    """The board gives no readings. One line: what is wrong, and what to do."""


class TiltBoard:
    """Owns the port. Raises BoardError where the board falls silent, starts again, or its sensor fails."""

    def __init__(self, port: str) -> None:
        self._port = port
        self._link = BoardLink(port, JOYSTICK_BOARD)
        self._boot: int | None = None
        self._heard = time.monotonic()
        self._starting = ""

    def poll(self) -> list[Vector]:
        """Return the sensor's readings that have arrived, m/s² in its own axes."""
        frames = [frame for frame in self._link.poll(time.monotonic()) if isinstance(frame, TiltFrame)]
        readings = [vector for frame in frames if (vector := self._reading(frame)) is not None]
        if readings:
            self._heard = time.monotonic()
        elif time.monotonic() - self._heard > _SILENCE:
            hint = "; giraff_joystick must not run meanwhile" if self._boot is None else ""
            raise BoardError(self._starting or f"{self._link.fault}{hint}")
        return readings

    def readings(self) -> Iterator[Vector]:
        """Yield reading after reading from now on; what has arrived before is dropped."""
        self.poll()
        while True:
            yield from (arrived := self.poll())
            if not arrived:
                descriptor = self._link.descriptor()
                select.select([] if descriptor is None else [descriptor], [], [], _WAIT)

    def close(self) -> None:
        """Let go of the port."""
        self._link.close()

    def _reading(self, frame: TiltFrame) -> Vector | None:
        if self._boot not in {None, frame.boot_id}:
            raise BoardError(f"{self._port}: the board was reset in between; check its cable, and begin again")
        self._boot = frame.boot_id
        tilt = reading(frame)
        if tilt.status == "running":
            return tilt.x, tilt.y, tilt.z
        self._starting = f"{self._port}: {trouble_of(tilt.status, frame)}"
        if tilt.status != "starting":
            raise BoardError(self._starting)
        return None

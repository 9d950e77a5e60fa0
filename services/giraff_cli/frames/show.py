"""`giraff frames`: asks those who know where the robot's frames are, and shows it as it is wanted."""

import time
from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

from giraff_cli.frames.tree import Frames, dot, draw, faults_of, pose_text, tree_of
from giraff_core.kinematics.frames import FrameTree
from giraff_core.kinematics.pose_history import FrameError, UnknownFrameError
from giraff_node.network.replies import ask_all
from giraff_node.process.state import write_file_durably
from giraff_schemas.frames import Transform
from giraff_schemas.text import printable_lines
from giraff_schemas.topics import frame_key
from giraff_tools.network.command import UNUSABLE, print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.robot_graph import GraphMonitor
from giraff_tools.terminal.page import Page, print_json
from giraff_tools.terminal.signals import StopSignal

_SETTLED: Final = 0.5  # s after the first answer
_ASK_EVERY: Final = 0.3  # s
_WELL: Final = 0
_ILL: Final = 1


class Wanted(NamedTuple):
    """As it was typed."""

    source: str | None
    target: str | None
    svg: Path | None
    dot: bool
    as_json: bool


def frames(robot: str | None, connect: Sequence[str], wanted: Wanted) -> int:
    """Show what is wanted; the exit code."""

    def act(connection: RobotConnection) -> int:
        told = _ask(connection, stopping)
        if not told:
            return print_error(
                f"nobody tells where the frames of {connection.robot} are; ranger and odometry do, start them"
            )
        found = Frames(robot=connection.robot, frames=told, faults=faults_of(told))
        if wanted.source is not None and wanted.target is not None:
            return _show_pose(found, wanted.target, wanted.source, as_json=wanted.as_json)
        if wanted.svg is not None and (code := _write(wanted.svg, draw(found))):
            return code
        if wanted.as_json:
            print_json(found)
        elif wanted.dot:
            print(printable_lines(dot(found)))
        else:
            _show(found)
        return _ILL if found.faults else _WELL

    with StopSignal() as stopping:
        return run_with_robot(robot, connect, act)


def _ask(connection: RobotConnection, stopping: StopSignal) -> list[Transform]:
    """What is told, each frame once for each parent; by name. Raises NoRobotError."""
    GraphMonitor(connection).wait_for_robot(stopping)
    answers: deque[Transform] = deque()
    deadline = time.monotonic() + _SETTLED + _ASK_EVERY
    while time.monotonic() < deadline and not stopping.asked:
        ask_all(connection.session, frame_key(connection.robot), Transform, answers.append, _SETTLED)
        stopping.wait(_ASK_EVERY)
    return sorted({(told.child, told.parent): told for told in answers}.values(), key=lambda told: told.child)


def _show_pose(found: Frames, target: str, source: str, *, as_json: bool) -> int:
    """Where the one is in the other."""
    if found.faults:  # it would depend on who is believed
        return _complain(found)
    try:
        pose = FrameTree(found.frames).lookup(target, source)
    except FrameError as error:
        print_error(f"{found.robot}: {error}")
        return UNUSABLE if isinstance(error, UnknownFrameError) else _ILL
    if as_json:
        print_json(pose)
    else:
        print(printable_lines(pose_text(pose)))
    return _WELL


def _show(found: Frames) -> None:
    page = Page()
    for tree in tree_of(found.frames):
        page.print(tree)
    _complain(found)


def _complain(found: Frames) -> int:
    for fault in found.faults:
        print_error(fault)
    return _ILL


def _write(path: Path, drawing: str) -> int:
    """The exit code, 0 where it is written."""
    try:
        write_file_durably(path, drawing.encode())
    except OSError as error:
        return print_error(f"--svg {path}: cannot be written: {error.strerror or error}; name another file")
    return _WELL

"""`giraff frames`: the robot's frames as a tree, as those who know them tell where each is."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Iterable, Sequence
from contextlib import suppress
from typing import Final

import msgspec
import zenoh
from rich.text import Text
from rich.tree import Tree

from giraff_cli.network.command import print_error, run_with_robot
from giraff_cli.network.connection import RobotConnection
from giraff_cli.network.robot_graph import GraphMonitor
from giraff_cli.terminal.graphviz import quoted
from giraff_cli.terminal.page import Page, print_json
from giraff_cli.terminal.signals import StopSignal
from giraff_cli.terminal.text import printable
from giraff_schemas.frames import Transform
from giraff_schemas.topics import frame_key

_PATIENCE: Final = 3.0  # s, to find the only robot
_SETTLED: Final = 0.5  # s after the first answer
_ASK_EVERY: Final = 0.3  # s
_WELL: Final = 0
_ILL: Final = 1


class Frames(msgspec.Struct, frozen=True, kw_only=True):
    """The answer of `frames`."""

    robot: str
    frames: list[Transform]
    faults: list[str]
    """Why this is no tree; empty: it is one."""


def frames(robot: str | None, connect: Sequence[str], *, as_dot: bool, as_json: bool) -> int:
    """Draw the tree; the exit code."""

    def act(connection: RobotConnection) -> int:
        told = _ask(connection, stopping)
        if not told:
            return print_error(
                f"nobody tells where the frames of {connection.robot} are; ranger and odometry do, start them"
            )
        found = Frames(robot=connection.robot, frames=told, faults=faults_of(told))
        if as_json:
            print_json(found)
        elif as_dot:
            print(dot(found))
        else:
            _show(found)
        return _ILL if found.faults else _WELL

    with StopSignal() as stopping:
        return run_with_robot(robot, connect, _PATIENCE, act)


def faults_of(told: Sequence[Transform]) -> list[str]:
    """What keeps these from being one tree."""
    parents: dict[str, set[str]] = {}
    for transform in told:
        parents.setdefault(transform.child, set()).add(transform.parent)
    faults = [
        f"{child} is told to be in {' and in '.join(sorted(among))}: end one of those who say so"
        for child, among in parents.items()
        if len(among) > 1
    ]
    roots = roots_of(told)
    if not roots:
        faults.append("no frame is the first: they are in each other")
    if len(roots) > 1:
        faults.append(f"the frames hang together nowhere: {', '.join(roots)} are in none that is told")
    return faults


def roots_of(told: Iterable[Transform]) -> list[str]:
    """The frames that are in none."""
    told = list(told)
    children = {transform.child for transform in told}
    return sorted({transform.parent for transform in told} - children)


def dot(found: Frames) -> str:
    """For Graphviz: `giraff frames --dot | dot -Tsvg`."""
    lines = [f"digraph {quoted(found.robot)} {{"]
    lines += [
        f"  {quoted(frame.parent)} -> {quoted(frame.child)} [label={quoted(_place(frame))}];" for frame in found.frames
    ]
    return "\n".join([*lines, "}"])


def _ask(connection: RobotConnection, stopping: StopSignal) -> list[Transform]:
    """What is told, each frame once for each parent; by name. Raises NoRobotError."""
    GraphMonitor(connection).wait_for_robot(stopping)
    answers: deque[Transform] = deque()

    def on_reply(reply: zenoh.Reply) -> None:
        if reply.ok is not None:
            with suppress(msgspec.MsgspecError):  # of another version
                answers.append(msgspec.msgpack.decode(bytes(reply.ok.payload), type=Transform))

    deadline = time.monotonic() + _SETTLED + _ASK_EVERY
    while time.monotonic() < deadline and not stopping.asked:
        connection.session.get(
            frame_key(connection.robot),
            on_reply,
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=_SETTLED,
        )
        stopping.wait(_ASK_EVERY)
    return sorted({(told.child, told.parent): told for told in answers}.values(), key=lambda told: told.child)


def _show(found: Frames) -> None:
    page = Page()
    for root in roots_of(found.frames):
        tree = Tree(Text(printable(root)))
        _grow(tree, root, found.frames, {root})
        page.print(tree)
    for fault in found.faults:
        print_error(fault)


def _grow(tree: Tree, parent: str, told: Sequence[Transform], above: set[str]) -> None:
    for frame in told:
        if frame.parent == parent and frame.child not in above:
            how = "" if frame.fixed else "  (now)"
            branch = tree.add(Text(printable(f"{frame.child}  {_place(frame)}{how}")))
            _grow(branch, frame.child, told, {*above, frame.child})


def _place(frame: Transform) -> str:
    return f"x {frame.x:z.3f} m, y {frame.y:z.3f} m, yaw {math.degrees(frame.yaw):z.1f}°"

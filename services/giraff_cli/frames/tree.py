"""The robot's frames as a tree: what it lacks to be one, and how it reads."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import msgspec
from rich.text import Text
from rich.tree import Tree

from giraff_schemas.frames import Transform
from giraff_schemas.text import printable
from giraff_tools.terminal.text import quoted


class Frames(msgspec.Struct, frozen=True, kw_only=True):
    """The answer of `frames`."""

    robot: str
    frames: list[Transform]
    faults: list[str]
    """Why this is no tree; empty: it is one."""


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
        f"  {quoted(frame.parent)} -> {quoted(frame.child)} [label={quoted(place(frame))}];" for frame in found.frames
    ]
    return "\n".join([*lines, "}"])


def tree_of(told: Sequence[Transform]) -> list[Tree]:
    """For a terminal, one for each frame that is in none."""
    trees = []
    for root in roots_of(told):
        trees.append(Tree(Text(printable(root))))
        _grow(trees[-1], root, told, {root})
    return trees


def _grow(tree: Tree, parent: str, told: Sequence[Transform], above: set[str]) -> None:
    for frame in told:
        if frame.parent == parent and frame.child not in above:
            how = "" if frame.fixed else "  (now)"
            branch = tree.add(Text(printable(f"{frame.child}  {place(frame)}{how}")))
            _grow(branch, frame.child, told, {*above, frame.child})


def place(frame: Transform) -> str:
    """In a line: x, y and yaw, and of the others what is not 0."""
    tilted = {"roll": frame.roll, "pitch": frame.pitch}
    parts = [f"x {frame.x:z.3f} m", f"y {frame.y:z.3f} m"]
    parts += [f"z {frame.z:z.3f} m"] if frame.z else []
    parts += [f"{name} {math.degrees(angle):z.1f}°" for name, angle in tilted.items() if angle]
    return ", ".join([*parts, f"yaw {math.degrees(frame.yaw):z.1f}°"])


def pose_text(pose: Transform) -> str:
    """In full, on seven lines."""
    lengths = {"x": pose.x, "y": pose.y, "z": pose.z}
    angles = {"roll": pose.roll, "pitch": pose.pitch, "yaw": pose.yaw}
    when = "" if pose.fixed else ", now"
    lines = [f"{pose.child} in {pose.parent}{when}"]
    lines += [f"{name:<5} {length:z8.3f} m" for name, length in lengths.items()]
    lines += [f"{name:<5} {angle:z8.4f} rad {math.degrees(angle):z8.2f}°" for name, angle in angles.items()]
    return "\n".join(map(printable, lines))

"""The robot's frames as a tree: what it lacks to be one, how it reads, and how it is drawn."""

import math
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from typing import Final, NamedTuple

import msgspec
from rich.text import Text
from rich.tree import Tree

from giraff_schemas.frames import Transform
from giraff_schemas.text import printable
from giraff_tools.terminal.text import quoted

_CHARACTER, _LINE = 7.3, 16.0
_BOX, _GAP, _MARGIN, _TOP = 30.0, 24.0, 20.0, 64.0
_LABEL_LINES: Final = 3
_SPREAD: Final = 30.0
"""Between a box and the words below it, in which the lines to them part."""
_ARROW: Final = 22.0
_ARROWHEAD: Final = (
    '<defs><marker id="a" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" orient="auto">'
    '<path d="M0 0 8 4 0 8z" fill="#667"/></marker></defs>'
)
_ROW: Final = _BOX + _SPREAD + _LABEL_LINES * _LINE + _ARROW


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


class _Node(NamedTuple):
    name: str
    transform: Transform | None
    """None of what is in none."""
    below: "list[_Node]"

    @property
    def width(self) -> float:
        """Of it and all below it."""
        texts = [self.name, *([] if self.transform is None else _label(self.transform))]
        own = max(map(len, texts)) * _CHARACTER + 24.0
        return max(own, sum(node.width for node in self.below) + _GAP * (len(self.below) - 1))

    @property
    def depth(self) -> int:
        return 1 + max((node.depth for node in self.below), default=0)


def draw(found: Frames) -> str:
    """As SVG: a box for each, an arrow to each from what it is in, with where it is there."""
    roots = [_node(root, None, found.frames, {root}) for root in roots_of(found.frames)]
    words = [f"frames of {found.robot}", *found.faults]
    across = sum(root.width for root in roots) + _GAP * (len(roots) - 1)
    width = 2 * _MARGIN + max(across, *(len(line) * _CHARACTER for line in words))
    top = _TOP + len(found.faults) * _LINE
    height = top + max((root.depth for root in roots), default=1) * _ROW - (_ROW - _BOX) + _MARGIN
    size = f'viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}"'
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="monospace" font-size="12">',
        _ARROWHEAD,
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="#fff"/>',
        _text(words[0], _MARGIN, _MARGIN + _LINE, 'font-weight="bold"'),
    ]
    lines += [
        _text(fault, _MARGIN, _MARGIN + _LINE * (number + 2), 'fill="#b00"')
        for number, fault in enumerate(found.faults)
    ]
    left = (width - across) / 2.0
    for root in roots:
        lines += _drawn(root, left, top)
        left += root.width + _GAP
    return "\n".join([*lines, "</svg>", ""])


def _node(name: str, transform: Transform | None, told: Sequence[Transform], above: set[str]) -> _Node:
    below = [
        _node(frame.child, frame, told, {*above, frame.child})
        for frame in told
        if frame.parent == name and frame.child not in above
    ]
    return _Node(name, transform, below)


def _drawn(node: _Node, left: float, top: float) -> Iterator[str]:
    """It and all below it, within its width from `left`."""
    middle = left + node.width / 2.0
    box = len(node.name) * _CHARACTER + 24.0
    yield (
        f'<rect x="{middle - box / 2.0:.0f}" y="{top:.0f}" width="{box:.0f}" height="{_BOX:.0f}" rx="15"'
        ' fill="#f4f1e8" stroke="#a98"/>'
    )
    yield _text(node.name, middle, top + 19.0, 'font-weight="bold" text-anchor="middle"')
    across = sum(below.width for below in node.below) + _GAP * (len(node.below) - 1)
    left += (node.width - across) / 2.0
    for below in node.below:
        yield from _arrow(middle, top + _BOX, left + below.width / 2.0, below.transform)
        yield from _drawn(below, left, top + _ROW)
        left += below.width + _GAP


def _arrow(start_x: float, start_y: float, x: float, transform: Transform | None) -> Iterator[str]:
    """Down to the words that say where it is, and from them on to the box."""
    words = start_y + _SPREAD
    way = f"M{start_x:.0f} {start_y:.0f} V{start_y + _SPREAD / 2.0:.0f} H{x:.0f} V{words:.0f}"
    yield f'<path d="{way}" fill="none" stroke="#667"/>'
    for number, line in enumerate([] if transform is None else _label(transform)):
        yield _text(line, x, words + (number + 0.85) * _LINE, 'fill="#445" text-anchor="middle"')
    end = start_y + _ROW - _BOX
    yield f'<path d="M{x:.0f} {end - _ARROW + 4.0:.0f} V{end:.0f}" stroke="#667" marker-end="url(#a)"/>'


def _label(frame: Transform) -> tuple[str, ...]:
    """Of `_LABEL_LINES` lines."""
    roll, pitch, yaw = map(math.degrees, (frame.roll, frame.pitch, frame.yaw))
    return (
        f"x {frame.x:z.3f}  y {frame.y:z.3f}  z {frame.z:z.3f} m",
        f"roll {roll:z.1f}°  pitch {pitch:z.1f}°  yaw {yaw:z.1f}°",
        "fixed" if frame.fixed else "now",
    )


def _text(words: str, x: float, y: float, how: str) -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}" {how}>{escape(printable(words))}</text>'

"""The tree of frames as a drawing: a box for each, an arrow to each from what it is in, with where it is there."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from html import escape
from typing import Final, NamedTuple

from giraff_cli.frames.tree import Frames, roots_of
from giraff_schemas.frames import Transform
from giraff_schemas.text import printable

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


class _Node(NamedTuple):
    name: str
    transform: Transform | None
    """None of what is in none."""
    below: list[_Node]

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
    """As SVG."""
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

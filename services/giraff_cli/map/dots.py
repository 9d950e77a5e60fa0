"""A floor plan in characters."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

from giraff_cli.terminal.dots import ACROSS, DOWN, Dots
from giraff_maps.floor_plan import FloorPlan, Wall

_LENGTHS: Final = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""m that the scale may show."""
_SCALE_SHARE: Final = 0.25  # of the drawing's width that the scale takes at most


def drawn(plan: FloorPlan, columns: int, lines: int, *, dots: bool) -> Iterator[str]:
    """Lines of text within that many columns and lines, and the scale below them."""
    left, bottom, right, top = plan.bounds
    per_metre = min(
        (columns * ACROSS - 1) / max(right - left, 1e-9),
        (lines * DOWN - 1) / max(top - bottom, 1e-9),
    )
    drawing = Dots()
    for wall in plan.walls:
        for x, y in _points(wall, per_metre):
            drawing.set(round((x - left) * per_metre), round((top - y) * per_metre))
    yield from drawing.lines(dots=dots)
    yield _scale(right - left, per_metre, dots=dots)


def _points(wall: Wall, per_metre: float) -> Iterator[tuple[float, float]]:
    """Of a wall, two for each dot that it crosses."""
    x, y, end_x, end_y = wall
    steps = max(1, math.ceil(2.0 * per_metre * math.hypot(end_x - x, end_y - y)))
    for step in range(steps + 1):
        part = step / steps
        yield x + part * (end_x - x), y + part * (end_y - y)


def _scale(width: float, per_metre: float, *, dots: bool) -> str:
    fitting = [length for length in _LENGTHS if length <= max(width * _SCALE_SHARE, _LENGTHS[0])]
    length = fitting[-1]
    line = max(0, round(length * per_metre / ACROSS) - 2)
    return f"├{'─' * line}┤ {length:g} m" if dots else f"|{'-' * line}| {length:g} m"

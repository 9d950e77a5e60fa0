"""A floor plan in characters: eight dots in each, or `#` where a terminal has none."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

from giraff_maps.floor_plan import FloorPlan, Wall

_DOTS: Final = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # of a braille character: by row, then column
_BRAILLE: Final = 0x2800
_ACROSS, _DOWN = 2, 4  # dots of a character
_LENGTHS: Final = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""m that the scale may show."""
_SCALE_SHARE: Final = 0.25  # of the drawing's width that the scale takes at most


def drawn(plan: FloorPlan, columns: int, lines: int, *, dots: bool) -> Iterator[str]:
    """Lines of text within that many columns and lines, and the scale below them."""
    left, bottom, right, top = plan.bounds
    per_metre = min(
        (columns * _ACROSS - 1) / max(right - left, 1e-9),
        (lines * _DOWN - 1) / max(top - bottom, 1e-9),
    )
    cells: dict[tuple[int, int], int] = {}
    for wall in plan.walls:
        for x, y in _points(wall, per_metre):
            across, down = round((x - left) * per_metre), round((top - y) * per_metre)
            at = down // _DOWN, across // _ACROSS
            cells[at] = cells.get(at, 0) | _DOTS[down % _DOWN][across % _ACROSS]
    height = 1 + max(line for line, _ in cells)
    width = 1 + max(column for _, column in cells)
    for line in range(height):
        signs = (_sign(cells.get((line, column), 0), dots=dots) for column in range(width))
        yield "".join(signs).rstrip()
    yield _scale(right - left, per_metre, dots=dots)


def _points(wall: Wall, per_metre: float) -> Iterator[tuple[float, float]]:
    """Of a wall, two for each dot that it crosses."""
    x, y, end_x, end_y = wall
    steps = max(1, math.ceil(2.0 * per_metre * math.hypot(end_x - x, end_y - y)))
    for step in range(steps + 1):
        part = step / steps
        yield x + part * (end_x - x), y + part * (end_y - y)


def _sign(bits: int, *, dots: bool) -> str:
    if not bits:
        return " "
    return chr(_BRAILLE + bits) if dots else "#"


def _scale(width: float, per_metre: float, *, dots: bool) -> str:
    fitting = [length for length in _LENGTHS if length <= max(width * _SCALE_SHARE, _LENGTHS[0])]
    length = fitting[-1]
    line = max(0, round(length * per_metre / _ACROSS) - 2)
    return f"├{'─' * line}┤ {length:g} m" if dots else f"|{'-' * line}| {length:g} m"

"""Curves over time, drawn in a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from giraff_tools.terminal.dots import ACROSS, DOWN, Dots

_COLUMNS: Final = 72
_LINES: Final = 12


def draw_curves(
    curves: Sequence[Sequence[float]], low: float, high: float, seconds: float, *, dots: bool
) -> Iterator[str]:
    """Return the lines of curves that all last so many s, between `low` and `high`, with both at the margin."""
    drawing = Dots()
    width, height = _COLUMNS * ACROSS - 1, _LINES * DOWN - 1
    for curve in curves:
        for at, value in enumerate(curve):
            drawing.set(round(at / len(curve) * width), round((high - value) / (high - low) * height))
    lines = [*drawing.lines(dots=dots)]
    scale = {0: high, len(lines) - 1: low}
    bar = "│" if dots else "|"
    for number, line in enumerate(lines):
        label = f"{scale[number]:6.1f}" if number in scale else ""
        yield f"{label:6} {bar}{line}"
    yield f"{'':7}0{'':{_COLUMNS - 4}}{seconds:g} s"

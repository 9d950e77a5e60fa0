"""A drawing in characters: eight dots in each, or `#` where a terminal has none; and curves over time in it."""

import sys
from collections.abc import Iterator, Sequence
from typing import Final

_DOTS: Final = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # of a braille character: by row, then column
_BRAILLE: Final = 0x2800
ACROSS: Final = 2
"""Dots of a character, from left to right."""
DOWN: Final = 4
"""Dots of a character, from top to bottom."""
_COLUMNS: Final = 72
_LINES: Final = 12


class Dots:
    """Dots that are set one by one, counted from the upper left one."""

    def __init__(self) -> None:
        self._cells: dict[tuple[int, int], int] = {}

    def set(self, across: int, down: int) -> None:
        """Set one dot."""
        at = down // DOWN, across // ACROSS
        self._cells[at] = self._cells.get(at, 0) | _DOTS[down % DOWN][across % ACROSS]

    def copy(self) -> "Dots":
        """Return a drawing with the same dots, for more."""
        other = Dots()
        other._cells |= self._cells
        return other

    def sign(self, line: int, column: int, *, dots: bool) -> str:
        """Return the character there."""
        return _sign(self._cells.get((line, column), 0), dots=dots)

    def lines(self, *, dots: bool) -> Iterator[str]:
        """Return the lines of text down to the lowest dot."""
        height = 1 + max(line for line, _ in self._cells)
        width = 1 + max(column for _, column in self._cells)
        for line in range(height):
            signs = (self.sign(line, column, dots=dots) for column in range(width))
            yield "".join(signs).rstrip()


def takes_dots() -> bool:
    """Return whether standard output has more characters than ASCII's."""
    stdout = getattr(sys.stdout, "rich_proxied_file", sys.stdout)  # a live view stands before it, and hides this
    try:
        "⣿┼─┤²↗".encode(stdout.encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def _sign(bits: int, *, dots: bool) -> str:
    if not bits:
        return " "
    return chr(_BRAILLE + bits) if dots else "#"


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

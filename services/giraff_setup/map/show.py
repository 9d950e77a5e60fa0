"""`giraff map show`: a floor plan in the terminal, and as SVG on a grid with metres along two sides."""

import math
import shutil
import sys
import textwrap
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Final

import msgspec

from giraff_maps.floor_plan import FloorPlan, MapError, at_home
from giraff_maps.places_file import KnownPlaces, places_path, read_places
from giraff_maps.read import read_map
from giraff_node.process.state import write_file_durably
from giraff_schemas.text import printable
from giraff_tools.network.command import print_error
from giraff_tools.terminal.dots import takes_dots
from giraff_tools.terminal.floor import FloorDrawing, legend
from giraff_tools.terminal.output import guard_stdout
from giraff_tools.terminal.page import print_json
from giraff_tools.terminal.text import counted

_PIPE: Final = (80, 43)  # columns and lines where there is no terminal
_WIDEST: Final = 120  # columns
_BESIDE: Final = 2  # lines of the terminal that the drawing leaves: to its heading, and to what is typed next
_SIDE: Final = 900.0  # px of the longer side
_MARGIN, _TOP = 48.0, 64.0  # px
_MOST_LINES: Final = 25  # of the grid along the longer side
_STEPS: Final = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)
"""m between lines of the grid."""


def show(file: Path, svg: Path | None, *, as_json: bool = False) -> int:
    """The exit code."""
    try:
        plan = read_map(file)
        known = read_places(places_path(at_home(file)))
    except MapError as error:
        return print_error(str(error))
    if svg is not None:
        try:
            write_file_durably(svg, picture(plan, summary(plan), known).encode())
        except OSError as error:
            return print_error(f"--svg {svg}: cannot be written: {error.strerror or error}; name another file")

    def report() -> int:
        if as_json:
            left, bottom, right, top = plan.bounds
            told = {"name": plan.name, "x": [left, right], "y": [bottom, top], "walls": len(plan.walls)}
            print_json(told | msgspec.to_builtins(known._asdict()) | {"svg": None if svg is None else str(svg)})
            return 0
        dots = takes_dots()
        print(summary(plan, ascii_only=not dots))
        columns, lines = _room_for_it()
        below = textwrap.wrap(legend(known, dots=dots), columns)
        drawing = FloorDrawing(plan, columns, max(10, lines - len(below)), dots=dots)
        print("\n".join([drawing.draw(known=known).plain, *below]))
        return 0

    return guard_stdout(report)


def summary(plan: FloorPlan, *, ascii_only: bool = False) -> str:
    """Its name, its size from end to end, and how many walls it has."""
    left, bottom, right, top = plan.bounds
    width, height = right - left, top - bottom
    square = "m2" if ascii_only else "m²"
    name = printable(plan.name)
    if ascii_only:
        name = name.encode("ascii", "replace").decode()
    return f"{name}: {width:.2f} x {height:.2f} m, {width * height:.1f} {square}, {counted(len(plan.walls), 'wall')}"


def _room_for_it() -> tuple[int, int]:
    if not sys.stdout.isatty():
        return _PIPE
    columns, lines = shutil.get_terminal_size(_PIPE)
    return max(10, min(columns - 1, _WIDEST)), max(10, lines - _BESIDE)


def picture(plan: FloorPlan, title: str, known: KnownPlaces) -> str:
    """Metres of the plan's own frame are written at the grid."""
    step = _step(plan)
    left, bottom, right, top = plan.bounds
    left, bottom = math.floor(left / step) * step, math.floor(bottom / step) * step
    right, top = math.ceil(right / step) * step, math.ceil(top / step) * step
    per_metre = _SIDE / max(right - left, top - bottom)
    width, height = (right - left) * per_metre, (top - bottom) * per_metre

    def across(x: float) -> float:
        return _MARGIN + (x - left) * per_metre

    def down(y: float) -> float:
        return _TOP + (top - y) * per_metre

    page = max(width + 2 * _MARGIN, 420.0), height + _TOP + _MARGIN
    size = f'viewBox="0 0 {page[0]:.0f} {page[1]:.0f}" width="{page[0]:.0f}" height="{page[1]:.0f}"'
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="12">',
        f'<rect width="{page[0]:.0f}" height="{page[1]:.0f}" fill="#fff"/>',
        f'<text x="{_MARGIN:.0f}" y="32" font-size="16" fill="#223">{escape(title)}</text>',
    ]
    for x in _marks(left, right, step):
        lines.append(f'<path d="M{across(x):.1f} {down(bottom):.1f} V{down(top):.1f}" stroke="#e4e4ec"/>')
        lines.append(_label(f"{x:g}", across(x), down(bottom) + 18.0, "middle"))
    for y in _marks(bottom, top, step):
        lines.append(f'<path d="M{across(left):.1f} {down(y):.1f} H{across(right):.1f}" stroke="#e4e4ec"/>')
        lines.append(_label(f"{y:g}", _MARGIN - 8.0, down(y) + 4.0, "end"))
    lines.append(_label("m", _MARGIN - 8.0, _TOP - 12.0, "end"))
    walls = " ".join(
        f"M{across(x):.1f} {down(y):.1f} L{across(end_x):.1f} {down(end_y):.1f}" for x, y, end_x, end_y in plan.walls
    )
    lines.append(f'<path d="{walls}" fill="none" stroke="#223" stroke-width="2" stroke-linecap="round"/>')
    for line in known.no_go:
        ends = f"M{across(line.x):.1f} {down(line.y):.1f} L{across(line.end_x):.1f} {down(line.end_y):.1f}"
        lines.append(f'<path d="{ends}" stroke="#c00" stroke-width="2" stroke-dasharray="6 4"/>')
    for place in known.places:
        x, y = across(place.x), down(place.y)
        turned = f"translate({x:.1f} {y:.1f}) rotate({-math.degrees(place.yaw):.1f})"
        lines.append(f'<path d="M9 0 L-5 5 V-5 Z" fill="#06c" transform="{turned}"/>')
        lines.append(_label(escape(printable(place.name)), x, y + 20.0, "middle"))
    return "\n".join([*lines, "</svg>", ""])


def _step(plan: FloorPlan) -> float:
    left, bottom, right, top = plan.bounds
    side = max(right - left, top - bottom)
    return next((step for step in _STEPS if side / step <= _MOST_LINES), _STEPS[-1])


def _marks(begin: float, end: float, step: float) -> Iterator[float]:
    for number in range(round((end - begin) / step) + 1):
        yield round(begin + number * step, 6) + 0.0  # never -0


def _label(text: str, x: float, y: float, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" fill="#667" text-anchor="{anchor}">{text}</text>'

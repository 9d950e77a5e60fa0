"""`giraff map show`: a floor plan in the terminal, and as SVG."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Final

from giraff_maps.floor_plan import FloorPlan, MapError
from giraff_maps.read import read_map
from giraff_node.process.state import write_file_durably
from giraff_schemas.text import printable
from giraff_setup.map.picture import picture
from giraff_tools.network.command import print_error
from giraff_tools.terminal.dots import takes_dots
from giraff_tools.terminal.floor import FloorDrawing
from giraff_tools.terminal.output import guard_stdout
from giraff_tools.terminal.page import print_json
from giraff_tools.terminal.text import counted

_PIPE: Final = (80, 43)  # columns and lines where there is no terminal
_WIDEST: Final = 120  # columns
_BESIDE: Final = 2  # lines of the terminal that the drawing leaves: to its heading, and to what is typed next


def show(file: Path, svg: Path | None, *, as_json: bool = False) -> int:
    """The exit code."""
    try:
        plan = read_map(file)
    except MapError as error:
        return print_error(str(error))
    if svg is not None:
        try:
            write_file_durably(svg, picture(plan, summary(plan)).encode())
        except OSError as error:
            return print_error(f"--svg {svg}: cannot be written: {error.strerror or error}; name another file")

    def report() -> int:
        if as_json:
            left, bottom, right, top = plan.bounds
            told = {"name": plan.name, "x": [left, right], "y": [bottom, top], "walls": len(plan.walls)}
            print_json(told | {"svg": None if svg is None else str(svg)})
            return 0
        dots = takes_dots()
        print(summary(plan, ascii_only=not dots))
        print(FloorDrawing(plan, *_room_for_it(), dots=dots).draw().plain)
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

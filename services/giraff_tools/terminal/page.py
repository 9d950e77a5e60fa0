"""Text with colours and columns on standard output."""

import errno
import os
import re
import sys
from collections.abc import Iterable, Sequence
from shutil import get_terminal_size
from textwrap import fill
from typing import Any, Final, NoReturn, TextIO

from rich.cells import cell_len
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from giraff_schemas.text import printable
from giraff_telemetry.console import CleanConsole
from giraff_tools.terminal.text import json_page

_PIPE_WIDTH: Final = 120  # characters of a table in a pipe; a sentence stays a line for whoever searches it
_GAP: Final = 2  # blanks between two columns
_LAST: Final = 20  # characters of a last column, whose longer words (paths) are folded
_BLANK_END: Final = re.compile(r"(?: |\x1b\[[0-9;]*m)+$")


class Page(CleanConsole):
    """As wide as the terminal; colourless in a pipe, and as wide as a page of code."""

    def __init__(self) -> None:
        super().__init__(highlight=False, width=None if sys.stdout.isatty() else _PIPE_WIDTH)

    def on_broken_pipe(self) -> NoReturn:
        """Leave it to whoever prints: Rich would end the program here, and Zenoh's session with it, or never."""
        raise BrokenPipeError(errno.EPIPE, os.strerror(errno.EPIPE))


def print_json(document: Any) -> None:
    """The one document of a command with --json."""
    print(json_page(document))


def table_of(headings: Iterable[str], rows: Iterable[Sequence[str | Text]]) -> Table:
    """Columns under their headings; one that begins with ">" has figures, and stands to the right."""
    table = Table(box=None, pad_edge=False, padding=(0, _GAP, 0, 0), header_style="dim")
    for heading in headings:
        right = heading.startswith(">")
        table.add_column(heading.removeprefix(">"), justify="right" if right else "left", overflow="fold")
    for row in rows:
        table.add_row(*(cell if isinstance(cell, Text) else Text(printable(cell)) for cell in row))
    return table


def print_table(headings: Sequence[str], rows: Iterable[Sequence[str | Text]]) -> None:
    """The same on standard output, where no word is torn.

    Columns that do not fit beside each other come below, behind the first column once more.
    """
    cells = [[cell if isinstance(cell, Text) else Text(printable(cell)) for cell in row] for row in rows]
    columns = [[heading.removeprefix(">"), *(row[at].plain for row in cells)] for at, heading in enumerate(headings)]
    width = Page().width
    most = [max(map(cell_len, column)) for column in columns]
    least = [max(cell_len(word) for text in column for word in text.split() or [""]) for column in columns]
    least[-1] = min(least[-1], _LAST)
    for number, group in enumerate(_groups(least, width)):
        table = table_of([headings[at] for at in group], [[row[at] for at in group] for row in cells])
        for column, wide in zip(table.columns, _fitted([(least[at], most[at]) for at in group], width), strict=True):
            column.width = wide
        table.show_header = any(column[0] for column in columns)
        if number:
            print()
        print_trimmed(table)


def _groups(least: Sequence[int], width: int) -> list[list[int]]:
    """Columns that fit beside each other, by their numbers."""
    groups = [[0]]
    for at in range(1, len(least)):
        if sum(least[each] + _GAP for each in groups[-1]) + least[at] > width and len(groups[-1]) > 1:
            groups.append([0])
        groups[-1].append(at)
    return groups


def _fitted(bounds: Sequence[tuple[int, int]], width: int) -> list[int]:
    """The widths of columns, of which the widest that can be wrapped give way."""
    widths = [most for _, most in bounds]
    while (excess := sum(widths) + _GAP * (len(widths) - 1) - width) > 0:
        spare = [wide - least for wide, (least, _) in zip(widths, bounds, strict=True)]
        if not any(spare):
            break
        at = max(range(len(widths)), key=lambda each: (spare[each] > 0, widths[each]))
        widths[at] -= min(spare[at], excess)
    return widths


def print_wrapped(text: str, file: TextIO | None = None, end: str = "\n") -> None:
    """Sentences, at a terminal in lines that end between two words."""
    shown = file or sys.stdout
    lines = text.split("\n")
    if shown.isatty():
        lines = [_wrapped(line, get_terminal_size().columns) for line in lines]
    print("\n".join(lines), end=end, file=shown, flush=True)


def _wrapped(line: str, width: int) -> str:
    """The lines of one that is too long, each as far in as it is."""
    indent = " " * (len(line) - len(line.lstrip()))
    return fill(line, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False) or line


def print_trimmed(shown: RenderableType) -> None:
    """Without the blanks that Rich ends lines with."""
    page = Page()
    with page.capture() as captured:
        page.print(shown, soft_wrap=isinstance(shown, Text) and not sys.stdout.isatty())
    for line in captured.get().splitlines():
        print(_BLANK_END.sub(lambda end: "\x1b[0m" if "\x1b" in end[0] else "", line))


def shown(number: float | None, form: str = ".1f") -> str:
    """A figure that may not be known."""
    return "-" if number is None else format(number, form)

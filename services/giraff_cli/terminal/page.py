"""Text with colours and columns on standard output."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterable, Sequence
from typing import Any, Final, NoReturn

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from giraff_cli.terminal.text import json_page
from giraff_schemas.text import printable
from giraff_telemetry.console import CleanConsole

_PIPE_WIDTH: Final = 1000  # characters: a line stays a line for whoever searches them


class Page(CleanConsole):
    """As wide as the terminal; colourless, and as wide as it takes, in a pipe."""

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
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="dim")
    for heading in headings:
        right = heading.startswith(">")
        table.add_column(heading.removeprefix(">"), justify="right" if right else "left", overflow="fold")
    for row in rows:
        table.add_row(*(cell if isinstance(cell, Text) else Text(printable(cell)) for cell in row))
    return table


def print_table(headings: Iterable[str], rows: Iterable[Sequence[str | Text]]) -> None:
    """The same on standard output."""
    print_trimmed(table_of(headings, rows))


def print_trimmed(shown: RenderableType) -> None:
    """Without the blanks that Rich ends lines with."""
    page = Page()
    with page.capture() as captured:
        page.print(shown)
    for line in captured.get().splitlines():
        print(line.rstrip())


def shown(number: float | None, form: str = ".1f") -> str:
    """A figure that may not be known."""
    return "-" if number is None else format(number, form)

"""How a live view is laid out: blocks of rows below a heading, beside each other, where nothing moves or wraps."""

from collections.abc import Sequence
from typing import Final, Literal

from rich.console import RenderableType
from rich.rule import Rule
from rich.table import Column, Table
from rich.text import Text

from giraff_schemas.text import printable

ServiceStatus = Literal["starting", "alive", "silent", "ended"]

HEADING: Final = "bold cyan"
NONE: Final = Text("-", style="dim")

_LONGEST_WHY: Final = 135  # characters

_STATUS: Final[dict[ServiceStatus, tuple[str, str]]] = {
    "starting": ("○", "dim"),
    "alive": ("●", "green"),
    "silent": ("○", "red"),
    "ended": ("✗", "bold red"),
}


def header(*parts: tuple[str, str]) -> RenderableType:
    """The line above all; each part with its style."""
    return Rule(Text.assemble(*((printable(text), style) for text, style in parts)), style="cyan", align="left")


def block(title: str, width: int, *columns: Column) -> Table:
    """A block of rows below a heading. Columns have fixed widths, so that nothing moves when a number grows."""
    label = Column(Text(title, style=HEADING), width=width, no_wrap=True, style="dim")
    expand = any(column.ratio for column in columns)
    return Table(label, *columns, box=None, padding=(0, 1, 0, 0), show_edge=False, pad_edge=False, expand=expand)


def right(title: str, width: int) -> Column:
    return Column(unit(title), width=width, justify="right", no_wrap=True)


def left(title: str, width: int) -> Column:
    """`width` 0: whatever is left over."""
    return Column(unit(title), width=width or None, ratio=None if width else 1, no_wrap=True, overflow="ellipsis")


def beside(*blocks: Table) -> Table:
    """Blocks in a row; the last has what is left over."""
    grid = Table.grid(padding=(0, 3, 0, 0), expand=True)
    for _ in blocks[:-1]:
        grid.add_column()
    grid.add_column(ratio=1)
    grid.add_row(*blocks)
    return grid


def services(statuses: Sequence[tuple[str, ServiceStatus]]) -> Text:
    """Which are there."""
    text = Text(no_wrap=True, overflow="ellipsis")
    text.append("SERVICES", style=HEADING)
    for service, status in statuses:
        sign, style = _STATUS[status]
        text.append("  ").append(f"{sign} ", style=style).append(printable(service))
    return text


def why(text: str) -> Text:
    """What limits, as far as two rows of a narrow terminal take it; empty: nothing does."""
    short = text if len(text) <= _LONGEST_WHY else f"{text[:_LONGEST_WHY]}…"
    return Text.assemble(("WHY  ", HEADING), text_or_dash(short, "yellow"))


def notice(text: str) -> Text:
    """What went wrong."""
    return Text(printable(text), style="red", no_wrap=True, overflow="ellipsis")


def unit(text: str) -> Text:
    return Text(text, style="dim")


def text_or_dash(text: str, style: str = "") -> Text:
    """Text of the network, or a dash for none."""
    return Text(printable(text), style=style) if text else NONE


def clock(seconds: float) -> str:
    """s as minutes and seconds."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"

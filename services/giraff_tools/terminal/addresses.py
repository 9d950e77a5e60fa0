"""Where a robot's page is to be opened, told to people and their phones."""

import io
import ipaddress
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final
from urllib.parse import urlsplit

from rich.console import Console, ConsoleOptions, RenderResult
from rich.text import Text

from giraff_tools.terminal.output import discard_stdout, is_drawn_on
from giraff_tools.terminal.text import json_line

_MARK: Final = "page: "
"""Before an address where there is no terminal: for programs."""
_QUIET: Final = 2
"""Modules of margin around a code. The standard has 4; a phone reads it with 2, and it fits more terminals."""
_BENEATH: Final = 3  # rows of a screen with a code: its address, which may take two, and what to do
_INK: Final = "#ffffff on #000000"
"""Whatever the terminal's own colours are: a code that is light on dark for one and dark on light for the other is read
by some phones only."""


def of_others(addresses: Sequence[str]) -> str:
    """The first that another host can open; empty: none can."""
    return next((address for address in addresses if not _is_loopback(address)), "")


def with_loopback(addresses: Sequence[str]) -> tuple[str, ...]:
    """With one for this host's own browser before them, of a port that is open at each of its addresses."""
    if not addresses or any(map(_is_loopback, addresses)):
        return tuple(addresses)
    parts = urlsplit(addresses[0])
    return parts._replace(netloc=f"127.0.0.1:{parts.port}").geturl(), *addresses


def of_this_host(addresses: Sequence[str]) -> Sequence[str]:
    """All of them, the loopback's first: it leads there whatever the network does."""
    return sorted(addresses, key=lambda address: not _is_loopback(address))


def without_token(address: str) -> str:
    """Where one may watch and stop."""
    return address.partition("#")[0]


def print_addresses(addresses: Sequence[str]) -> None:
    """Print them, with the code of the first that a phone can open where a terminal shows it.

    Whoever reads may have gone: that ends nothing.
    """
    try:
        if is_drawn_on(sys.stdout):
            _draw(addresses, Console(highlight=False))
        else:
            for address in of_this_host(addresses):
                print(f"{_MARK}{address}")
        sys.stdout.flush()
    except OSError:
        discard_stdout()


def tell_programs(addresses: Sequence[str]) -> None:
    """Print them as one object on a line, the loopback's first. A reader that has gone ends nothing."""
    try:
        print(json_line({"addresses": of_this_host(addresses)}), flush=True)
    except OSError:
        discard_stdout()


def _draw(addresses: Sequence[str], console: Console) -> None:
    console.print("the page; open it on a phone or laptop:")
    for address in addresses:
        console.print(f"    {address}", soft_wrap=True, markup=False)
    if far := of_others(addresses):
        console.print(Code(far))
    else:
        console.print("(no other host can open it)")
    console.print("Each address drives on the first device that opens it; then a new one is told.")
    console.print(f"To watch and to STOP no token is needed: {without_token(far or addresses[0])}", soft_wrap=True)


@dataclass(frozen=True)
class Code:
    """A QR code, two of its modules in each character; nothing where it does not fit."""

    text: str

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        rows = self.rows()
        if len(rows[0]) <= options.max_width and len(rows) <= (options.height or len(rows)):
            yield Text("\n".join(rows), style=_INK, no_wrap=True)

    def rows(self) -> list[str]:
        """As characters that are light where the code is."""
        return _rows(self.text)


@dataclass(frozen=True)
class CodeScreen:
    """A whole screen with the code of the address that a phone can open, and that address in letters."""

    addresses: Sequence[str]
    why_here: str
    """The reason that is told where no other host can open any of the addresses."""

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        if far := of_others(self.addresses):
            rows = Code(far).rows()
            columns, height = len(rows[0]), len(rows) + _BENEATH
            fits = columns <= options.max_width and height <= (options.height or console.height)
            small = f"The code needs {columns} columns and {height} rows: enlarge the terminal."
            yield Code(far) if fits else Text(small)
        else:
            yield Text(f"There is no code: no other host can open the page, since {self.why_here}")
        yield Text(far or "\n".join(self.addresses), overflow="fold")
        yield Text(f"{'Scan it with a phone in the same network. ' if far else ''}Any key goes back.")


@lru_cache(maxsize=1)
def _rows(text: str) -> list[str]:
    import segno  # noqa: PLC0415  of the extra `web`

    picture = io.StringIO()
    segno.make(text, error="l", micro=False, boost_error=False).terminal(picture, border=_QUIET, compact=True)
    return picture.getvalue().splitlines()


def _is_loopback(address: str) -> bool:
    host = urlsplit(address).hostname or ""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"

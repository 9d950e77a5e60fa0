"""What is wrong, and what to do about it: two texts, which people read as one line.

On the wire the line stands in one field, and its remedy, which is its tail, in a second one beside it. So a host of an
earlier version reads the line as ever, and nobody takes it apart.
"""

from __future__ import annotations

from typing import Protocol

import msgspec

_BETWEEN = "; "


class Trouble(msgspec.Struct, frozen=True):
    """False where nothing is wrong."""

    what: str = ""
    """What is wrong, with its likely cause."""
    remedy: str = ""
    """What to do about it; empty: nobody knows."""

    def __bool__(self) -> bool:
        return bool(self.what)

    def __str__(self) -> str:
        return f"{self.what}{_BETWEEN}{self.remedy}" if self.remedy else self.what

    def of(self, whom: str) -> Trouble:
        """The same, after the name of what has it."""
        return Trouble(f"{whom}: {self.what}", self.remedy)


WELL = Trouble()


class Told(Protocol):
    """A message that says why something is not as it was asked for."""

    @property
    def reason(self) -> str:
        """The whole line; empty: nothing is wrong."""
        ...

    @property
    def remedy(self) -> str:
        """The tail of `reason`; empty: it has none, or an earlier version has made it."""
        ...


def read_trouble(line: str, remedy: str) -> Trouble:
    """What the two fields of a message say."""
    if not line:
        return WELL
    tail = f"{_BETWEEN}{remedy}"
    what = line.removesuffix(tail)
    return Trouble(what, remedy) if remedy and what not in ("", line) else Trouble(line)


def trouble_of(told: Told) -> Trouble:
    """What a message says is wrong."""
    return read_trouble(told.reason, told.remedy)

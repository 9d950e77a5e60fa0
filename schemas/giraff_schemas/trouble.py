"""Trouble: what is wrong, and what to do about it. People read both as one line, and programs read each by itself."""

from __future__ import annotations

import msgspec


class Trouble(msgspec.Struct, frozen=True):
    """False where nothing is wrong."""

    what: str = ""
    """What is wrong, with its likely cause."""
    remedy: str = ""
    """What to do about it; empty: nobody knows."""

    def __bool__(self) -> bool:
        return bool(self.what)

    def __str__(self) -> str:
        return f"{self.what}; {self.remedy}" if self.remedy else self.what

    def of(self, whom: str) -> Trouble:
        """The same, after the name of what has it."""
        return Trouble(f"{whom}: {self.what}", self.remedy)


WELL = Trouble()

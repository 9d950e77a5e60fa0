"""Lines for people of which there are never more than one a second of each kind. No clock: time is an argument."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

EVERY: Final = 1.0
"""s between two lines of one kind."""


class LimitedLog:
    """Whatever pages do, the log grows slowly; and tells how much it left out."""

    def __init__(self, log: Callable[[str], None]) -> None:
        self._log = log
        self._kinds: dict[str, tuple[float, int]] = {}
        """When the last line of it was, and how many were left out since."""

    def say(self, kind: str, line: str, now: float) -> None:
        """`kind`: one of a few; `now`: monotonic, s."""
        last, left_out = self._kinds.get(kind, (now - EVERY, 0))
        if now - last < EVERY:
            self._kinds[kind] = last, left_out + 1
            return
        self._kinds[kind] = now, 0
        self._log(f"{line} ({left_out} more since the last line)" if left_out else line)

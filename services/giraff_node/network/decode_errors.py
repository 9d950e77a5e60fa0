"""On which keys payloads come that cannot be read: named once each, and never more than a few of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from giraff_schemas.trouble import WELL, Trouble

MOST: Final = 20
"""Keys of one subscription that are named; whoever invents more of them fills neither memory nor log."""
MENDED_AFTER: Final = 2.0
"""s without a bad payload until a good one shows that a key is sound again."""
_LONGEST: Final = 300  # characters of a fault: its text may quote the payload


class DecodeErrors:
    """Those of one subscription. Times are seconds of any one monotonic clock."""

    def __init__(self, pattern: str, tell: Callable[[str, Trouble], None]) -> None:
        self._pattern = pattern
        self._tell = tell
        self._last: dict[str, float] = {}

    def bad(self, key: str, why: str, now: float) -> None:
        """A payload on `key` could not be read."""
        if key in self._last:
            self._last[key] = now
        elif len(self._last) < MOST:
            self._last[key] = now
            self._tell(f"decode {key}", Trouble(why[:_LONGEST]))
        else:
            self._tell(
                f"decode more of {self._pattern}",
                Trouble(
                    f"{self._pattern}: unreadable payloads on more than {MOST} keys", "find out who publishes there"
                ),
            )

    def good(self, key: str, now: float) -> None:
        """A payload on `key` was read."""
        if key in self._last and now - self._last[key] > MENDED_AFTER:
            del self._last[key]
            self._tell(f"decode {key}", WELL)
            self._tell(f"decode more of {self._pattern}", WELL)

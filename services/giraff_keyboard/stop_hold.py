"""Whether the space bar is held. A terminal sends no key releases, but a held key repeats."""

from __future__ import annotations

import math
from typing import Final

HELD: Final = 2.0
"""s for which STOP is held to ask for off."""
_REPEATS: Final = 0.12
"""s between two repeats at most: terminals repeat at 10 to 50 Hz, a finger presses up to 8 times a second."""
_DELAY: Final = 1.0
"""s from the press to the first repeat at most."""
_SURELY: Final = 1.0
"""s for which repeats must have come without a gap. A person who hammers the key holds nothing."""


class StopHold:
    """Times are monotonic, s."""

    def __init__(self) -> None:
        self._last = self._begun = self._repeats_since = -math.inf

    def on_stop(self, now: float) -> bool:
        """Take a press or a repeat. Return whether the key has been held long enough."""
        gap = now - self._last
        if gap > _REPEATS:
            self._begun = self._last if gap <= _DELAY else now
            self._repeats_since = now
        self._last = now
        return now - self._begun >= HELD and now - self._repeats_since >= _SURELY

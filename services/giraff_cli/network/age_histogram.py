"""How old commands were."""

from __future__ import annotations

from collections import Counter
from typing import Final

_AGE_STEP_MS: Final = 0.1


class AgeHistogram:
    """A distribution of ages in ms, as steps of 0.1 ms: it does not grow with a long run."""

    def __init__(self) -> None:
        self._counts: Counter[int] = Counter()

    def add(self, milliseconds: float) -> None:
        self._counts[round(milliseconds / _AGE_STEP_MS)] += 1

    def quantile(self, share: float) -> float | None:
        """The age that `share` (0..1) of all do not exceed; None: there are none."""
        wanted, seen = share * self._counts.total(), 0
        for step, count in sorted(self._counts.items()):
            seen += count
            if seen >= wanted:
                return round(step * _AGE_STEP_MS, 1)
        return None

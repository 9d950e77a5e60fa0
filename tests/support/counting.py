"""Counts what tests cost in units that are the same on every machine: see tests/support/budget.py."""

import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

counted: Final[Counter[str]] = Counter()
"""Cost of this process's tests so far, by unit of tests/budget.toml."""
_repeats: Final = threading.local()


def count(unit: str, amount: float = 1) -> None:
    """Add to the cost of the test that runs, unless it only looks again."""
    if not getattr(_repeats, "deep", 0):
        counted[unit] += amount  # type: ignore[assignment]  # a Counter of s has fractions


@contextmanager
def looking_again() -> Iterator[None]:
    """Count nothing in this thread until the block ends: a busy machine makes a test look more often."""
    _repeats.deep = getattr(_repeats, "deep", 0) + 1
    try:
        yield
    finally:
        _repeats.deep -= 1

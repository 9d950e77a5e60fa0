"""Waiting for what takes its time, and no longer than it may."""

import time
from collections.abc import Callable

from tests.support.counting import looking_again


def wait(
    holds: Callable[[], object],
    within: float = 10.0,
    *,
    what: str | Callable[[], object] = "it did not come about",
    every: float = 0.02,
) -> float:
    """Until it holds; the s that took. AssertionError after `within` s, which names `what`. Looks again `every` s."""
    began = time.monotonic()
    held = holds()
    while not held:
        if time.monotonic() - began >= within:
            raise AssertionError(f"{what() if callable(what) else what}: not within {within:g} s")
        time.sleep(every)
        with looking_again():
            held = holds()
    return time.monotonic() - began

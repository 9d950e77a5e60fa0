"""The clock that ticks are made of."""

from __future__ import annotations

import time

import pytest

from giraff_node.clock import robot_now_ns


def test_the_robots_clock_is_the_kernels_that_goes_on_through_a_suspend(monkeypatch: pytest.MonkeyPatch) -> None:
    """Until a machine is suspended it cannot be told from the others; tests/hosts has one that was."""
    real, asked = time.clock_gettime_ns, []

    def ask(clock: int) -> int:
        asked.append(clock)
        return real(clock)

    monkeypatch.setattr(time, "clock_gettime_ns", ask)
    began = real(time.CLOCK_BOOTTIME)
    assert began <= robot_now_ns() <= real(time.CLOCK_BOOTTIME)
    assert asked == [time.CLOCK_BOOTTIME]

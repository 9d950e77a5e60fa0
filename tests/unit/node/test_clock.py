"""The clock that ticks are made of."""

import pytest

from giraff_node import robot_now_ns

BOOTTIME = 7  # linux/time.h


def test_the_robots_clock_is_the_kernels_that_goes_on_through_a_suspend(monkeypatch: pytest.MonkeyPatch) -> None:
    """Until a machine is suspended it cannot be told from the others; tests/hosts has one that was."""
    asked = []

    def ask(number: int) -> int:
        asked.append(number)
        return 42

    monkeypatch.setattr("giraff_node.time.clock_gettime_ns", ask)
    assert robot_now_ns() == 42
    assert asked == [BOOTTIME]

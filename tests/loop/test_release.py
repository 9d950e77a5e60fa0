"""The keys r and y of a keyboard beside others who stop the robot, with the services themselves."""

from __future__ import annotations

import pytest

from tests.loop.operators import Scene, scene


def asks(it: Scene) -> None:
    """Stop it, and press r."""
    it.engage()
    it.run(1.0)
    it.type(b"r")
    it.run(1.0)


def test_y_releases_the_stop_that_was_shown_and_moves_nothing() -> None:
    with scene() as it:
        asks(it)
        stopped = it.now
        it.type(b"y")
        it.run(1.0)
        assert not it.loop.newest["estop"].engaged
        assert it.driven_ms(stopped) == 0


@pytest.mark.parametrize("late", [0.004, 0.1, 0.2, 0.3, 0.9])
def test_a_stop_that_is_asked_for_between_r_and_y_is_not_released(late: float) -> None:
    """By the same hand for the same reason, so that it is the same latch; heard here, or on its way."""
    with scene() as it:
        asks(it)
        latch = it.loop.newest["estop"].id
        it.engage()
        it.run(late)
        it.type(b"y")
        it.run(2.0)
        assert (it.loop.newest["estop"].engaged, it.loop.newest["estop"].id) == (True, latch)

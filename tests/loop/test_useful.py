"""How useful the robot is, in simulated time: a part of what tests/campaign/test_useful.py does."""

from __future__ import annotations

import pytest

from tests.loop.useful import DEMO_SPEED, HALL_S, PASSED_S, RELEASE_S, demo_speed, hall, walks_off


def test_an_empty_hall_is_crossed() -> None:
    crossed = hall(0)
    print(f"hall: {crossed.seconds:.1f} s, at rest {crossed.rest:.3f} m from its end")
    assert 10.0 < crossed.seconds <= HALL_S
    assert crossed.rest >= 0.25
    assert crossed.contacts == 0


@pytest.mark.parametrize("into_the_open", [True, False])
def test_a_person_who_walks_off_is_soon_passed(into_the_open: bool) -> None:
    """Of these two seeds an echo that is remembered beside the person holds the robot in the second, in the open."""
    passings = [walks_off(seed, into_the_open=into_the_open) for seed in (0, 1)]
    print(f"passed after {[round(each.passed, 1) for each in passings]} s")
    assert max(each.passed for each in passings) <= PASSED_S
    if not into_the_open:
        assert max(each.moves for each in passings) <= RELEASE_S
    assert sum(each.contacts for each in passings) == 0


def test_the_demonstration_gets_on() -> None:
    """One robot for half a minute: they differ by a tenth and more."""
    speed = demo_speed(0, seconds=30.0)
    print(f"demonstration: {speed:.3f} m/s")
    assert speed >= 0.75 * DEMO_SPEED

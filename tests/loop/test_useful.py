"""How useful the robot is, in simulated time: a part of what tests/campaign/test_useful.py does."""

import pytest

from tests.loop.useful import DEMO_SPEED, PASSED_S, RELEASE_S, demo_speed, hall, walks_off


def test_an_empty_hall_is_crossed() -> None:
    """In its last metres nothing has been heard for long: a guard that trusts no silence there creeps."""
    crossed = hall(0, length=7.5)
    print(f"hall: {crossed.seconds:.1f} s, at rest {crossed.rest:.3f} m from its end")
    assert 10.0 < crossed.seconds <= 28.0
    assert crossed.rest >= 0.25
    assert crossed.contacts == 0


@pytest.mark.parametrize("into_the_open", [True, False])
def test_a_person_who_walks_off_is_soon_passed(into_the_open: bool) -> None:
    """With this seed an echo that is remembered beside the person holds the robot in the open."""
    passing = walks_off(1, into_the_open=into_the_open)
    print(f"passed after {passing.passed:.1f} s")
    assert passing.passed <= PASSED_S
    if not into_the_open:
        assert passing.moves <= RELEASE_S
    assert passing.contacts == 0


def test_the_demonstration_gets_on() -> None:
    """One robot for a quarter of a minute: they differ by a tenth and more."""
    speed = demo_speed(0, seconds=15.0)
    print(f"demonstration: {speed:.3f} m/s")
    assert speed >= 0.75 * DEMO_SPEED

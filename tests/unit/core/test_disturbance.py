"""A fall and a shake, whatever the rate at which they are read; and what is neither."""

import math
from collections.abc import Callable

import pytest

from giraff_core.tilt.clutch import Vector
from giraff_core.tilt.disturbance import SOUND, Disturbance, falling, shaken
from giraff_schemas.trouble import NO_TROUBLE, Trouble

RATES = [10.0, 16.0, 50.0, 60.0, 100.0, 200.0]
GRAVITY = 9.81


def judged(feel: Callable[[float], Vector], seconds: float, hertz: float) -> list[Trouble]:
    """Of each reading, rounded as a browser does."""
    disturbance = Disturbance("phone")
    times = [n / hertz for n in range(round(seconds * hertz))]
    return [disturbance.judge(rounded(feel(at)), at) for at in times]


def rounded(vector: Vector) -> Vector:
    x, y, z = (round(value, 1) for value in vector)
    return x, y, z


def still(at: float) -> Vector:
    tremor = 0.1 * math.sin(math.tau * 9.0 * at)
    return tremor, 0.0, GRAVITY + tremor


@pytest.mark.parametrize("hertz", RATES)
def test_a_hand_with_its_tremor_is_a_hand(hertz: float) -> None:
    assert set(judged(still, 20.0, hertz)) == {NO_TROUBLE}


@pytest.mark.parametrize("hertz", RATES)
def test_a_wrist_that_hurries_is_a_hand(hertz: float) -> None:
    """To and fro between 40 degrees, at up to 5 rad/s."""

    def turning(at: float) -> Vector:
        angle = 0.7 * math.sin(at * 5.0 / 0.7)
        return GRAVITY * math.sin(angle), 0.0, GRAVITY * math.cos(angle)

    assert set(judged(turning, 5.0, hertz)) == {NO_TROUBLE}


@pytest.mark.parametrize("hertz", RATES)
@pytest.mark.parametrize("swing", [4.0, 6.3])
def test_a_shake_is_told_within_six_readings_or_0_15_s(hertz: float, swing: float) -> None:
    def feel(at: float) -> Vector:
        return 25.0 * math.sin(math.tau * swing * at + 0.3), 0.0, GRAVITY

    assert shaken("phone") in judged(feel, max(0.15, 5.5 / hertz), hertz)


@pytest.mark.parametrize("hertz", RATES)
def test_a_fall_is_told_by_its_first_reading_and_is_over_after_half_a_second_of_quiet(hertz: float) -> None:
    def feel(at: float) -> Vector:
        return still(at) if at < 1.0 or at >= 1.2 else (0.0, 0.1, 0.1)

    told = judged(feel, 3.0, hertz)
    first = round(1.0 * hertz)
    assert told[:first] == [NO_TROUBLE] * first
    assert told[first] == falling("phone")
    over = told.index(NO_TROUBLE, first) / hertz
    assert 1.2 + SOUND - 2.0 / hertz <= over <= 1.2 + SOUND + 6.0 * max(0.02, 1.0 / hertz)
    assert not any(told[told.index(NO_TROUBLE, first) :])


@pytest.mark.parametrize("hertz", RATES)
def test_one_knock_is_no_shake(hertz: float) -> None:
    def feel(at: float) -> Vector:
        x, y, z = still(at)
        return (x + 12.0 if 0.5 <= at < 0.5 + 1.0 / hertz else x), y, z

    assert set(judged(feel, 2.0, hertz)) == {NO_TROUBLE}

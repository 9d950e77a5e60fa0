"""When a reading is no hand's: free fall, shake, a frozen sensor, a joystick laid down. And when it is one."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.live import Live
from giraff_core.tilt.disturbance import SOUND
from giraff_joystick.hand_detector import (
    DETECTION_S,
    FALLING,
    FROZEN,
    LAID_DOWN,
    SHAKEN,
    Counts,
    HandDetector,
)
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_sim.world.bno055 import GRAVITY, Vector
from tests.unit.joystick.frames import ANGLE
from tests.unit.joystick.hands import MODAL_TREMOR, NOISE, PERIOD, counts, readings, tilted

SOUND_READINGS = round(SOUND / PERIOD)


def judge(attention: HandDetector, seen: Counts, *, deflected: bool) -> Trouble:
    return attention.alarm(seen) or attention.laid_down(seen, deflected=deflected)


def judged(seen: list[Counts], *, deflected: bool = True) -> list[Trouble]:
    attention = HandDetector(Live(ANGLE))
    return [judge(attention, each, deflected=deflected) for each in seen]


def held(seconds: float, degrees: float = 30.0, seed: int = 1) -> list[Counts]:
    return list(readings(lambda _: tilted(degrees), seconds, tremor=MODAL_TREMOR, seed=seed))


@pytest.mark.parametrize("seed", range(20))
def test_a_hand_that_holds_as_still_as_most_do_is_a_hand(seed: int) -> None:
    assert set(judged(held(60.0, seed=seed))) == {NO_TROUBLE}


@given(st.floats(0.2, 5.0), st.floats(-80.0, 80.0), st.floats(-80.0, 80.0), st.integers(0, 9))
def test_a_wrist_that_hurries_is_a_hand(rate: float, begin: float, end: float, seed: int) -> None:
    """Turned at up to 5 rad/s, 290 degrees a second."""

    def turning(now: float) -> Vector:
        way = math.degrees(rate) * max(0.0, now - 0.2)
        return tilted(begin + math.copysign(min(way, abs(end - begin)), end - begin))

    assert set(judged(list(readings(turning, 1.0, tremor=MODAL_TREMOR, seed=seed)))) == {NO_TROUBLE}


@pytest.mark.parametrize("tumbling", [0.0, 0.5, 2.9])
def test_free_fall_is_told_by_its_first_reading(tumbling: float) -> None:
    fall = counts((0.0, tumbling, 0.0))
    before = held(0.5)
    assert judged([*before, fall]) == [NO_TROUBLE] * len(before) + [FALLING]
    assert DETECTION_S[FALLING] == 0.02


def test_what_is_a_third_of_gravity_is_no_fall() -> None:
    assert judged([counts((0.0, 0.0, 3.1))]) == [NO_TROUBLE]


@given(st.floats(4.0, 8.0), st.floats(12.0, 35.0), st.floats(0.0, math.tau), st.sampled_from("xyz"))
def test_a_shake_is_told_within_a_tenth_of_a_second(hertz: float, peak: float, phase: float, axis: str) -> None:
    def shaken(now: float) -> Vector:
        swing = peak * math.sin(math.tau * hertz * now + phase)
        return (swing if axis == "x" else 0.0), (swing if axis == "y" else 0.0), GRAVITY + (swing * (axis == "z"))

    before = held(0.5, degrees=0.0)
    after = judged([*before, *readings(shaken, 0.12)])[len(before) :]
    told = next(step for step, reason in enumerate(after) if reason)
    assert told * PERIOD <= DETECTION_S[SHAKEN] == 0.1


@pytest.mark.parametrize("knock", [(30.0, 0.0, 9.8), (-8.0, 8.0, 20.0)])
def test_a_knock_of_one_reading_is_no_shake(knock: Vector) -> None:
    assert set(judged([*held(0.5), counts(knock), *held(0.5)])) == {NO_TROUBLE}


@pytest.mark.parametrize("end", [[counts((0.0, 0.1, 0.1))], [counts((20.0 * (-1) ** n, 0.0, 9.8)) for n in range(8)]])
def test_it_is_over_after_half_a_second_of_quiet(end: list[Counts]) -> None:
    after = judged([*end, *held(2.0)])[len(end) :]
    over = after.index(NO_TROUBLE)
    assert all(after[:over])
    assert not any(after[over:])
    assert SOUND_READINGS <= over + 1 <= SOUND_READINGS + 5  # the last of the shake's own steps count, too


def test_a_thing_that_goes_on_moving_goes_on_not_counting() -> None:
    """Bounces on the floor: each one alone is no alarm, but nothing is over."""
    bounces = [counts((0.0, 0.0, 0.0)), *(counts((9.8 if n % 20 else 14.5, 0.0, 0.0)) for n in range(100))]
    noisy = [(x + n % 3, y, z) for n, (x, y, z) in enumerate(bounces)]
    assert all(judged(noisy))


def test_equal_readings_are_a_frozen_sensor_wherever_they_stand() -> None:
    for deflected in (True, False):
        reasons = judged([(500, 0, 840)] * 11, deflected=deflected)
        assert reasons == [NO_TROUBLE] * 9 + [FROZEN] * 2
    assert DETECTION_S[FROZEN] == 0.2


def test_a_sensor_that_thaws_counts_again_after_half_a_second() -> None:
    after = judged([(500, 0, 840)] * 20 + held(2.0))[20:]
    assert after.index(NO_TROUBLE) == SOUND_READINGS - 1
    assert not any(after[SOUND_READINGS:])


@pytest.mark.parametrize("noise", [NOISE / 3, NOISE])
def test_the_noise_of_a_sensor_that_lies_still_is_not_taken_for_frozen(noise: float) -> None:
    assert FROZEN not in judged(list(readings(lambda _: tilted(0.0), 60.0, noise=noise)), deflected=False)


@pytest.mark.parametrize("noise", [NOISE, 0.02], ids=["datasheet", "simulator"])
@pytest.mark.parametrize("seed", range(10))
def test_a_joystick_laid_down_is_told_within_a_second(noise: float, seed: int) -> None:
    before = held(3.0)
    laid = list(readings(lambda _: tilted(35.0), 3.0, noise=noise, seed=seed))
    after = judged([*before, *laid])[len(before) :]
    assert after[:49] == [NO_TROUBLE] * 49
    assert set(after[49:]) == {LAID_DOWN}
    assert DETECTION_S[LAID_DOWN] == 1.0


def test_one_that_lies_level_asks_for_nothing_and_is_no_fault() -> None:
    assert set(judged(list(readings(lambda _: tilted(0.0), 10.0)), deflected=False)) == {NO_TROUBLE}


def test_one_laid_down_is_a_hand_again_only_once_it_is_level() -> None:
    attention = HandDetector(Live(ANGLE))
    for each in readings(lambda _: tilted(30.0), 2.0):
        judge(attention, each, deflected=True)
    assert {judge(attention, each, deflected=True) for each in held(5.0)} == {LAID_DOWN}
    assert judge(attention, counts(tilted(2.0)), deflected=False) == NO_TROUBLE
    assert {judge(attention, each, deflected=True) for each in held(5.0)} == {NO_TROUBLE}


def test_after_a_gap_it_starts_over() -> None:
    attention = HandDetector(Live(ANGLE))
    judge(attention, (0, 0, 10), deflected=False)
    attention.forget()
    assert judge(attention, counts(tilted(30.0)), deflected=True) == NO_TROUBLE


vector = st.tuples(*[st.integers(-(2**15), 2**15 - 1)] * 3)


@given(st.lists(st.tuples(vector, st.booleans()), max_size=120))
def test_any_readings_at_all_are_judged(seen: list[tuple[Counts, bool]]) -> None:
    attention = HandDetector(Live(ANGLE))
    for each, deflected in seen:
        reason = judge(attention, each, deflected=deflected)
        assert reason in (NO_TROUBLE, FALLING, SHAKEN, FROZEN, LAID_DOWN)
        if math.hypot(*each) < 300:
            assert reason

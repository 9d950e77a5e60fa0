"""The stopping distance: closed form against small steps of time."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from giraff_guard.stopping import fastest, stopping_distance

SPEEDS = st.floats(0.0, 3.0)
TIMES = st.floats(0.0, 2.0)
DECELERATIONS = st.floats(0.2, 10.0)
ROOMS = st.floats(0.0, 20.0)


def stepped(speed: float, reaction_time: float, deceleration: float) -> float:
    """The same distance, by the trapezoid rule."""
    step = 0.0005
    way = speed * reaction_time
    while speed > 0.0:
        slower = max(0.0, speed - deceleration * step)
        lasts = (speed - slower) / deceleration
        way += (speed + slower) / 2 * lasts
        speed = slower
    return way


@pytest.mark.parametrize(
    ("speed", "reaction_time", "deceleration", "expected"),
    [(0.0, 0.3, 1.5, 0.0), (0.6, 0.0, 1.5, 0.12), (0.6, 0.3, 1.5, 0.3), (1.0, 0.5, 0.5, 1.5)],
)
def test_table(speed: float, reaction_time: float, deceleration: float, expected: float) -> None:
    assert stopping_distance(speed, reaction_time, deceleration) == pytest.approx(expected)
    assert stepped(speed, reaction_time, deceleration) == pytest.approx(expected, abs=1e-9)
    assert fastest(expected, reaction_time, deceleration) == pytest.approx(speed, abs=1e-9)


@given(speed=SPEEDS, reaction_time=TIMES, deceleration=st.floats(1.0, 10.0))
def test_closed_form_is_the_sum_of_small_steps(speed: float, reaction_time: float, deceleration: float) -> None:
    assert stopping_distance(speed, reaction_time, deceleration) == pytest.approx(
        stepped(speed, reaction_time, deceleration), abs=1e-6
    )


@example(room=5e-324, reaction_time=3e-207, deceleration=0.25)
@given(room=ROOMS, reaction_time=TIMES, deceleration=DECELERATIONS)
def test_the_fastest_speed_uses_up_the_room(room: float, reaction_time: float, deceleration: float) -> None:
    speed = fastest(room, reaction_time, deceleration)
    assert speed >= 0.0
    assert stopping_distance(speed, reaction_time, deceleration) == pytest.approx(room, abs=1e-6)


def test_a_run_on_is_in_each_stop_of_a_robot_that_moves() -> None:
    assert stopping_distance(0.4, 0.1, 0.35, run_on=0.12) == pytest.approx(0.04 + 0.2286 + 0.12, abs=1e-4)
    assert stopping_distance(0.0, 0.1, 0.35, run_on=0.12) == 0.0
    assert fastest(0.12, 0.1, 0.35, run_on=0.12) == 0.0


@example(room=1e-14, more=0.03125, reaction_time=1.9658179981575703, deceleration=1.5)
@given(room=ROOMS, more=st.floats(0.001, 5.0), reaction_time=TIMES, deceleration=DECELERATIONS)
def test_more_room_allows_more_and_more_delay_less(
    room: float, more: float, reaction_time: float, deceleration: float
) -> None:
    speed = fastest(room, reaction_time, deceleration)
    assert fastest(room + more, reaction_time, deceleration) >= speed
    assert fastest(room, reaction_time + more, deceleration) <= speed
    assert fastest(room, reaction_time, deceleration + more) >= speed - 1e-9


@pytest.mark.parametrize("room", [0.0, -0.001, -5.0])
def test_without_room_there_is_no_speed(room: float) -> None:
    assert fastest(room, 0.3, 1.5) == 0.0

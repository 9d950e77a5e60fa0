"""What is let through of a twist: never more than asked or allowed, with its curvature, its reason and a way out."""

import math

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from giraff_guard.obstacles import Verdicts
from tests.unit.guard.checks import check_passed
from tests.unit.guard.senses import CYCLE, FAR, NEAR, Senses, opened


@pytest.mark.parametrize(
    ("linear", "angular", "passed"),
    [
        (0.0, 3.0, (0.0, 1.57)),
        (0.0, -3.0, (0.0, -1.57)),
        (0.4, 3.14, (0.2, 1.57)),
        (-0.001, 3.14, (-0.0005, 1.57)),
        (1.2, 0.0, (0.6, 0.0)),
        (-1.2, 1.0, (-0.6, 0.5)),
        (0.6, 1.57, (0.6, 1.57)),
    ],
)
def test_what_the_robot_cannot_do_is_scaled_and_named(
    senses: Senses, linear: float, angular: float, passed: tuple[float, float]
) -> None:
    assert senses.passes(linear, angular) == pytest.approx(passed)
    reason = str(senses.limit(linear, angular).reason)
    assert (reason == "") is ((linear, angular) == passed)
    assert not reason or "this robot" in reason


@pytest.mark.parametrize("angular", [1.5, 0.36, 0.35, 0.2, 0.0, -0.2, -1.5])
def test_rotation_passes_slowly_where_the_way_ahead_is_blocked(senses: Senses, angular: float) -> None:
    senses.hear(NEAR)
    linear, passed = senses.passes(0.6, angular)
    assert linear == 0.0
    assert passed == pytest.approx(math.copysign(min(abs(angular), 0.35), angular))
    assert str(senses.limit(0.6, angular).reason).startswith("forward blocked: front_left sees something at 0.30 m; ")


@pytest.mark.parametrize(("linear", "expected"), [(0.6, 0.15), (-0.6, 0.02), (0.01, 0.15), (0.0, None)])
def test_the_ranges_moment_is_the_oldest_that_the_motion_relies_on(linear: float, expected: float | None) -> None:
    senses = opened()
    senses.wait(CYCLE)
    senses.hear(FAR, "front_left", age=0.05)
    senses.hear(FAR, "front_right", age=0.15)
    senses.hear(FAR, "rear", age=0.02)
    senses.judge()
    limited = senses.limit(linear, 1.0)
    assert limited.range_tick == (None if expected is None else senses.ago(expected))


def test_a_sensor_that_was_never_heard_is_relied_on_since_the_beginning_of_time(senses: Senses) -> None:
    senses.obstacles.forget()
    senses.wait(CYCLE)
    senses.hear(FAR, "front_left")
    senses.judge()
    never = msgspec.structs.replace(senses.ago(0.0), robot_ns=0)
    assert senses.limit(0.6, 0.0).range_tick == never
    assert senses.limit(-0.6, 0.0).range_tick == never


def test_before_anything_is_judged_nothing_passes() -> None:
    senses = Senses()
    limited = senses.limit(0.5, 0.5)
    assert (limited.linear_x, limited.angular_z) == (0.0, 0.0)
    assert limited.reason


def test_a_reading_counts_from_the_turn_after_it(senses: Senses) -> None:
    """A short reading is at zero in the turn that takes it."""
    senses.asked = (0.6, 0.0)
    senses.wait(0.1)
    senses.hear(NEAR, "front_right")
    senses.wait(0.02)
    assert senses.limit(0.6).linear_x == 0.0


def check_verdicts(verdicts: Verdicts) -> None:
    """That each verdict is whole: none says no without a number, a reason and a way out."""
    for verdict in verdicts[:4]:
        assert verdict.allowed >= 0.0
        assert (verdict.clearance == "blocked") == (verdict.allowed == 0.0)
        assert (verdict.clearance == "free") == (str(verdict.reason) == "")
        if verdict.clearance == "blocked":
            assert verdict.sensor
            assert "turn" in verdict.reason.remedy
    assert verdicts.turn_left.allowed >= 0.35, "a trap"
    assert verdicts.turn_right.allowed >= 0.35, "a trap"


DISTANCES = st.one_of(st.none(), st.floats(0.02, 4.0), st.sampled_from([3.0, 0.3]))


@settings(max_examples=20, derandomize=True)
@given(
    events=st.lists(
        st.tuples(
            st.tuples(DISTANCES, DISTANCES, DISTANCES),
            st.sampled_from(["", "", "", "front_left", "rear"]),  # faulty
            st.integers(-100, 600),  # age of the readings, ms
            st.floats(-0.7, 0.7),  # the robot's speed
            st.floats(-1.5, 1.5),
            st.one_of(st.just(0.0), st.floats(-2.0, 2.0).filter(lambda v: abs(v) > 1e-6)),
            st.floats(-6.0, 6.0),
            st.integers(0, 30),  # turns until the next
        ),
        max_size=12,
    )
)
def test_whatever_comes_in_no_more_comes_out_than_was_asked(
    events: list[tuple[tuple[float | None, ...], str, int, float, float, float, float, int]],
) -> None:
    senses = opened()
    for distances, faulty, age_ms, speed, turning, linear, angular, turns in events:
        senses.linear, senses.angular = speed, turning
        senses.wait(0.02 * turns, wheels=turns % 3 != 0)
        for sensor, distance in zip(senses.robot.sensors, distances, strict=True):
            senses.hear(distance, sensor, age=age_ms / 1000, fault="broken" if sensor == faulty else "")
        verdicts = senses.judge()
        check_verdicts(verdicts)
        limited = senses.limit(linear, angular)
        check_passed(limited, verdicts, linear, angular)
        assert (limited.range_tick is not None) is (linear != 0.0)

"""Pacing and freshness."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.freshness import TickFilter, age, age_here, derate
from giraff_core.timer import Timer
from giraff_schemas.messages import RobotTime, Tick

NOW = RobotTime(epoch=7, robot_ns=5_000_000_000)


def test_a_rate_is_kept_in_the_long_run() -> None:
    pace = Timer(50.0)
    turns = sum(pace.due(100.0 + step * 0.0007) for step in range(100_000))
    assert turns == pytest.approx(70.0 * 50.0, abs=2)


def test_missed_turns_are_not_made_up_for() -> None:
    pace = Timer(50.0)
    assert pace.due(0.0)
    assert pace.due(10.0)
    assert not pace.due(10.001)
    assert pace.wait(10.001) == pytest.approx(0.019)
    assert pace.due(10.02)


def test_age_is_what_the_ticks_prove() -> None:
    assert age(RobotTime(epoch=7, robot_ns=4_900_000_000), NOW) == pytest.approx(0.1)
    assert age(NOW, NOW) == 0.0


@pytest.mark.parametrize(
    "tick",
    [
        None,
        RobotTime(epoch=8, robot_ns=NOW.robot_ns),
        RobotTime(epoch=0, robot_ns=NOW.robot_ns),
        RobotTime(epoch=7, robot_ns=NOW.robot_ns + 1),
    ],
    ids=["none", "another epoch's", "nobody's", "of the future"],
)
def test_what_proves_nothing_is_infinitely_old(tick: RobotTime | None) -> None:
    assert age(tick, NOW) == math.inf


def test_nobodys_clock_proves_nothing() -> None:
    nobody = RobotTime(epoch=0, robot_ns=NOW.robot_ns)
    assert age(nobody, nobody) == math.inf


@pytest.mark.parametrize(
    ("epoch", "ahead", "since", "old"),
    [
        (7, -0.1, 0.02, 0.12),
        (7, 0.01, 0.02, 0.01),
        (7, 0.05, 0.02, 0.0),
        (8, 0.01, 0.0, math.inf),
        (0, 0.01, 0.0, math.inf),
    ],
)
def test_a_host_that_heard_a_tick_a_moment_ago_tells_an_age(epoch: int, ahead: float, since: float, old: float) -> None:
    tick = RobotTime(epoch=epoch, robot_ns=NOW.robot_ns + round(ahead * 1e9))
    newest = RobotTime(epoch=min(epoch, NOW.epoch), robot_ns=NOW.robot_ns)
    assert age_here(tick, newest, since) == pytest.approx(old)


@given(st.lists(st.tuples(st.integers(1, 8), st.integers(0, 50)), max_size=60))
def test_only_ticks_that_are_newer_than_all_of_their_start_of_base_count(said: list[tuple[int, int]]) -> None:
    clock = TickFilter()
    newest: dict[int, int] = {}
    for epoch, robot_ns in said:
        assert clock.is_newer(Tick(epoch=epoch, robot_ns=robot_ns), 5.0) == (robot_ns > newest.get(epoch, -1))
        newest[epoch] = max(robot_ns, newest.get(epoch, -1))


def test_a_tick_that_lies_ahead_holds_for_a_moment() -> None:
    clock = TickFilter()
    false = Tick(epoch=7, robot_ns=1 << 60)
    assert clock.is_newer(Tick(epoch=7, robot_ns=100), 1.0)
    assert clock.is_newer(false, 1.02)
    assert not clock.is_newer(Tick(epoch=7, robot_ns=102), 1.2)
    assert clock.is_newer(Tick(epoch=7, robot_ns=103), 1.24)
    assert not clock.is_newer(Tick(epoch=7, robot_ns=102), 1.25)


@given(st.floats(0.0, math.inf), st.floats(0.01, 10.0))
def test_speed_fades_from_half_the_budget_to_nothing_at_it(age_s: float, budget: float) -> None:
    share = derate(age_s, budget)
    assert 0.0 <= share <= 1.0
    if age_s <= budget / 2:
        assert share == 1.0
    if age_s >= budget:
        assert share == 0.0
    assert derate(0.75 * budget, budget) == pytest.approx(0.5)

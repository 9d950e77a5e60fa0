"""A timer whose turn may come early: at once, rarely enough in a flood, and not once more for what is a bit late."""

from itertools import pairwise

import pytest

from giraff_core.timer import LEAST_GAP, EarlyTimer

PERIOD = 0.02


def started() -> EarlyTimer:
    """Its first turn was at 0 s."""
    timer = EarlyTimer(1.0 / PERIOD)
    assert timer.due(0.0)
    return timer


def turns(timer: EarlyTimer, causes: list[float], until: float) -> list[float]:
    """When it is due, asked each tenth of a millisecond, with something in a hurry at each of `causes`."""
    found = []
    for step in range(round(until * 1e4)):
        now = step * 1e-4
        while causes and causes[0] <= now:
            timer.fire_now("it", causes.pop(0))
        if timer.due(now):
            found.append(round(now, 4))
    return found


def test_without_hurry_it_keeps_its_rate() -> None:
    assert turns(started(), [], 0.1) == pytest.approx([0.02, 0.04, 0.06, 0.08], abs=2e-4)


def test_what_is_in_a_hurry_has_its_turn_at_once_and_no_more() -> None:
    timer = started()
    timer.fire_now("it", 0.003)
    assert timer.wait(0.003) == 0.0
    assert timer.due(0.003)
    assert not timer.due(0.003)


def test_a_flood_makes_no_more_turns_than_its_gap_lets() -> None:
    found = turns(started(), [k * 1e-4 for k in range(10, 990)], 0.1)
    assert len(found) <= 0.1 / LEAST_GAP
    assert min(after - before for before, after in pairwise(found)) >= LEAST_GAP - 1e-9


def test_the_last_of_a_burst_waits_for_the_gap_and_not_for_the_period() -> None:
    timer = started()
    timer.fire_now("it", 0.010)
    assert timer.due(0.010)
    timer.fire_now("it", 0.011)
    assert not timer.due(0.011)
    assert timer.wait(0.011) == pytest.approx(LEAST_GAP - 0.001)
    assert timer.due(0.010 + LEAST_GAP)


def test_one_cause_does_not_make_another_wait() -> None:
    timer = started()
    timer.fire_now("command", 0.010)
    assert timer.due(0.010)
    timer.fire_now("range", 0.011)
    assert timer.due(0.011)


@pytest.mark.parametrize("late", [0.0, 0.0004, 0.002, 0.0045])
def test_what_comes_at_its_own_rate_makes_all_the_turns(late: float) -> None:
    """However late each second one is: a turn just before it would double the rate."""
    causes = [0.005 + k * PERIOD + late * (k % 2) for k in range(50)]
    found = turns(started(), list(causes), 1.0)
    assert found == pytest.approx(causes, abs=2e-4)


def test_when_it_ends_the_rate_goes_on() -> None:
    found = turns(started(), [0.005], 0.1)
    assert found == pytest.approx([0.005, 0.03, 0.05, 0.07, 0.09], abs=2e-4)

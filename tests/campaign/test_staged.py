"""Staged runs of the deterministic simulation that take long, and the same seeds in other processes."""

import pytest

from giraff_sim.dst.many import run_many
from tests.dst.replays import CLOCKS, hold_in_tcp, hold_in_the_serial_line, say_a_stream_again
from tests.loop.test_kills import BOUNDS, zero_after_kill
from tests.loop.test_mishaps import MISHAPS, hold_still, require_stop

LATE = (1.0, 2.0, 5.0, 8.0, 15.0, 30.0, 60.0)
"""s."""
SEEDS = range(8)


@pytest.mark.parametrize(("operator", "robot"), CLOCKS, ids=str)
def test_a_recorded_stream_moves_nothing_however_late_it_comes(operator: float, robot: float) -> None:
    say_a_stream_again(operator, robot, LATE)


@pytest.mark.parametrize("lasts", [1.5, 5.0, 12.0])
def test_what_tcp_held_during_a_cut_moves_nothing(lasts: float) -> None:
    hold_in_tcp(lasts)


@pytest.mark.parametrize("held", [1.5, 2.0, 8.0, 29.0, 60.0])
def test_queued_serial_frames_move_nothing(held: float) -> None:
    hold_in_the_serial_line(held)


@pytest.mark.parametrize("delay_ms", range(0, 180, 30))
@pytest.mark.parametrize("service", BOUNDS)
def test_pwm_is_zero_within_the_bound_whenever_a_service_ends(service: str, delay_ms: int) -> None:
    """The ranger's cycle takes 180 ms."""
    assert zero_after_kill(service, delay_ms) <= BOUNDS[service]


@pytest.mark.parametrize("delay_ms", range(0, 20, 4))
@pytest.mark.parametrize("mishap", MISHAPS)
def test_a_mishap_stops_the_robot_whenever_it_happens(mishap: str, delay_ms: int) -> None:
    """The tilt board's cycle takes 20 ms."""
    require_stop(mishap, delay_ms)


def test_a_hand_that_holds_still_for_a_minute_drives_for_a_minute() -> None:
    hold_still(60.0)


def test_another_process_makes_no_difference() -> None:
    """Each process has hashes of its own: nothing may hang on the order of a set."""
    here, there = (tuple(run_many(SEEDS, jobs)) for jobs in (1, 2))
    assert here == there

"""Old traffic that comes again moves no motor: a part of what `tests/campaign/test_staged.py` does."""

import pytest

from tests.dst.replays import CLOCKS, hold_in_tcp, hold_in_the_serial_line, say_a_stream_again

IN_STEP, *_, APART, OPPOSED = CLOCKS


def test_a_recorded_stream_moves_nothing_however_late_it_comes() -> None:
    say_a_stream_again(*IN_STEP, late=(1.0, 5.0, 8.0))


@pytest.mark.parametrize(("operator", "robot"), [APART, OPPOSED], ids=str)
def test_a_recorded_stream_moves_nothing_whatever_the_wall_clocks_say(operator: float, robot: float) -> None:
    say_a_stream_again(operator, robot, late=(1.0, 2.0))


@pytest.mark.parametrize("lasts", [1.5, 5.0])
def test_what_tcp_held_during_a_cut_moves_nothing(lasts: float) -> None:
    hold_in_tcp(lasts)


@pytest.mark.parametrize("held", [1.5, 8.0])
def test_queued_serial_frames_move_nothing(held: float) -> None:
    hold_in_the_serial_line(held)

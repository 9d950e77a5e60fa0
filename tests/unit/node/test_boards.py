"""What services with a board share: ticks on their way down and up, and counters that wrap."""

import itertools
from dataclasses import dataclass

from hypothesis import given
from hypothesis import strategies as st

from giraff_core.counters import signed32
from giraff_core.tick_relay import TickRelay, tick_of
from giraff_schemas.messages import RobotTime, Tick


@dataclass
class Carrier:
    """The part of a board's frame that matters here."""

    tick_epoch: int
    tick_robot_ns: int


COUNTERS = st.integers(min_value=0, max_value=(1 << 32) - 1)


@given(COUNTERS, st.integers(min_value=-(1 << 31), max_value=(1 << 31) - 1))
def test_the_way_between_two_counters_survives_their_wrap(counter: int, way: int) -> None:
    assert signed32((counter + way) % (1 << 32) - counter) == way


def test_ticks_are_numbered_and_the_numbers_wrap() -> None:
    down = TickRelay()
    frames = [down.frame(Tick(epoch=7, robot_ns=n), 0.02 * n) for n in range(70_000)]
    sequences = [frame.seq for frame in frames if frame is not None]
    assert len(sequences) == len(frames)
    assert sequences[0] == 1
    assert all((after - before) % (1 << 16) == 1 for before, after in itertools.pairwise(sequences))
    assert max(sequences) == (1 << 16) - 1
    sent = frames[123]
    assert sent is not None
    assert (sent.epoch, sent.robot_ns) == (7, 123)


def test_a_tick_that_was_overtaken_or_comes_again_does_not_go_down() -> None:
    down = TickRelay()
    ticks = (7, 100), (7, 100), (7, 99), (8, 50), (7, 98), (8, 49), (7, 101), (8, 51)
    sent = [down.frame(Tick(epoch=epoch, robot_ns=robot_ns), 1.0) for epoch, robot_ns in ticks]
    assert [(frame.epoch, frame.robot_ns) for frame in sent if frame] == [(7, 100), (8, 50), (7, 101), (8, 51)]
    assert [frame.seq for frame in sent if frame] == [1, 2, 3, 4]


def test_a_board_without_a_tick_proves_no_moment() -> None:
    assert tick_of(Carrier(tick_epoch=0, tick_robot_ns=99)) is None
    assert tick_of(Carrier(tick_epoch=7, tick_robot_ns=99)) == RobotTime(epoch=7, robot_ns=99)

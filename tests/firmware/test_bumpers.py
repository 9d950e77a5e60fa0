"""The ranger board's bumpers: nothing before it is asked, then each switch at once and with the newest tick."""

import itertools

import pytest

from giraff_schemas.boards import RANGER_BOARD
from giraff_schemas.wire import RangeFrame, TickFrame
from giraff_schemas.wires.bumper import BUMPER_PERIOD_MS, BUMPER_REST_MS, BumperFrame, BumperRequestFrame
from tests.firmware.bench import Bench
from tests.firmware.builds import compiled, open_board

LINE_MS = 2
"""A frame takes 0.6 ms, and arrives in the slice after the one in which it began."""


@pytest.fixture
def asked(ranger: Bench) -> Bench:
    """A ranger board that has been asked for its bumpers."""
    ranger.run(30)
    ranger.send(BumperRequestFrame(seq=1))
    ranger.run(5)
    return ranger


def measured(board: Bench) -> list[tuple[int, ...]]:
    return [(each.board_us, each.sensor, each.state, each.echo_us, each.line_errors) for each in board.all(RangeFrame)]


def test_a_board_is_silent_before_it_is_asked_and_its_ranges_stay_the_same(ranger: Bench) -> None:
    silent = Bench(open_board(RANGER_BOARD, compiled()))
    for board in (silent, ranger):
        board.board.on_ping(lambda sensor: 5800.0 + sensor)
        board.model.bumper_open[1] = 1
        board.run(100)
    ranger.send(BumperRequestFrame(seq=1))
    for board in (silent, ranger):
        board.run(900)
    silent.board.close()
    assert silent.all(BumperFrame) == []
    assert {frame.open for frame in ranger.all(BumperFrame)} == {2}
    assert len(ranger.all(BumperFrame)) == 900 // BUMPER_PERIOD_MS
    assert measured(silent) == measured(ranger)


def test_it_opens_at_once_and_closes_after_a_rest(asked: Bench) -> None:
    asked.run(3)
    asked.forget()
    pushed_ms = asked.now_ms
    asked.model.bumper_open[0] = 1
    asked.run(4)
    asked.model.bumper_open[0] = 0  # bounces
    asked.run(BUMPER_REST_MS - 2)
    asked.model.bumper_open[0] = 1
    asked.run(4)
    asked.model.bumper_open[0] = 0
    let_go_ms = asked.now_ms
    asked.run(200)
    told = list(zip(asked.arrivals(BumperFrame), asked.all(BumperFrame), strict=True))
    changes = [(at, after.open) for (_, before), (at, after) in itertools.pairwise(told) if before.open != after.open]
    assert (told[0][1].open, changes[0][1], len(changes)) == (1, 0, 1)
    assert told[0][0] - pushed_ms <= LINE_MS
    assert 0 <= changes[0][0] - let_go_ms - BUMPER_REST_MS <= LINE_MS


def test_each_frame_carries_the_tick_held_when_the_switches_were_read(asked: Bench) -> None:
    for number in range(200):  # one each ms; its 19 bytes take 0.4 ms
        asked.send(TickFrame(seq=number, epoch=9, robot_ns=asked.now_ms))
        asked.run(1)
    told = [frame for frame in asked.all(BumperFrame) if frame.tick_epoch]
    assert len(told) >= 3
    for frame in told:
        assert (frame.tick_epoch, frame.tick_robot_ns) == (9, frame.board_us // 1000 - 1)

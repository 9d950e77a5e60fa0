"""Each change of an encoder's two channels, as the base board tells it to the host that asks."""

import itertools
import math
from collections.abc import Iterator

import pytest

from giraff_schemas.boards import ARDROS_BOARD, BASE_BOARD
from giraff_schemas.wire import STAMPS_PER_MS, HelloFrame, HelloRequestFrame, WheelsFrame
from giraff_schemas.wires.transitions import (
    TRANSITION_A,
    TRANSITION_B,
    TRANSITION_STAMPS,
    TRANSITIONS_HOLD_MS,
    TRANSITIONS_OF_NONE,
    TRANSITIONS_PERIOD_MS,
    TransitionsFrame,
    TransitionsRequestFrame,
)
from giraff_sim.board import BUILD, Board, Implementation, open_board
from tests.firmware.bench import BaseBench, SpeedBench
from tests.firmware.builds import compiled

LEVELS = TRANSITION_A | TRANSITION_B
STATES = (0, TRANSITION_A, LEVELS, TRANSITION_B)
"""Levels of both channels, one quadrature state after the other; those of encoder 1 have B inverted."""
RING = 127


def board_of(implementation: Implementation) -> Board:
    compiled()
    return open_board(BASE_BOARD, implementation, BUILD)


@pytest.fixture(params=[*Implementation], ids=str)
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    """A base board by each of the two ways its firmware runs."""
    board = board_of(request.param)
    yield board
    board.close()


class Shaft:
    """The simulated shaft of an encoder: the truth about its transitions."""

    def __init__(self, bench: BaseBench, encoder: int) -> None:
        self.motor = bench.model.motor[encoder]
        self.encoder = encoder
        self.transitions: list[tuple[int, float]] = []
        """Levels just after each, and its time in ms."""
        self._bench = bench
        self._before = bench.before_each_ms
        bench.before_each_ms = self._each_ms

    def _each_ms(self) -> None:
        begin = self.motor.position
        self._before()
        end = self.motor.position
        if end > begin:
            crossed = [(edge, edge) for edge in range(math.floor(begin) + 1, math.floor(end) + 1)]
        else:
            crossed = [(edge, edge - 1) for edge in range(math.floor(begin), math.floor(end), -1)]
        for edge, state in crossed:
            levels = STATES[state % 4] ^ (TRANSITION_B if self.encoder else 0)
            self.transitions.append((levels, self._bench.now_ms + (edge - begin) / (end - begin)))


def ask(bench: BaseBench, encoder: int) -> None:
    bench.send(TransitionsRequestFrame(seq=1, encoder=encoder))
    bench.run(2)


def told(bench: BaseBench) -> list[int]:
    """All transitions so far, as words of the wire."""
    for frame in bench.all(TransitionsFrame):
        assert not any(frame.transitions[frame.count :])
    return [word for frame in bench.all(TransitionsFrame) for word in frame.transitions[: frame.count]]


def agree(words: list[int], truth: list[tuple[int, float]]) -> None:
    """The board tells what happened, in order, with times between that are right to two whole stamps."""
    assert [word & LEVELS for word in words] == [levels for levels, _ in truth]
    for word, (before, after) in zip(words[1:], itertools.pairwise(truth), strict=True):
        stamps = (after[1] - before[1]) * STAMPS_PER_MS
        assert abs((word & TRANSITION_STAMPS) - round(min(stamps, TRANSITION_STAMPS))) <= 2


def has_telemetry_at_100_hz(bench: BaseBench) -> bool:
    """Each frame of it comes; one waits for up to half a millisecond while the processor makes another."""
    times = [frame.board_us for frame in bench.all(WheelsFrame)]
    return all(later - earlier == pytest.approx(10_000, abs=600) for earlier, later in itertools.pairwise(times))


@pytest.mark.parametrize(("encoder", "speeds"), [(0, (0.25, -0.25)), (1, (0.25, -0.25)), (1, (-0.1, 0.25))])
def test_each_transition_of_a_driven_wheel_is_told_with_its_time(
    board: Board, encoder: int, speeds: tuple[float, float]
) -> None:
    robot = SpeedBench(board)
    shaft = Shaft(robot, encoder)
    ask(robot, encoder)
    robot.run(10)
    robot.begin()
    for _ in range(5):
        robot.send(TransitionsRequestFrame(seq=1, encoder=encoder))
        robot.go(*speeds, 240)
    assert robot.speed[encoder] == pytest.approx(speeds[encoder], abs=0.01)
    robot.send(TransitionsRequestFrame(seq=1, encoder=encoder))
    robot.hands = [lambda _ms: 0.0, lambda _ms: 0.0]
    robot.go(0.0, 0.0, 200)
    assert len(shaft.transitions) > 900
    agree(told(robot), shaft.transitions)
    assert told(robot)[0] & TRANSITION_STAMPS == TRANSITION_STAMPS
    assert has_telemetry_at_100_hz(robot)
    assert {frame.encoder for frame in robot.all(TransitionsFrame)} == {encoder}
    assert (robot.damaged, robot.wheels().line_errors, robot.wheels().refused) == (0, 0, 0)


def turn(bench: BaseBench, states: float, milliseconds: int) -> None:
    """Turn the shaft of encoder 0 evenly, and ask for it all the while."""
    for millisecond in range(milliseconds):
        if millisecond % 100 == 0:
            bench.send(TransitionsRequestFrame(seq=1, encoder=0))
        bench.model.motor[0].position += states / milliseconds
        bench.run(1)


def test_a_full_ring_marks_the_gap_and_nothing_else_is_wrong(board: Board) -> None:
    bench = BaseBench(board)
    ask(bench, 0)
    bench.forget()
    turn(bench, 4000, 500)  # 8 each ms: the line takes 2 beside telemetry
    turn(bench, 0, 200)
    words = told(bench)
    gaps = [k for k, word in enumerate(words) if word & TRANSITION_STAMPS == TRANSITION_STAMPS]
    assert len(words) < 4000
    assert len(gaps) > 2
    assert gaps[0] == 0
    for begin, end in itertools.pairwise(gaps):
        assert end - begin >= RING
    for k, (before, after) in enumerate(itertools.pairwise(words), 1):
        if k not in gaps:
            assert STATES.index(after & LEVELS) == (STATES.index(before & LEVELS) + 1) % 4
            assert after & TRANSITION_STAMPS == pytest.approx(STAMPS_PER_MS / 8, abs=2)
    assert bench.wheels().left_ticks == 2000
    assert has_telemetry_at_100_hz(bench)
    assert (bench.damaged, bench.wheels().line_errors) == (0, 0)


def test_where_interrupts_come_too_late_the_word_is_marked() -> None:
    """Far beyond any robot: both channels change before the board has looked."""
    board = board_of(Implementation.AVR)
    bench = BaseBench(board)
    turn(bench, 7000, 100)
    turn(bench, 0, 200)
    unmarked = [
        (before ^ after) & LEVELS
        for before, after in itertools.pairwise(told(bench))
        if after & TRANSITION_STAMPS != TRANSITION_STAMPS
    ]
    assert len(unmarked) > 50
    assert set(unmarked) == {TRANSITION_A, TRANSITION_B}
    board.close()


@pytest.mark.parametrize("rest_ms", [100, 300, 1000])
def test_a_rest_longer_than_the_word_holds_is_told_as_longer(board: Board, rest_ms: int) -> None:
    """Stamps wrap after 910 ms."""
    bench = BaseBench(board)
    turn(bench, 2, 16)
    turn(bench, 0, rest_ms - 8)
    turn(bench, 2, 16)
    turn(bench, 0, 60)
    _, _, after, last = (word & TRANSITION_STAMPS for word in told(bench))
    assert last == pytest.approx(8 * STAMPS_PER_MS, abs=2)
    assert after == pytest.approx(min(rest_ms * STAMPS_PER_MS, TRANSITION_STAMPS), abs=2)


def busy(bench: BaseBench) -> float:
    """Turn the shaft and tell the share of that time in which the processor was awake."""
    awake = 0.0
    for _ in range(200):
        bench.model.motor[0].position += 8
        bench.run(1)
        awake += bench.model.awake
    return awake / 200


def test_unasked_it_tells_nothing_and_no_change_interrupts_it() -> None:
    board = board_of(Implementation.AVR)
    bench = BaseBench(board)
    unasked = busy(bench)
    assert bench.all(TransitionsFrame) == []
    ask(bench, 0)
    asked = busy(bench)
    ask(bench, TRANSITIONS_OF_NONE)
    bench.run(20)
    assert asked > unasked + 0.1
    assert busy(bench) == pytest.approx(unasked, abs=0.005)
    board.close()


@pytest.mark.parametrize("end", [None, TRANSITIONS_OF_NONE])
def test_a_request_holds_for_half_a_second_or_until_its_end(board: Board, end: int | None) -> None:
    bench = BaseBench(board)
    shaft = Shaft(bench, 0)
    ask(bench, 0)
    began = bench.now_ms
    if end is not None:
        bench.run(100)
        ask(bench, end)
    bench.run(1000)
    arrivals = bench.arrivals(TransitionsFrame)
    assert arrivals[-1] - began == pytest.approx(100 if end else TRANSITIONS_HOLD_MS, abs=TRANSITIONS_PERIOD_MS + 10)
    assert shaft.transitions == []


def test_a_request_for_an_encoder_that_is_not_there_is_ignored(board: Board) -> None:
    bench = BaseBench(board)
    ask(bench, 7)
    bench.run(100)
    assert bench.all(TransitionsFrame) == []
    ask(bench, 1)
    ask(bench, 7)
    bench.run(100)
    assert {frame.encoder for frame in bench.all(TransitionsFrame)} == {1}
    assert bench.wheels().line_errors == 0


def test_another_encoder_begins_anew(board: Board) -> None:
    bench = BaseBench(board)
    turn(bench, 10, 20)
    ask(bench, 1)
    bench.forget()
    bench.model.motor[0].position += 20
    bench.model.motor[1].position += 3
    bench.run(120)
    assert len(told(bench)) == 3
    assert told(bench)[0] & TRANSITION_STAMPS == TRANSITION_STAMPS


def test_ardros_answers_nothing_and_goes_on() -> None:
    compiled()
    board = open_board(ARDROS_BOARD, Implementation.HOST, BUILD)
    bench = BaseBench(board)
    ask(bench, 0)
    bench.send(HelloRequestFrame(seq=2))
    bench.run(100)
    assert len(bench.all(HelloFrame)) == 2
    assert {type(frame) for frame in bench.frames} == {HelloFrame, WheelsFrame}
    assert bench.damaged == 0
    assert TransitionsFrame.type not in ARDROS_BOARD.frames
    board.close()

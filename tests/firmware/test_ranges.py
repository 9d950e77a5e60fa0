"""The ranger board and its three sensors: distances, and what is not one."""

import itertools
from collections.abc import Callable

import pytest

from giraff_schemas.wire import (
    ECHO_US_PER_M,
    RANGE_SENSORS,
    RANGE_SLOT_MS,
    RangeFault,
    RangeFrame,
    RangeState,
    TickFrame,
)
from tests.firmware.bench import Bench

US_PER_CM = ECHO_US_PER_M / 100
CYCLE_MS = RANGE_SENSORS * RANGE_SLOT_MS
NEVER_RISES, STAYS_HIGH = 0.0, -1.0  # as board_model.h has them
NO_ECHO_US, CLONE_NO_ECHO_US = 38_000.0, 180_000.0
WALL_US = 100 * US_PER_CM


def hear(ranger: Bench, echo_us: Callable[[int], float]) -> None:
    ranger.board.on_ping(echo_us)


def of(ranger: Bench, sensor: int) -> list[RangeFrame]:
    return [frame for frame in ranger.all(RangeFrame) if frame.sensor == sensor]


def results(ranger: Bench, sensor: int) -> list[tuple[int, int]]:
    return [(frame.state, frame.fault) for frame in of(ranger, sensor)]


ECHO = (RangeState.ECHO, RangeFault.NONE)
CLEAR = (RangeState.CLEAR, RangeFault.NONE)
SILENT = (RangeState.FAULT, RangeFault.NO_ECHO_PULSE)
STUCK = (RangeState.FAULT, RangeFault.STUCK_HIGH)
SHORT = (RangeState.FAULT, RangeFault.TOO_SHORT)


def test_sensors_are_pinged_in_turn_one_a_slot(ranger: Bench) -> None:
    hear(ranger, lambda _: WALL_US)
    ranger.run(1850)
    told = ranger.all(RangeFrame)
    assert [frame.sensor for frame in told] == [0, 1, 2] * 10
    slots = {later.board_us - earlier.board_us for earlier, later in itertools.pairwise(told)}
    assert slots == {RANGE_SLOT_MS * 1000}
    assert list(ranger.model.pings) == [10, 10, 10]


def test_2_to_395_cm_within_a_centimetre(ranger: Bench) -> None:
    asked: list[float] = []

    def echo(_sensor: int) -> float:
        asked.append(2.0 + len(asked) * 1.31)
        return asked[-1] * US_PER_CM

    hear(ranger, echo)
    ranger.run(301 * RANGE_SLOT_MS)
    told = ranger.all(RangeFrame)
    assert max(asked[: len(told)]) >= 393
    for frame, distance in zip(told, asked, strict=False):
        assert (frame.state, frame.fault) == ECHO
        assert frame.echo_us / US_PER_CM == pytest.approx(distance, abs=0.1)


@pytest.mark.parametrize(
    ("centimetres", "state"), [(2.0, ECHO), (394.9, ECHO), (395.0, ECHO), (410.0, CLEAR), (500.0, CLEAR)]
)
def test_the_ends_of_the_measuring_range(ranger: Bench, centimetres: float, state: tuple[int, int]) -> None:
    hear(ranger, lambda _: centimetres * US_PER_CM)
    ranger.run(1000)
    assert set(results(ranger, 0)) == {state}


def test_nothing_in_range_is_clear_and_never_a_phantom(ranger: Bench) -> None:
    hear(ranger, lambda _: NO_ECHO_US)
    ranger.run(3000)
    assert {(frame.state, frame.fault) for frame in ranger.all(RangeFrame)} == {CLEAR}
    assert len(ranger.all(RangeFrame)) == pytest.approx(3000 / RANGE_SLOT_MS, abs=1.5)


@pytest.mark.parametrize(
    ("answer", "result"), [(NEVER_RISES, SILENT), (STAYS_HIGH, STUCK), (30.0, SHORT), (80.0, SHORT)]
)
def test_a_fault_is_named_and_the_other_sensors_keep_their_cadence(
    ranger: Bench, answer: float, result: tuple[int, int]
) -> None:
    hear(ranger, lambda sensor: answer if sensor == 1 else WALL_US)
    ranger.run(3000)
    assert set(results(ranger, 1)) == {result}
    for sensor in (0, 2):
        told = of(ranger, sensor)
        assert set(results(ranger, sensor)) == {ECHO}
        periods = {later.board_us - earlier.board_us for earlier, later in itertools.pairwise(told)}
        assert periods == {CYCLE_MS * 1000}


@pytest.mark.parametrize("answer", [NEVER_RISES, STAYS_HIGH, 30.0])
def test_a_sensor_that_is_well_again_measures_again(ranger: Bench, answer: float) -> None:
    answers = [WALL_US]
    hear(ranger, lambda _: answers[0])
    ranger.run(500)
    answers[0] = answer
    ranger.run(1500)
    ranger.forget()
    answers[0] = WALL_US
    ranger.run(1000)
    for sensor in range(RANGE_SENSORS):
        assert results(ranger, sensor)[1:] == [ECHO] * (len(results(ranger, sensor)) - 1)
        assert len(results(ranger, sensor)) >= 3


def test_a_line_that_sticks_is_never_told_as_clear(ranger: Bench) -> None:
    answers = itertools.chain([WALL_US, WALL_US, WALL_US], itertools.repeat(STAYS_HIGH))
    hear(ranger, lambda sensor: next(answers) if sensor == 0 else WALL_US)
    ranger.run(4000)
    told = results(ranger, 0)
    assert told[:3] == [ECHO] * 3
    assert set(told[3:]) == {STUCK}
    assert len(told[3:]) >= 6


def test_a_line_that_is_high_from_the_start_is_stuck(ranger: Bench) -> None:
    hear(ranger, lambda _: STAYS_HIGH)
    ranger.run(1000)
    ranger.board.reset()
    ranger.forget()
    ranger.run(1000)
    assert {(frame.state, frame.fault) for frame in ranger.all(RangeFrame)} == {STUCK}


def told_by_clone(ranger: Bench, after: float) -> list[RangeFrame]:
    """What a clone tells that finds nothing, then gives a pulse of `after`, then sees a wall at 1 m."""
    answers = itertools.chain([CLONE_NO_ECHO_US, after], itertools.repeat(WALL_US))
    hear(ranger, lambda sensor: next(answers) if sensor == 0 else WALL_US)
    ranger.run(1300)
    assert set(results(ranger, 1)) == {ECHO}
    return of(ranger, 0)


@pytest.mark.parametrize("centimetres", [1, 4, 6.5, 9, 14])
def test_what_a_clone_reports_after_its_long_silence_is_not_believed(ranger: Bench, centimetres: float) -> None:
    first, *others = told_by_clone(ranger, centimetres * US_PER_CM)
    assert (first.state, first.fault) == CLEAR
    assert first.echo_us == pytest.approx(CLONE_NO_ECHO_US, abs=5)
    assert len(others) >= 2
    assert {frame.echo_us // 100 for frame in others} == {WALL_US // 100}


def test_but_a_wall_farther_away_is_believed_at_once(ranger: Bench) -> None:
    first, second, *_ = told_by_clone(ranger, 40 * US_PER_CM)
    assert (first.state, first.fault) == CLEAR
    assert second.echo_us == pytest.approx(40 * US_PER_CM, abs=5)


def test_what_comes_near_once_a_clone_hears_again_is_believed(ranger: Bench) -> None:
    """The doubt is of one pulse."""
    answers = itertools.chain([CLONE_NO_ECHO_US, WALL_US, WALL_US], itertools.repeat(5 * US_PER_CM))
    hear(ranger, lambda sensor: next(answers) if sensor == 0 else WALL_US)
    ranger.run(1300)
    near = of(ranger, 0)[-1]
    assert (near.state, near.fault) == ECHO
    assert near.echo_us == pytest.approx(5 * US_PER_CM, abs=5)


def test_after_an_ordinary_silence_a_near_wall_is_believed_at_once(ranger: Bench) -> None:
    answers = itertools.chain([NO_ECHO_US], itertools.repeat(5 * US_PER_CM))
    hear(ranger, lambda sensor: next(answers) if sensor == 0 else WALL_US)
    ranger.run(2 * CYCLE_MS)
    assert results(ranger, 0) == [CLEAR, ECHO]


@pytest.mark.parametrize(
    ("answer", "known_ms"),
    [(WALL_US, 0.45 + WALL_US / 1000), (NO_ECHO_US, 0.45 + 38), (NEVER_RISES, 10), (STAYS_HIGH, 250.45)],
)
def test_a_result_is_sent_as_soon_as_it_is_known(ranger: Bench, answer: float, known_ms: float) -> None:
    hear(ranger, lambda sensor: answer if sensor == 0 else WALL_US)
    ranger.run(1000)
    line_and_slice_ms = 3
    first = next(
        (at, frame)
        for at, frame in zip(ranger.arrived_ms, ranger.frames, strict=True)
        if isinstance(frame, RangeFrame) and frame.sensor == 0
    )
    delay = first[0] - first[1].board_us / 1000
    assert known_ms <= delay <= known_ms + line_and_slice_ms


def test_a_frame_carries_the_tick_held_at_its_trigger(ranger: Bench) -> None:
    hear(ranger, lambda _: NO_ECHO_US)
    ranger.run(100)
    assert ranger.last(RangeFrame).tick_epoch == 0
    ranger.forget()
    for number in range(600):  # one each ms; its 19 bytes take 0.4 ms
        ranger.send(TickFrame(seq=number, epoch=9, robot_ns=ranger.now_ms))
        ranger.run(1)
    told = [frame for frame in ranger.all(RangeFrame) if frame.tick_epoch]
    assert len(told) >= 8
    for frame in told:
        assert frame.tick_epoch == 9
        assert frame.tick_robot_ns == frame.board_us // 1000 - 1

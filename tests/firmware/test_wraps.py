"""Every counter that wraps, seen across its wrap."""

import itertools
from collections.abc import Iterator

import pytest

from giraff_schemas.boards import BASE_BOARD, JOYSTICK_BOARD, RANGER_BOARD
from giraff_schemas.wire import (
    ECHO_MAX_AGE_MS,
    RANGE_SLOT_MS,
    TILT_PERIOD_MS,
    DriveState,
    Latch,
    RangeFrame,
    RangeState,
    Refusal,
    TiltFrame,
    TiltStatus,
    WheelsFrame,
    Wiring,
)
from tests.firmware.bench import BaseBench, Bench
from tests.firmware.bno055 import Bno055
from tests.firmware.builds import near_wraps, open_board

MS_WRAPS_AT = 1000  # simulated ms, as near_wraps.c has it
U32 = 1 << 32


@pytest.fixture
def base() -> Iterator[BaseBench]:
    board = open_board(BASE_BOARD, near_wraps())
    yield BaseBench(board)
    board.close()


def differences(values: list[int], modulus: int) -> set[int]:
    return {(later - earlier) % modulus for earlier, later in itertools.pairwise(values)}


def wraps(values: list[int]) -> int:
    return sum(later < earlier for earlier, later in itertools.pairwise(values))


def test_time_and_sequence_go_on_evenly(base: BaseBench) -> None:
    base.run(1500)
    told = base.all(WheelsFrame)
    for values, step, modulus in (
        ([frame.board_us for frame in told], 10_000, U32),
        ([frame.board_ms for frame in told], 10, U32),
        ([frame.seq for frame in told], 1, 1 << 16),
    ):
        assert wraps(values) == 1
        assert differences(values, modulus) == {step}


def drive_until(base: BaseBench, ms: int) -> None:
    """Drive as a healthy host does, up to a simulated millisecond."""
    base.start(40, 40)
    while base.now_ms < ms - 20:
        base.drive(40, 40)
    base.run(ms - base.now_ms)


def test_driving_goes_on_across_the_wrap_of_board_ms(base: BaseBench) -> None:
    drive_until(base, MS_WRAPS_AT - 100)
    for _ in range(20):
        base.drive(40, 40)
        assert base.duties() == (40, 40)
    assert base.wheels().refused == 0
    assert base.wheels().board_ms < MS_WRAPS_AT


@pytest.mark.parametrize(("age", "refusal"), [(ECHO_MAX_AGE_MS, Refusal.NONE), (ECHO_MAX_AGE_MS + 1, Refusal.STALE)])
def test_an_echo_from_before_the_wrap_is_as_old_as_it_is(base: BaseBench, age: int, refusal: Refusal) -> None:
    drive_until(base, MS_WRAPS_AT + 50)
    arrival = base.now_ms + 1 - MS_WRAPS_AT
    base.send(base.drive_frame(50, 50, board_ms=(arrival - age) % U32))
    base.run(15)
    assert base.wheels().last_refusal == refusal


def test_an_echo_from_beyond_the_wrap_is_from_the_future(base: BaseBench) -> None:
    drive_until(base, MS_WRAPS_AT - 50)
    base.send(base.drive_frame(50, 50, board_ms=0))
    base.run(15)
    assert base.wheels().last_refusal == Refusal.STALE


def test_the_time_out_keeps_its_length_across_the_wrap(base: BaseBench) -> None:
    drive_until(base, MS_WRAPS_AT - 150)
    base.send(base.drive_frame(50, 50))
    base.run(2)
    stopped_ms = base.stopped_after_ms()
    assert base.now_ms > MS_WRAPS_AT
    assert stopped_ms == pytest.approx(300, abs=2)
    base.run(15)
    assert base.wheels().drive_state == DriveState.COMMAND_TIMEOUT


@pytest.mark.parametrize("wiring", [0, Wiring.INVERT_LEFT_ENCODER])
def test_ticks_wrap_and_lose_none(base: BaseBench, wiring: int) -> None:
    base.configure(wiring=wiring)
    base.forget()
    base.run(15)
    for _ in range(100):
        base.model.motor[0].position += 40
        base.model.motor[1].position += 40
        base.run(1)
    base.run(15)
    told = base.all(WheelsFrame)
    for ticks in ([frame.left_ticks for frame in told], [frame.right_ticks for frame in told]):
        assert max(abs(later - earlier) for earlier, later in itertools.pairwise(ticks)) > 1 << 31
        steps = [(later - earlier + (1 << 31)) % U32 - (1 << 31) for earlier, later in itertools.pairwise(ticks)]
        assert abs(sum(steps)) == 2000
        assert max(abs(step) for step in steps) <= 200


@pytest.mark.parametrize(
    ("ticks_a_second", "cause"), [(300, Latch.NONE), (18, Latch.LEFT_STUCK), (-300, Latch.LEFT_OPPOSITE)]
)
def test_a_wheel_whose_ticks_wrap_is_judged_as_any_other(base: BaseBench, ticks_a_second: int, cause: Latch) -> None:
    base.configure(stall_level=25)
    ticks_to_wrap = 95 if ticks_a_second > 0 else 130  # of the low half, before it wraps forward or backward
    for motor in base.model.motor:
        motor.position = 2 * ticks_to_wrap
    base.run(20)
    base.drive(0, 0)

    def turn() -> None:
        for motor, speed in zip(base.model.motor, (ticks_a_second, 300), strict=True):
            motor.position += 2 * speed / 1000

    base.before_each_ms = turn
    base.drive(40, 40, 1000)
    told = [(frame.left_ticks & 0xFFFF) for frame in base.all(WheelsFrame)]
    assert any(abs(later - earlier) > 0x8000 for earlier, later in itertools.pairwise(told))
    assert base.wheels().latch == cause


def test_an_echo_across_the_wrap_of_board_us_is_as_long_as_it_is() -> None:
    board = open_board(RANGER_BOARD, near_wraps())
    ranger = Bench(board)
    board.on_ping(lambda _sensor: 22_000.0)
    ranger.run(2000)
    told = ranger.all(RangeFrame)
    rose = [(frame.board_us + 450) % U32 for frame in told]
    assert any(at + 22_000 >= U32 for at in rose), "one echo was in the air when the count wrapped"
    assert {frame.state for frame in told} == {RangeState.ECHO}
    assert all(frame.echo_us == pytest.approx(22_000, abs=5) for frame in told)
    assert differences([frame.board_us for frame in told], U32) == {RANGE_SLOT_MS * 1000}
    assert wraps([frame.seq for frame in told]) == 1
    board.close()


@pytest.mark.parametrize("delay_ms", [0, 20, 200, 700])
def test_a_bring_up_across_the_wrap_of_board_ms_takes_no_longer(delay_ms: int) -> None:
    """The count wraps in the reset, in the sensor's start, or while it is already read."""
    board = open_board(JOYSTICK_BOARD, near_wraps())
    joystick = Bench(board)
    sensor = Bno055(joystick)
    sensor.start_ms = 200 + delay_ms
    joystick.run(2000)
    told = joystick.all(TiltFrame)
    assert told[-1].status == TiltStatus.RUNNING
    assert len(sensor.resets_ms) == 1
    assert differences([frame.board_us for frame in told], U32) == {TILT_PERIOD_MS * 1000}
    assert differences([frame.seq for frame in told], 1 << 16) == {1}
    board.close()

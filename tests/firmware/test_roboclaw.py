"""The process in front of a RoboClaw: one request at a time, and a reset wherever the controller is not as it was."""

from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import cffi
import pytest

from giraff_schemas.wire import STUCK_MS, DriveState, Latch, Refusal, ResetCause, WheelsFrame
from tests.firmware.builds import FIRMWARE, shared_library
from tests.firmware.roboclaw_bench import (
    COMMAND,
    COUNTERS,
    COUNTS_ANEW,
    DAMAGES_REPLIES,
    FULL,
    GET_TIMEOUT,
    HANGS,
    HEARS_NOISE,
    IS_SUSPENDED,
    KEEPS_OTHER_TIMEOUT,
    LOSES_REPLIES,
    PROVED_MS,
    REPLIES_NOISE,
    RUNS,
    SAYS_OTHERWISE,
    STATUS,
    STOP,
    VERSION,
    Request,
    RoboclawBench,
)

REPLY_MS, QUIET_MS = 12, 15
OFF_MS: Final = 50
"""From full to none."""
TIMEOUT_MS: Final = 200
"""ms; the controller stops by itself after them, where no stop comes through."""
SHORT_PRESS_MS: Final = 40
LINE_MS: Final = 10
"""Within which a frame of the host has come, and the controller has a command of it."""
VERSION_PLACE: Final = len("USB Roboclaw 2x15a v")


@pytest.fixture
def board() -> Iterator[RoboclawBench]:
    """Not powered on for a single millisecond yet."""
    bench = RoboclawBench()
    yield bench
    bench.board.close()


def stops(board: RoboclawBench) -> list[Request]:
    return [each for each in board.asked if each[1:] == STOP]


NOT_PROVED: Final[dict[str, Callable[[RoboclawBench], Any]]] = {
    "no power": lambda board: setattr(board.model, "driver_volts", 0.0),
    "its line is cut": lambda board: setattr(board.model, "driver_line_cut", 1),
    "of version 3": lambda board: board.spoil(SAYS_OTHERWISE, VERSION, value=ord("3"), place=VERSION_PLACE),
    "keeps another time-out": lambda board: board.spoil(SAYS_OTHERWISE, GET_TIMEOUT, value=9),
    "tells no counters": lambda board: board.spoil(LOSES_REPLIES, COUNTERS),
    "acknowledges no stop": lambda board: board.spoil(LOSES_REPLIES, COMMAND),
    "answers with noise": lambda board: board.spoil(REPLIES_NOISE),
}


@pytest.mark.parametrize("what", NOT_PROVED)
def test_no_board_is_there_before_its_controller_is_proved(board: RoboclawBench, what: str) -> None:
    NOT_PROVED[what](board)
    for _ in range(4):
        board.run(250)
        NOT_PROVED[what](board)
    assert (board.model.tx_total, board.frames) == (0, [])
    assert [each for each in board.asked if each.drives] == []
    assert {each.command for each in board.asked} <= {COMMAND} or len(stops(board)) > 10, (
        "it is stopped again and again"
    )
    board.spoil(0)
    board.model.driver_volts, board.model.driver_line_cut = 23.4, 0
    assert board.cause() == ResetCause.POWER_ON
    assert (board.wheels().drive_state, board.wheels().battery_adc_counts) == (DriveState.NOT_CONFIGURED, 234)


def test_what_a_controller_is_asked_first_is_a_stop(board: RoboclawBench) -> None:
    causes: dict[str, Callable[[], Any]] = {
        "by the host": board.board.reset,
        "by its watchdog": lambda: setattr(board.model, "process_stalls", HANGS),
        "by the controller": lambda: board.spoil(COUNTS_ANEW, times=1),
    }
    for what, happens in causes.items():
        board.begin(40, 40)
        before = board.model.resets
        happens()
        while board.model.resets == before:
            board.run(1)
        mark = len(board.asked)
        board.run(QUIET_MS + 4)
        assert board.asked[mark][1:] == STOP, what


def test_a_level_is_that_duty(board: RoboclawBench) -> None:
    for levels in ((70, -70), (1, 70), (-33, 2)):
        board.begin(*levels)
        assert board.duties() == pytest.approx(levels, abs=0.01)
        assert board.until(COMMAND)[2:] == tuple(int(level * FULL / 255) for level in levels)
        board.board.reset()


def test_levels_that_come_in_turn_are_given_as_their_mean(tmp_path: Path) -> None:
    includes = [FIRMWARE / folder for folder in ("controller", "base", "common", "linux", "boards/roboclaw")]
    library = shared_library(tmp_path / "duty.so", FIRMWARE / "controller" / "duty.c", includes=includes)
    ffi = cffi.FFI()
    ffi.cdef(
        "void duty_on_millisecond(void); void duty_take(int16_t *duty, bool none); bool duty_must_stop(void);"
        "void hal_motor_direction(uint8_t motor, bool forward); void hal_motor_pwm(uint8_t motor, uint8_t counts);"
        "void hal_motor_off(uint8_t motor);"
    )
    duty: Any = ffi.dlopen(str(library))
    taken: Any = ffi.new("int16_t[2]")
    duty.hal_motor_direction(1, True)
    for level in (70, 71, 70, 71, 70):
        duty.hal_motor_pwm(0, level)
        duty.hal_motor_pwm(1, level)
        duty.duty_on_millisecond()
    duty.duty_take(taken, False)
    assert [*taken] == [-int(352 * FULL / 255 / 5), int(352 * FULL / 255 / 5)]
    assert not duty.duty_must_stop()
    duty.duty_on_millisecond()
    duty.hal_motor_off(0)
    assert duty.duty_must_stop()
    duty.duty_take(taken, False)
    assert [*taken] == [0, int(70 * FULL / 255)], "off is off at once"


def test_the_time_out_is_read_back_while_it_drives(board: RoboclawBench) -> None:
    board.begin(40, 40)
    board.drive(40, 40, 2000)
    read = [each.at_ms for each in board.asked if each.command == GET_TIMEOUT]
    assert len(read) > 10
    assert max(later - earlier for earlier, later in pairwise(read)) <= 200
    told = [each.at_ms for each in board.asked if each.command == COMMAND]
    assert max(later - earlier for earlier, later in pairwise(told)) <= 12


def silence(board: RoboclawBench) -> None:
    """Cut its line when it has obeyed all, and just said its time-out."""
    board.until(COUNTERS)
    board.model.driver_line_cut = 1


OTHERWISE: Final[dict[str, tuple[int, Callable[[RoboclawBench], None]]]] = {
    "it is silent": (160, silence),
    "it has no power": (160, lambda board: setattr(board.model, "driver_volts", 0.0)),
    "all is held up": (160, lambda board: setattr(board.model, "driver_line_held", 1)),
    "it keeps another time-out": (150, lambda board: board.spoil(KEEPS_OTHER_TIMEOUT, times=1, value=0)),
    "it does not say its time-out": (210, lambda board: board.spoil(LOSES_REPLIES, GET_TIMEOUT)),
    "it answers, but to no command": (190, lambda board: board.spoil(LOSES_REPLIES, COMMAND)),
    "its counters begin anew": (20, lambda board: board.spoil(COUNTS_ANEW, times=1)),
}


@pytest.mark.parametrize("what", OTHERWISE)
def test_a_controller_that_is_not_as_it_was_resets_the_board(board: RoboclawBench, what: str) -> None:
    within_ms, happens = OTHERWISE[what]
    board.begin(40, 40)
    board.until(GET_TIMEOUT)
    ticks = {(each.left_ticks, each.right_ticks) for each in board.all(WheelsFrame)}
    happens(board)
    after_ms = board.reset_after_ms(within_ms)
    assert ticks >= {(each.left_ticks, each.right_ticks) for each in board.all(WheelsFrame)}, "of what it was"
    board.run(max(OFF_MS, TIMEOUT_MS - after_ms) + 2)
    assert board.duties() == (0, 0)
    board.spoil(0)
    board.model.driver_line_cut = board.model.driver_line_held = 0
    board.model.driver_volts = 24.0
    assert board.cause() == ResetCause.EXTERNAL
    board.asked.clear()
    board.keep_driving(40, 40, 100)
    assert [each for each in board.asked if each.drives] == [], "it waits for its host"


@pytest.mark.parametrize("right", [0, 40])
def test_a_stop_whose_reply_is_lost_is_repeated_and_nothing_drives_before(board: RoboclawBench, right: int) -> None:
    board.begin(40, 40)
    board.send(board.drive_frame(0, right))
    while (asked := board.until(COMMAND)).left:
        pass
    board.spoil(LOSES_REPLIES, COMMAND, times=3)
    first, board.asked[:] = board.until(COMMAND), []
    assert not first.left
    board.run(3 * (REPLY_MS + QUIET_MS + 2))
    board.send(board.drive_frame(0, right))
    assert [each[1:] for each in board.asked][:3] == [STOP] * 3, (asked, board.asked)
    assert board.asked[0].at_ms - first.at_ms >= REPLY_MS + QUIET_MS - 1, "in whole ms"


def test_after_a_lost_reply_nothing_drives_before_an_answer(board: RoboclawBench) -> None:
    board.begin(40, 40)
    board.spoil(LOSES_REPLIES, times=4)
    asked = board.until(COMMAND)
    board.asked.clear()
    board.keep_driving(40, 40, 4 * (REPLY_MS + QUIET_MS + 2))
    assert [each.command for each in board.asked[:4]] == [COUNTERS] * 4, asked
    assert not board.asked[4].drives, "it has answered nothing yet"
    assert any(each.drives for each in board.asked[4:])


def test_a_late_acknowledgement_is_none_of_the_next_request(board: RoboclawBench) -> None:
    """It says nothing that names what it acknowledges."""
    board.begin(40, 40)
    asked = board.until(COMMAND)
    board.model.driver_line_held = 1
    board.run(REPLY_MS + QUIET_MS - 5)
    board.model.driver_line_held = 0
    come = board.now_ms
    assert board.until(COUNTERS).at_ms >= come + QUIET_MS
    assert [each for each in board.asked if asked.at_ms < each.at_ms < come + QUIET_MS] == []
    assert board.until(COMMAND).drives


def test_a_reply_with_any_one_bit_changed_is_none(board: RoboclawBench) -> None:
    board.begin(40, 40)
    for bit in range(8 * 10):
        board.spoil(DAMAGES_REPLIES, COUNTERS, times=1, value=1 << bit % 8, place=bit // 8)
        board.keep_driving(40, 40, 50)
    assert board.model.resets == 0
    assert {(each.left_ticks, each.right_ticks) for each in board.all(WheelsFrame)} == {(0, 0)}


def test_a_controller_whose_power_fails_for_a_millisecond_obeys_one_command_at_most(board: RoboclawBench) -> None:
    """It has no time-out then."""
    for phase_ms in range(16):
        board.begin(70, 70)
        board.until(COUNTERS)
        board.keep_driving(70, 70, phase_ms)
        board.model.driver_volts = 0.0
        board.run(1)
        board.model.driver_volts = 24.0
        before, driven_ms = board.model.resets, 0
        for millisecond in range(PROVED_MS):
            board.keep_driving(70, 70, 1)
            driven_ms += board.duties() != (0, 0)
            assert board.model.resets > before or millisecond < REPLY_MS + QUIET_MS + LINE_MS
        assert driven_ms <= 12
        board.run(PROVED_MS)


def test_what_an_adapter_has_held_up_ends_in_a_stop(board: RoboclawBench) -> None:
    """A command that was on its way drives for as long as its ramp is ahead of the stop behind it."""
    driven = []
    for phase_ms in range(14):
        board.begin(70, 70)
        board.until(COUNTERS)
        board.keep_driving(70, 70, phase_ms)
        board.model.driver_line_held = 1
        board.keep_driving(70, 70, 1000)
        board.model.driver_line_held = 0
        board.model.motor[0].drive_peak = board.model.motor[1].drive_peak = 0
        driven.append(0)
        for _ in range(60):
            board.run(1)
            driven[-1] += board.duties() != (0, 0)
        assert max(motor.drive_peak for motor in board.model.motor) <= 15
        board.run(PROVED_MS)
    assert 0 < max(driven) <= 6, driven


def test_its_emergency_input_latches_the_board(board: RoboclawBench) -> None:
    board.begin(40, 40)
    board.model.cord_pulled = 1
    board.keep_driving(40, 40, 5)
    assert board.duties() == (0, 0), "by itself"
    board.keep_driving(40, 40, 190)
    assert (board.wheels().drive_state, board.wheels().latch) == (DriveState.LATCHED, Latch.ESTOP)
    board.model.cord_pulled = 0
    board.until(STATUS)
    board.asked.clear()
    board.keep_driving(40, 40, 100)
    assert [each for each in board.asked if each.drives] == []


def test_a_blocked_wheel_latches_the_board_and_gets_no_more_than_was_asked(board: RoboclawBench) -> None:
    board.run(PROVED_MS)
    board.configure(stall_level=12)
    board.drive(0, 0)
    board.drive(70, 70, STUCK_MS - 20)
    assert board.duties() == pytest.approx((70, 70), abs=0.01)
    board.drive(70, 70, 60)
    assert (board.duties(), board.wheels().latch) == ((0, 0), Latch.LEFT_STUCK)
    assert max(motor.drive_peak for motor in board.model.motor) == 70


@pytest.mark.parametrize("phase_ms", range(0, 130, 10))
def test_a_tenth_of_a_second_without_computer_is_no_reset(board: RoboclawBench, phase_ms: int) -> None:
    board.begin(40, 40)
    board.until(GET_TIMEOUT)
    board.keep_driving(40, 40, phase_ms)
    board.model.process_stalls = IS_SUSPENDED
    board.run(100)
    board.model.process_stalls = RUNS
    board.keep_driving(40, 40, 100)
    assert board.model.resets == 0
    assert board.duties() == pytest.approx((40, 40), abs=0.01)


@pytest.mark.parametrize("phase_ms", range(0, 35, 7))
def test_a_short_press_of_its_emergency_input_latches(board: RoboclawBench, phase_ms: int) -> None:
    board.begin(40, 40)
    board.keep_driving(40, 40, phase_ms)
    board.model.cord_pulled = 1
    board.keep_driving(40, 40, SHORT_PRESS_MS)
    assert board.duties() == (0, 0)
    board.model.cord_pulled = 0
    board.keep_driving(40, 40, 100)
    assert (board.wheels().latch, board.duties()) == (Latch.ESTOP, (0, 0))


def test_what_waited_while_the_process_was_suspended_is_too_old(board: RoboclawBench) -> None:
    """Its clock goes first: a frame that came 0.17 s ago is stale, though it is read at once."""
    board.begin(40, 40)
    board.until(GET_TIMEOUT)
    board.model.process_stalls = IS_SUSPENDED
    board.send(board.drive_frame(70, 70))
    board.run(170)
    board.asked.clear()
    board.model.process_stalls = RUNS
    board.run(LINE_MS)
    assert board.wheels().last_refusal == Refusal.STALE
    assert {each.left for each in board.asked if each.command == COMMAND} == {int(40 * FULL / 255)}


@pytest.mark.parametrize("stalls", [IS_SUSPENDED, HANGS])
def test_a_process_that_did_not_run_drives_nothing_on_waking(board: RoboclawBench, stalls: int) -> None:
    board.begin(40, 40)
    board.model.process_stalls = stalls
    board.run(TIMEOUT_MS + 2)
    assert board.duties() == (0, 0), "by the controller's own time-out"
    board.asked.clear()
    for _ in range(140):
        board.send(board.drive_frame(40, 40))
        board.run(20)
    board.model.process_stalls = RUNS
    assert board.cause() == ResetCause.WATCHDOG
    assert [each for each in board.asked if each.drives] == []
    board.keep_driving(40, 40, 100)
    assert [each for each in board.asked if each.drives] == [], "it waits for its host"


@pytest.mark.parametrize("fault", [REPLIES_NOISE, HEARS_NOISE])
def test_noise_on_the_controllers_line_drives_nothing_that_is_not_asked(board: RoboclawBench, fault: int) -> None:
    board.begin(40, 40)
    for millisecond in range(3000):
        board.spoil(fault if millisecond % 300 < 100 else 0, times=millisecond % 3, value=128)
        board.keep_driving(40, 40, 1)
        if board.model.resets:
            board.model.resets = 0
            board.spoil(0)
            board.begin()
            board.drive(40, 40, 40)
    assert max(motor.drive_peak for motor in board.model.motor) <= 40

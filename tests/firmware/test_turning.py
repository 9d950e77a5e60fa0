"""A wheel that does not turn as its motor is told: PWM 0, and a latch that says which wheel and how."""

from collections.abc import Callable

import pytest

from giraff_schemas.boards import BASE_BOARD
from giraff_schemas.framing import encode
from giraff_schemas.wire import (
    OPPOSITE_MS,
    STUCK_EDGES,
    STUCK_MS,
    DriveState,
    Latch,
    Refusal,
    ResetCause,
    Wiring,
)
from tests.firmware.bench import BaseBench
from tests.firmware.builds import open_board, with_fault

STALL = 25
STATES_PER_TICK = 2
TELEMETRY_MS = 15
SLICE_MS = 25  # of turning.c: how fine it looks at speeds
TICKS_PER_M = 2002.0

Speeds = Callable[[int], float]
"""Ticks per second at a millisecond from now, forward positive."""


def turning(base: BaseBench, *shafts: Speeds) -> None:
    """Let the shafts turn from now on, whatever the motors get."""
    began, at = base.now_ms, [motor.position for motor in base.model.motor]

    def move() -> None:
        for number, speed in enumerate(shafts):
            at[number] += speed(base.now_ms - began) * STATES_PER_TICK / 1000
            base.model.motor[number].position = at[number]

    base.before_each_ms = move


def still(_ms: int) -> float:
    return 0.0


def steady(speed: float) -> Speeds:
    return lambda _ms: speed


def ready(base: BaseBench, wiring: int = 0, level_max: int = 70) -> None:
    base.configure(stall_level=STALL, wiring=wiring, level_max=level_max)
    base.drive(0, 0)


def driven_ms(base: BaseBench, left: int, right: int, longest: int = 1500) -> int:
    """For how many milliseconds the motors got something, when asked for these levels for `longest` at most."""
    driven = idle = 0
    for millisecond in range(longest):
        if millisecond % 20 == 0:
            base.send(base.drive_frame(left, right))
        base.run(1)
        idle = idle + 1 if base.duties() == (0, 0) else 0
        driven += not idle
        if driven and idle > 1:  # a reversal has one such millisecond
            break
    base.run(TELEMETRY_MS)
    return driven


def latched(base: BaseBench) -> Latch:
    assert (base.wheels().drive_state == DriveState.LATCHED) == (base.wheels().latch != Latch.NONE)
    return Latch(base.wheels().latch)


@pytest.mark.parametrize("level", [STALL, -STALL, 70, -70])
@pytest.mark.parametrize("wheel", ["left", "right"])
def test_a_wheel_that_stands_still_at_the_stall_level_stops_both_after_half_a_second(
    base: BaseBench, wheel: str, level: int
) -> None:
    ready(base)
    runs = steady(300.0 if level > 0 else -300.0)
    turning(base, *((still, runs) if wheel == "left" else (runs, still)))
    assert driven_ms(base, level, level) == pytest.approx(STUCK_MS, abs=2)
    assert latched(base) is Latch[f"{wheel.upper()}_STUCK"]
    base.drive(0, 0)
    base.drive(level, level, 100)
    assert base.wheels().last_refusal == Refusal.LATCHED
    assert base.duties() == (0, 0)


def test_below_the_stall_level_a_wheel_may_stand_still(base: BaseBench) -> None:
    ready(base)
    assert driven_ms(base, STALL - 1, 1 - STALL, 3000) > 2990
    assert latched(base) is Latch.NONE


@pytest.mark.parametrize(("ticks", "cause"), [(STUCK_EDGES + 1, Latch.NONE), (STUCK_EDGES - 1, Latch.LEFT_STUCK)])
def test_ten_ticks_in_half_a_second_are_turning(base: BaseBench, ticks: int, cause: Latch) -> None:
    ready(base)
    turning(base, steady(ticks * 1000 / STUCK_MS), steady(300.0))
    driven_ms(base, STALL, STALL, 3000)
    assert latched(base) is cause


@pytest.mark.parametrize("stops_at_ms", [480, 503, 517, 990, 1234])
def test_a_wheel_that_stops_is_found_within_half_a_second_of_its_stop(base: BaseBench, stops_at_ms: int) -> None:
    ready(base)
    turning(base, lambda ms: 300.0 if ms < stops_at_ms else 0.0, steady(300.0))
    began = base.now_ms
    driven_ms(base, 40, 40, 3000)
    stopped_ms = base.now_ms - TELEMETRY_MS - began
    assert STUCK_MS - 40 <= stopped_ms - stops_at_ms <= STUCK_MS + 3
    assert latched(base) is Latch.LEFT_STUCK


def test_a_cut_encoder_is_a_stuck_wheel(base: BaseBench) -> None:
    ready(base)
    turning(base, steady(300.0), steady(300.0))
    base.drive(40, 40, 400)
    base.model.motor[1].encoder_cut = 1
    assert driven_ms(base, 40, 40) <= STUCK_MS + 3
    assert latched(base) is Latch.RIGHT_STUCK


def test_a_wheel_that_trembles_on_an_edge_is_stuck(base: BaseBench) -> None:
    ready(base)
    turning(base, lambda ms: 3000.0 if ms % 2 else -3000.0, steady(300.0))
    assert driven_ms(base, 40, 40) == pytest.approx(STUCK_MS, abs=2)
    assert latched(base) is Latch.LEFT_STUCK


def test_a_level_that_swings_about_the_stall_level_hides_nothing(base: BaseBench) -> None:
    ready(base)
    turning(base, still, steady(300.0))
    for _ in range(13):
        base.drive(STALL, 40, 20)
        base.drive(STALL - 1, 40, 20)
    assert latched(base) is Latch.NONE
    for _ in range(13):
        base.drive(STALL, 40, 20)
        base.drive(STALL - 1, 40, 20)
    base.run(TELEMETRY_MS)
    assert latched(base) is Latch.LEFT_STUCK


def test_each_new_push_has_its_half_second(base: BaseBench) -> None:
    """Short pushes, to and fro or with pauses, are no stuck wheel: a heavy robot takes its time."""
    ready(base)
    for _ in range(5):
        base.drive(40, 40, 400)
        base.drive(0, 0, 40)
        base.drive(40, 40, 400)
        base.drive(-40, -40, 400)
    base.run(TELEMETRY_MS)
    assert latched(base) is Latch.NONE


def test_a_push_the_other_way_counts_from_where_the_wheel_stands_then(base: BaseBench) -> None:
    """Nine ticks of the push before and one more are not ten of this one."""

    def nine_and_one(ms: int) -> float:
        return 100.0 if ms < 95 else 1000.0 if ms == 600 else 0.0

    ready(base)
    turning(base, nine_and_one, nine_and_one)
    base.drive(40, 40, 200)
    assert driven_ms(base, -40, -40) <= STUCK_MS + 20
    assert latched(base) in (Latch.LEFT_STUCK, Latch.RIGHT_STUCK)


def test_what_a_push_has_used_up_ends_with_its_session(base: BaseBench) -> None:
    ready(base)
    base.drive(40, 40, 480)
    base.send_bytes(
        b"".join(
            encode(frame.pack())
            for frame in (
                base.configure_frame(session=9, stall_level=STALL),
                base.drive_frame(0, 0),
                base.drive_frame(40, 40),
            )
        )
    )
    base.run(20)
    base.drive(40, 40, 300)
    assert latched(base) is Latch.NONE
    assert base.wheels().session == 9


@pytest.mark.parametrize("level", [12, -12, 24, 70, -70])
@pytest.mark.parametrize("wheel", ["left", "right"])
def test_a_wheel_that_turns_against_its_level_stops_both(base: BaseBench, wheel: str, level: int) -> None:
    ready(base)
    speed = level / 70 * 0.6 * TICKS_PER_M

    def wrong(ms: int) -> float:
        return -speed * min(1.0, ms / 100)  # a tenth of a second to get going

    turning(base, *((wrong, steady(speed)) if wheel == "left" else (steady(speed), wrong)))
    assert OPPOSITE_MS <= driven_ms(base, level, level) <= OPPOSITE_MS + 2 * SLICE_MS + 3
    assert latched(base) is Latch[f"{wheel.upper()}_OPPOSITE"]


def test_a_wheel_that_turns_round_while_it_drives_is_found_as_fast(base: BaseBench) -> None:
    ready(base)
    turning(base, lambda ms: 300.0 if ms < 777 else -300.0, steady(300.0))
    began = base.now_ms
    driven_ms(base, 20, 20, 3000)
    assert OPPOSITE_MS <= base.now_ms - TELEMETRY_MS - began - 777 <= OPPOSITE_MS + SLICE_MS + 3
    assert latched(base) is Latch.LEFT_OPPOSITE


def coasting(speed: float, deceleration: float) -> Speeds:
    """From a speed (m/s) by a deceleration (m/s²) to a stop."""
    return lambda ms: max(0.0, speed - deceleration * ms / 1000) * TICKS_PER_M


@pytest.mark.parametrize("level", [-1, -12, -70])
@pytest.mark.parametrize("deceleration", [0.25, 0.6, 3.0])
def test_a_wheel_that_still_coasts_when_its_level_reverses_is_not_opposite(
    base: BaseBench, deceleration: float, level: int
) -> None:
    ready(base)
    turning(base, steady(0.6 * TICKS_PER_M), steady(0.6 * TICKS_PER_M))
    base.drive(70, 70, 200)
    turning(base, coasting(0.6, deceleration), coasting(0.6, deceleration))
    coasts_ms = round(600 / deceleration)
    assert driven_ms(base, level, level, coasts_ms + 100) > coasts_ms
    assert latched(base) is Latch.NONE


def test_but_one_that_does_not_slow_down_is(base: BaseBench) -> None:
    """A PHASE line that is stuck: the motor goes on as it went."""
    ready(base)
    turning(base, steady(800.0), steady(800.0))
    base.drive(50, 50, 200)
    assert driven_ms(base, -50, -50) <= OPPOSITE_MS + 2 * SLICE_MS + 40
    assert latched(base) is Latch.LEFT_OPPOSITE


def test_one_that_has_stood_has_nothing_to_coast_with(base: BaseBench) -> None:
    """Slowing down later is no excuse for a wheel that has turned the wrong way from its start."""
    ready(base)
    turning(base, lambda ms: -max(0.0, 400.0 - abs(ms - 125) * 3.0) if ms > 25 else 0.0, steady(300.0))
    assert driven_ms(base, 20, 20) <= OPPOSITE_MS + 3 * SLICE_MS
    assert latched(base) is Latch.LEFT_OPPOSITE


def test_a_robot_that_is_pushed_while_it_stands_or_is_told_nothing_is_not_opposite(base: BaseBench) -> None:
    ready(base)
    turning(base, steady(-400.0), steady(-400.0))
    base.drive(0, 0, 1000)
    assert latched(base) is Latch.NONE
    turning(base, coasting(-0.2, -0.6), coasting(-0.2, -0.6))
    base.drive(20, 20, 500)
    assert latched(base) is Latch.NONE


@pytest.mark.parametrize(
    ("wiring", "motor", "encoder", "signs"),
    [
        (Wiring.SWAP_MOTORS, 1, 0, (1, 1)),
        (Wiring.SWAP_ENCODERS, 0, 1, (1, 1)),
        (Wiring.SWAP_MOTORS | Wiring.SWAP_ENCODERS, 1, 1, (1, 1)),
        (Wiring.INVERT_LEFT_MOTOR, 0, 0, (-1, 1)),
        (Wiring.INVERT_LEFT_ENCODER, 0, 0, (1, -1)),
        (Wiring.SWAP_MOTORS | Wiring.INVERT_LEFT_MOTOR | Wiring.INVERT_LEFT_ENCODER, 1, 0, (-1, -1)),
    ],
)
@pytest.mark.parametrize("fault", ["stuck", "opposite"])
def test_a_latch_names_the_wheel_the_wiring_says(
    base: BaseBench, wiring: int, motor: int, encoder: int, signs: tuple[int, int], fault: str
) -> None:
    """The left wheel is at fault, wherever its motor and encoder are soldered."""
    ready(base, wiring)
    shafts = [steady(600.0), steady(600.0)]
    shafts[encoder] = still if fault == "stuck" else steady(-600.0 * signs[1])
    turning(base, *shafts)
    base.send(base.drive_frame(40, 40))
    base.run(5)
    assert base.duties()[motor] == 40 * signs[0]
    driven_ms(base, 40, 40)
    assert latched(base) is Latch[f"LEFT_{fault.upper()}"]


def test_both_wheels_of_swapped_encoders_are_opposite_when_the_robot_turns_on_the_spot(base: BaseBench) -> None:
    ready(base, Wiring.SWAP_ENCODERS)
    turning(base, steady(-300.0), steady(300.0))
    assert driven_ms(base, -20, 20) <= OPPOSITE_MS + SLICE_MS + 3
    assert latched(base) is Latch.LEFT_OPPOSITE


def test_a_fault_is_found_without_the_main_loop_and_kept() -> None:
    stops_all, loop_hangs_unwatched = 1.0, 4.0  # the voltages of faults/hung_loop.c
    board = open_board(BASE_BOARD, with_fault("hung_loop", "firmware_poll", "firmware_on_millisecond"))
    board.model.battery_volts = stops_all
    base = BaseBench(board)
    ready(base)
    turning(base, steady(-300.0), steady(-300.0))
    base.send(base.drive_frame(20, 20))
    base.run(5)
    board.model.battery_volts = loop_hangs_unwatched
    base.run(OPPOSITE_MS + SLICE_MS)
    assert base.duties() == (0, 0)
    board.model.battery_volts = stops_all
    board.reset(ResetCause.WATCHDOG)
    base.run(TELEMETRY_MS)
    assert base.wheels().boot_id == 2
    assert latched(base) is Latch.LEFT_OPPOSITE
    board.close()


def test_a_busy_line_does_not_put_it_off(base: BaseBench) -> None:
    ready(base)
    turning(base, still, steady(300.0))
    base.send(base.drive_frame(40, 40))
    base.run(3)
    assert base.duties() == (40, 40)

    def babble() -> None:
        if base.now_ms % 100 == 0:
            base.send(base.drive_frame(40, 40))
        base.send_bytes(bytes(range(1, 9)) + b"\0")

    assert base.stopped_after_ms(babble) == pytest.approx(STUCK_MS, abs=2)


def test_the_first_cause_stays_until_the_release(base: BaseBench) -> None:
    ready(base)
    turning(base, still, still)
    driven_ms(base, 40, 40)
    base.send(base.estop_frame())
    base.run(TELEMETRY_MS)
    assert latched(base) is Latch.LEFT_STUCK
    base.send(base.estop_frame(engage=0))
    base.run(TELEMETRY_MS)
    assert latched(base) is Latch.NONE
    turning(base, steady(300.0), steady(300.0))
    base.drive(0, 0)
    assert driven_ms(base, 40, 40) > 1400, "mended, it drives"

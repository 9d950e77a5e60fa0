"""Who may ask the base board for wheel speeds, with what, and for how long."""

import msgspec
import pytest

from giraff_schemas.wire import (
    COMMAND_TIMEOUT_MS,
    DriveState,
    Latch,
    Refusal,
    ResetCause,
    SpeedFrame,
)
from tests.firmware.bench import SpeedBench, out_of_place
from tests.support.robots import BY_SPEED, ROBOT

TELEMETRY_MS = 17  # within which telemetry tells of what has happened
FRAME_MS = 3  # within which a speed frame has come over the line and acted
CONTROL = BY_SPEED.speed_control
MAX_UM_S = round(ROBOT.max_wheel_speed * 1e6)
LOWEST = -0x80000000


def given(robot: SpeedBench) -> bool:
    """Whether a motor gets anything."""
    return robot.duties() != (0, 0)


def test_a_fresh_board_goes_only_after_a_handshake_and_a_zero(robot: SpeedBench) -> None:
    robot.go(0.0, 0.0)
    robot.go(0.3, 0.3, 60)
    assert robot.wheels().last_refusal == Refusal.NOT_CONFIGURED
    robot.configure()
    robot.go(0.3, 0.3, 60)
    assert (robot.wheels().drive_state, robot.wheels().last_refusal) == (
        DriveState.AWAITING_ZERO,
        Refusal.AWAITING_ZERO,
    )
    assert robot.model.motor[0].drive_peak == robot.model.motor[1].drive_peak == 0
    robot.go(0.0, 0.0)
    assert robot.wheels().drive_state == DriveState.ACTIVE
    robot.go(0.3, -0.2, 1500)
    assert robot.speed == [pytest.approx(0.3, rel=0.03), pytest.approx(-0.2, rel=0.03)]
    assert robot.wheels().left_um_s == pytest.approx(300_000, rel=0.03)
    assert robot.wheels().right_um_s == pytest.approx(-200_000, rel=0.03)


@pytest.mark.parametrize(
    "changes",
    [
        {"level_max": 70},
        {"speed_max_um_s": 0},
        {"left_counts_per_km": 0},
        {"right_counts_per_km": 0},
        {"left_counts_per_km": 1},
        {"right_counts_per_km": 59},
        {"acceleration_um_s2": 0},
        {"acceleration_um_s2": 99},
        {"acceleration_um_s2": 0x80000000},
        {"nominal_um_s": 0},
        {"nominal_um_s": 1},
        {"nominal_um_s": 0xFFFFFFFF},
        {"nominal_level": 0},
        {"nominal_adc_counts": 1024},
        {"motor_ms": 2001},
        {"pwm_max": 0, "stall_pwm": 0, "dead_pwm": 0},
        {"stall_pwm": 0, "dead_pwm": 0},
        {"pwm_max": CONTROL.stall_pwm - 1},
        {"dead_pwm": CONTROL.stall_pwm + 1},
        {"speed_p": 3907},
        {"turn_p": 3907},
        {"speed_max_um_s": 10_000_000},
        {"speed_max_um_s": 10_000_001, "nominal_um_s": 20_000_000},
        {"speed_max_um_s": 0x80000000, "nominal_um_s": 0x7FFFFFFF},
    ],
    ids=str,
)
def test_settings_that_no_robot_can_have_are_refused(robot: SpeedBench, changes: dict[str, int]) -> None:
    robot.configure(**changes)
    assert (robot.wheels().last_refusal, robot.wheels().refused) == (Refusal.PROTOCOL, 1)
    robot.go(0.0, 0.0)
    robot.go(0.3, 0.3, 100)
    assert (robot.wheels().drive_state, robot.wheels().session) == (DriveState.NOT_CONFIGURED, 0)
    assert robot.model.motor[0].drive_peak == 0


@pytest.mark.parametrize(
    "changes",
    [
        {"stall_pwm": CONTROL.max_pwm},
        {"dead_pwm": CONTROL.stall_pwm},
        {"pwm_max": 255},
        {"nominal_adc_counts": 0},
        {"nominal_adc_counts": 1023},
        {"speed_p": 3906, "turn_p": 3906, "speed_i": 65535, "turn_i": 65535},
        {"left_counts_per_km": 60},
        {"motor_ms": 2000},
        {"motor_ms": 0},
        {"acceleration_um_s2": 100},
        {"acceleration_um_s2": 0x7FFFFFFF, "motor_ms": 2000},
        {"speed_max_um_s": 10_000_000, "nominal_um_s": 10_000_000},
    ],
    ids=str,
)
def test_settings_up_to_their_limits_are_taken(robot: SpeedBench, changes: dict[str, int]) -> None:
    robot.configure(**changes)
    assert (robot.wheels().session, robot.wheels().refused) == (7, 0)


def refusals(robot: SpeedBench) -> list[tuple[str, SpeedFrame, Refusal]]:
    """Each way in which the next speed frame can be wrong, when nothing else is."""
    arrival = robot.now_ms + 1  # by the board's time
    good = robot.speed_frame(0.4, 0.4, board_ms=arrival)
    return [
        *out_of_place(good, arrival),
        ("left too fast", msgspec.structs.replace(good, left_um_s=MAX_UM_S + 1), Refusal.LEVEL),
        ("right too fast", msgspec.structs.replace(good, right_um_s=-MAX_UM_S - 1), Refusal.LEVEL),
        ("the lowest number there is", msgspec.structs.replace(good, left_um_s=LOWEST), Refusal.LEVEL),
        ("and to the right", msgspec.structs.replace(good, right_um_s=LOWEST), Refusal.LEVEL),
    ]


@pytest.mark.parametrize("case", range(12))
def test_a_speed_frame_with_one_thing_wrong_is_refused(robot: SpeedBench, case: int) -> None:
    robot.begin(0.2, 0.2)
    before = robot.wheels()
    name, frame, refusal = refusals(robot)[case]
    robot.send(frame)
    robot.run(2 * TELEMETRY_MS)
    assert (name, robot.wheels().last_refusal) == (name, refusal)
    assert (robot.wheels().accepted, robot.wheels().refused) == (before.accepted, before.refused + 1)
    robot.go(0.2, 0.2)
    robot.go(0.3, 0.3, 700)
    assert robot.speed[0] == pytest.approx(0.3, rel=0.03), "the next good one is as good as ever"


@pytest.mark.parametrize("sign", [1, -1])
def test_speeds_up_to_the_sessions_maximum_are_accepted(robot: SpeedBench, sign: int) -> None:
    robot.begin(0.6 * sign, -0.6 * sign, 60)
    assert robot.wheels().refused == 0
    assert robot.wheels().drive_state == DriveState.ACTIVE


def test_levels_are_refused_where_speeds_are_asked_for(robot: SpeedBench) -> None:
    robot.begin(0.3, 0.3)
    for levels in ((1, 0), (0, -1), (70, 70)):
        robot.send(robot.drive_frame(*levels))
        robot.run(2 * TELEMETRY_MS)
        assert robot.wheels().last_refusal == Refusal.LEVEL
        robot.go(0.3, 0.3, 40)
    assert robot.wheels().refused == 3
    assert given(robot)
    robot.send(robot.drive_frame(0, 0))
    assert robot.stopped_after_ms() <= FRAME_MS + 1, "a zero of either stops"
    robot.run(TELEMETRY_MS)
    assert (robot.wheels().refused, robot.wheels().drive_state) == (3, DriveState.ACTIVE)


def test_speeds_are_refused_where_levels_are_asked_for(robot: SpeedBench) -> None:
    robot.configure(level_max=70, speed_max_um_s=0)
    robot.drive(0, 0)
    robot.drive(40, 40, 400)
    for speeds in ((1e-6, 0.0), (0.0, -1e-6), (0.5, 0.5)):
        robot.send(robot.speed_frame(*speeds))
        robot.run(2 * TELEMETRY_MS)
        assert robot.wheels().last_refusal == Refusal.LEVEL
        robot.drive(40, 40, 40)
    assert robot.duties() == (40, 40)
    robot.send(robot.speed_frame(0.0, 0.0))
    assert robot.stopped_after_ms() <= FRAME_MS + 1
    robot.run(TELEMETRY_MS)
    assert (robot.wheels().refused, robot.wheels().drive_state) == (3, DriveState.ACTIVE)


def test_without_accepted_frames_pwm_is_zero_after_300_ms_and_latched(robot: SpeedBench) -> None:
    robot.begin(0.3, 0.3)
    robot.send(robot.speed_frame(0.3, 0.3))
    robot.run(FRAME_MS - 1)
    assert robot.stopped_after_ms() == pytest.approx(COMMAND_TIMEOUT_MS, abs=2)
    robot.run(TELEMETRY_MS)
    assert robot.wheels().drive_state == DriveState.COMMAND_TIMEOUT
    robot.model.motor[0].drive_peak = 0
    robot.go(0.3, 0.3, 400)
    assert (robot.wheels().last_refusal, robot.model.motor[0].drive_peak) == (Refusal.AWAITING_ZERO, 0)
    robot.go(0.0, 0.0)
    robot.go(0.3, 0.3, 200)
    assert given(robot)


def test_an_estop_takes_the_time_of_its_frame_and_is_released_as_ever(robot: SpeedBench) -> None:
    robot.begin(0.5, 0.5)
    robot.send(robot.estop_frame())
    assert robot.stopped_after_ms() <= FRAME_MS
    robot.model.motor[0].drive_peak = 0
    robot.go(0.0, 0.0)
    robot.go(0.5, 0.5, 200)
    assert (robot.wheels().drive_state, robot.wheels().latch) == (DriveState.LATCHED, Latch.ESTOP)
    robot.send(robot.estop_frame(engage=0))
    robot.run(TELEMETRY_MS)
    robot.go(0.5, 0.5, 200)
    assert (robot.wheels().drive_state, robot.model.motor[0].drive_peak) == (DriveState.AWAITING_ZERO, 0)
    robot.go(0.0, 0.0)
    robot.go(0.5, 0.5, 200)
    assert given(robot)


def test_a_reset_forgets_the_session(robot: SpeedBench) -> None:
    robot.begin(0.3, 0.3)
    robot.board.reset(ResetCause.WATCHDOG)
    robot.run(1)
    assert not given(robot)
    robot.model.motor[0].drive_peak = 0
    robot.run(TELEMETRY_MS)
    robot.go(0.0, 0.0)
    robot.go(0.3, 0.3, 60)
    assert (robot.wheels().last_refusal, robot.model.motor[0].drive_peak) == (Refusal.NOT_CONFIGURED, 0)

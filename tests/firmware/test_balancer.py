"""The balancing robot's board: who may ask what of it, its motor driver's line, its encoders, its control loop."""

import math
from collections.abc import Iterator

import msgspec
import pytest

from giraff_schemas.boards import BALANCER_BOARD
from giraff_schemas.wire import COMMAND_TIMEOUT_MS, DriveState, HelloFrame, Refusal, ResetCause, Wiring
from giraff_schemas.wires.balancer import (
    DRIVER_FULL,
    DRIVER_TIMEOUT_MS,
    FREE_SIDE_MS,
    BalanceAsk,
    BalanceCause,
    BalanceDriveFrame,
    BalanceEngage,
    BalanceFlag,
    BalanceFrame,
    BalanceLatch,
    BalancePosture,
    BalanceSide,
)
from giraff_sim.board import Implementation, open_board
from tests.firmware.balancing import BalancerBench
from tests.firmware.bench import out_of_place
from tests.firmware.builds import compiled, with_fault
from tests.support.report import report

PERIOD_MS = 5
LINE_MS = 3  # of the packets to the motor driver
TELEMETRY_MS = 15  # within which telemetry tells of what has happened
WATCHDOG_MS = 250
HANGS_AT = 19.4  # V of the battery, by faults/hung_loop.c: 2.5 V at the pin
FRAME_MS = 1  # within which a drive frame has come over the line


@pytest.fixture
def board(implementation: Implementation) -> Iterator[BalancerBench]:
    """A board that was powered on 20 ms ago."""
    compiled()
    bench = BalancerBench(open_board(BALANCER_BOARD, implementation))
    yield bench
    bench.board.close()


@pytest.fixture
def quick() -> Iterator[BalancerBench]:
    """The same, for rules that do not depend on the processor."""
    bench = BalancerBench(open_board(BALANCER_BOARD, Implementation.HOST, compiled()))
    yield bench
    bench.board.close()


def test_it_stands_only_for_a_host_that_knows_that_it_is_off(board: BalancerBench) -> None:
    """A host that asked before it went off may not know where the robot is now."""
    stand = {"ask": BalanceAsk.STAND}
    board.drive(milliseconds=100, **stand)
    assert board.report().last_refusal == Refusal.NOT_CONFIGURED
    board.configure()
    board.drive(milliseconds=1600, **stand)
    assert board.report().flags & BalanceFlag.UPRIGHT
    assert (board.report().posture, board.report().drive_state) == (BalancePosture.OFF, DriveState.ACTIVE)
    assert [motor.drive_peak for motor in board.model.motor] == [0, 0]
    board.drive()
    board.drive(milliseconds=40, **stand)
    assert board.report().posture == BalancePosture.STANDS
    board.drive()
    told = board.report().board_ms
    board.estop(BalanceEngage.OFF)
    board.estop(BalanceEngage.RELEASE)
    board.drive(board_ms=told)
    accepted = board.report().accepted
    board.drive(milliseconds=1600, **stand)
    assert board.report().accepted > accepted
    assert (board.report().flags, board.report().posture) == (BalanceFlag.UPRIGHT, BalancePosture.OFF)
    board.get_up()


@pytest.mark.parametrize(
    ("changes", "refusal"),
    [
        ({"protocol_hash": 1}, Refusal.PROTOCOL),
        ({"wiring": 64}, Refusal.PROTOCOL),
        ({"k1_mnm_rad": 0}, Refusal.PROTOCOL),
        ({"k3_mnm_m": 0}, Refusal.PROTOCOL),
        ({"radius_um": 0}, Refusal.PROTOCOL),
        ({"counts_per_turn": 0}, Refusal.PROTOCOL),
        ({"motor_mohm": 0}, Refusal.PROTOCOL),
        ({"torque_max_mnm": 0xFFFFFFFF}, Refusal.PROTOCOL),
        ({"battery_uv_count": 0}, Refusal.PROTOCOL),
        ({"battery_min_mv": 9_900}, Refusal.PROTOCOL),
        ({"boot_id": 2}, Refusal.BOOT_ID),
        ({"board_ms": 1000}, Refusal.STALE),
    ],
)
def test_a_session_of_what_no_robot_is_is_refused(
    quick: BalancerBench, changes: dict[str, int], refusal: Refusal
) -> None:
    quick.configure(**changes)
    assert (quick.report().last_refusal, quick.report().refused) == (refusal, 1)
    assert (quick.report().drive_state, quick.report().session) == (DriveState.NOT_CONFIGURED, 0)


@pytest.mark.parametrize(
    "changes",
    [
        {"momentum_gms": 100, "momentum_gm2": 10, "gravity_mnm_rad": 1000, "radius_um": 10_000, "track_um": 50_000},
        {"motor_mv_s": 10, "motor_mohm": 10, "friction_mnm": 0, "acceleration_mm_s2": 10, "braking_mm_s2": 10},
        {"motor_mv_s": 0xFFFF, "motor_mohm": 0xFFFF, "friction_mnm": 0xFFFF, "counts_per_turn": 16},
        {"k1_mnm_rad": 100_000_000, "k2_mnm_s_rad": 100_000_000, "k3_mnm_m": 100_000_000, "k4_mnm_s_m": 100_000_000},
    ],
)
def test_what_it_tells_is_finite_with_whatever_it_takes(quick: BalancerBench, changes: dict[str, int]) -> None:
    """Something that is not a number would stay in the filters for good, through sessions to come."""
    quick.stand()
    quick.configure(session=8, **changes)
    quick.drive(0.1, 200)
    quick.configure(session=9)
    assert quick.report().session == 9
    for told in quick.all(BalanceFrame):
        assert abs(told.lean_urad) < 1_000_000
        assert abs(told.speed_um_s) < 100_000_000
        assert abs(told.torque_mnm) < 100_000_000
    quick.estop(BalanceEngage.OFF)
    quick.estop(BalanceEngage.RELEASE)
    quick.get_up()


def test_a_new_session_lets_it_stand_and_waits_for_zero(board: BalancerBench) -> None:
    """Base restarts beside people."""
    board.stand()
    board.configure(session=8)
    assert (board.report().posture, board.report().session) == (BalancePosture.STANDS, 8)
    assert board.report().drive_state == DriveState.AWAITING_ZERO
    board.configure(session=9, k1_mnm_rad=800_000)
    board.run(300)
    assert (board.report().posture, board.report().refused) == (BalancePosture.STANDS, 0)


def refusals(board: BalancerBench) -> list[tuple[str, BalanceDriveFrame, Refusal]]:
    """Each way in which the next drive frame can be wrong, when nothing else is."""
    arrival = board.now_ms + FRAME_MS - 1
    good = board.drive_frame(board_ms=arrival)
    return [
        *out_of_place(good, arrival),
        ("too fast", msgspec.structs.replace(good, linear_um_s=400_001), Refusal.LEVEL),
        ("too fast backward", msgspec.structs.replace(good, linear_um_s=-(1 << 31)), Refusal.LEVEL),
        ("turns too fast", msgspec.structs.replace(good, angular_urad_s=-800_001), Refusal.LEVEL),
        ("asks for no posture", msgspec.structs.replace(good, ask=3), Refusal.LEVEL),
        ("no side", msgspec.structs.replace(good, free_side=3), Refusal.LEVEL),
    ]


@pytest.mark.parametrize("case", range(13))
def test_a_drive_frame_with_one_thing_wrong_is_refused(quick: BalancerBench, case: int) -> None:
    quick.stand()
    before = quick.report()
    name, frame, refusal = refusals(quick)[case]
    quick.send(frame)
    quick.run(TELEMETRY_MS)
    assert (name, quick.report().last_refusal) == (name, refusal)
    assert (quick.report().accepted, quick.report().refused) == (before.accepted, before.refused + 1)
    quick.drive()
    assert quick.report().accepted == before.accepted + 1, "the next good one is as good as ever"


def test_it_drives_only_while_it_stands_and_after_a_zero(quick: BalancerBench) -> None:
    quick.configure()
    quick.drive(0.1)
    assert quick.report().last_refusal == Refusal.AWAITING_ZERO
    quick.drive()
    quick.drive(0.1)
    assert (quick.report().accepted, quick.report().refused) == (1, 2), "it lies"
    quick.get_up()
    quick.drive(0.1)
    assert (quick.report().drive_state, quick.report().refused) == (DriveState.ACTIVE, 2)
    quick.drive(ask=BalanceAsk.SIT)
    quick.drive(0.1)
    assert quick.report().cause == BalanceCause.ASKED
    assert quick.report().last_refusal == Refusal.AWAITING_ZERO


def test_a_time_out_leaves_it_standing(board: BalancerBench) -> None:
    board.stand()
    board.run(COMMAND_TIMEOUT_MS - 25)
    assert board.report().drive_state == DriveState.ACTIVE
    board.run(25 + TELEMETRY_MS)
    assert (board.report().drive_state, board.report().posture) == (DriveState.COMMAND_TIMEOUT, BalancePosture.STANDS)
    board.drive(0.1)
    assert board.report().last_refusal == Refusal.AWAITING_ZERO
    board.drive()
    assert board.report().drive_state == DriveState.ACTIVE


def test_a_stop_leaves_it_standing_and_off_is_a_word_of_its_own(board: BalancerBench) -> None:
    board.stand()
    for _ in range(5):
        board.estop(BalanceEngage.STANDS)
    assert (board.report().latch, board.report().posture) == (BalanceLatch.STANDS, BalancePosture.STANDS)
    board.drive(ask=BalanceAsk.SIT)
    assert (board.report().drive_state, board.report().last_refusal) == (DriveState.LATCHED, Refusal.LATCHED)
    assert board.report().posture == BalancePosture.STANDS
    board.send(board.estop_frame(3, boot_id=0, session=0, board_ms=0))  # no word that it knows
    board.run(FRAME_MS + 2 * PERIOD_MS + LINE_MS)
    assert board.duties() == (0, 0)
    board.run(TELEMETRY_MS)
    assert (board.report().latch, board.report().posture) == (BalanceLatch.OFF, BalancePosture.OFF)
    assert board.report().cause == BalanceCause.ESTOP_OFF
    board.estop(BalanceEngage.STANDS)
    assert board.report().latch == BalanceLatch.OFF, "it never goes back from off"
    board.estop(BalanceEngage.RELEASE)
    assert (board.report().latch, board.report().drive_state) == (BalanceLatch.NONE, DriveState.AWAITING_ZERO)


@pytest.mark.parametrize("changes", [{"boot_id": 2}, {"session": 8}, {"board_ms": 1}], ids=str)
def test_a_release_of_another_robot_or_time_releases_nothing(quick: BalancerBench, changes: dict[str, int]) -> None:
    quick.configure()
    quick.run(200)
    quick.estop(BalanceEngage.STANDS)
    quick.estop(BalanceEngage.RELEASE, **changes)
    assert quick.report().latch == BalanceLatch.STANDS


def test_a_release_from_before_it_became_off_releases_nothing(quick: BalancerBench) -> None:
    quick.configure()
    quick.estop(BalanceEngage.STANDS)
    release = quick.estop_frame(BalanceEngage.RELEASE)
    quick.estop(BalanceEngage.OFF)
    quick.send(release)
    quick.run(TELEMETRY_MS)
    assert (quick.report().latch, quick.report().last_refusal) == (BalanceLatch.OFF, Refusal.STALE)


@pytest.mark.parametrize(("silent_ms", "sits"), [(100, True), (FREE_SIDE_MS, False)])
def test_a_free_side_counts_for_a_moment_only(quick: BalancerBench, silent_ms: int, *, sits: bool) -> None:
    """What was free may not be any more: a robot that has to come down goes off where it is."""
    quick.stand()
    quick.drive(milliseconds=40, free_side=BalanceSide.FORWARD)
    quick.run(silent_ms)
    quick.forget()
    quick.battery = 9.5
    quick.run(200)
    postures = [each.posture for each in quick.all(BalanceFrame)]
    assert (BalancePosture.SITS_DOWN in postures) == sits
    assert (postures[-1] == BalancePosture.OFF) != sits
    assert quick.report().cause == BalanceCause.BATTERY


@pytest.mark.parametrize("engage", [BalanceEngage.STANDS, BalanceEngage.OFF], ids=str)
def test_a_latch_outlasts_every_reset(board: BalancerBench, engage: BalanceEngage) -> None:
    board.configure()
    board.estop(engage)
    for cause in (ResetCause.WATCHDOG, ResetCause.POWER_ON):
        board.board.reset(cause)
        board.run(40)
        assert (board.report().latch, board.report().drive_state) == (int(engage), DriveState.LATCHED)
    board.configure()
    board.drive(milliseconds=1600)
    board.drive(milliseconds=100, ask=BalanceAsk.STAND)
    assert board.report().posture == BalancePosture.OFF


def test_the_cord_takes_the_power_at_once_and_is_latched_as_off(board: BalancerBench) -> None:
    board.stand()
    board.model.cord_pulled = 1
    board.run(1)
    assert board.model.driver_open
    board.run(TELEMETRY_MS)
    report = board.report()
    assert (report.cause, report.latch, report.flags) == (BalanceCause.CORD, BalanceLatch.OFF, BalanceFlag.CORD)
    board.estop(BalanceEngage.RELEASE)
    assert board.report().latch == BalanceLatch.OFF, "while it is pulled, nothing releases that"
    board.model.cord_pulled = 0
    board.board.reset(ResetCause.POWER_ON)
    board.run(40)
    board.configure()
    assert board.report().latch == BalanceLatch.OFF
    board.estop(BalanceEngage.RELEASE)
    board.get_up()


def test_a_reset_gives_zeros_at_once(board: BalancerBench) -> None:
    """The driver would go on at the last command until its time-out."""
    board.stand()
    board.board.reset(ResetCause.WATCHDOG)
    board.run(20)
    for _ in range(200):
        board.run(1)
        assert board.duties() == (0, 0)
    assert (board.report().posture, board.report().cause) == (BalancePosture.OFF, BalanceCause.NONE)


@pytest.mark.parametrize(
    ("wiring", "lean"),
    [(Wiring(0), 0.02), (Wiring(0), -0.02), (Wiring.SWAP_MOTORS | Wiring.INVERT_LEFT_MOTOR, 0.02)],
)
def test_each_motor_gets_what_is_meant_for_its_wheel(board: BalancerBench, wiring: Wiring, lean: float) -> None:
    board.configure(wiring=int(wiring))
    board.get_up()
    board.lean = lean
    board.run(40)
    board.forget()
    given = [0.0, 0.0]
    for _ in range(50):  # before these wheels, which nobody turns, look like lost encoders
        board.run(1)
        given = [total + duty / 50 for total, duty in zip(given, board.duties(), strict=True)]
    left, right = given if not wiring else (-given[1], given[0])
    told = board.all(BalanceFrame)
    for duty, commands in (left, [each.left_command for each in told]), (right, [each.right_command for each in told]):
        assert duty * lean > 0
        assert duty * DRIVER_FULL / 255 == pytest.approx(sum(commands) / len(commands), abs=1)


def test_a_driver_that_was_off_is_told_its_settings_within_a_second(board: BalancerBench) -> None:
    """Without its time-out a lost line would run the robot into a wall, and at 6 V its battery is dead."""
    board.configure()
    board.model.driver_wakes = 0
    board.drive(milliseconds=1040)
    assert board.model.driver_wakes == 1
    board.get_up()
    board.lean = 0.02
    board.run(40)
    assert 0 not in board.duties()
    board.model.driver_line_cut = 1
    board.run(DRIVER_TIMEOUT_MS + PERIOD_MS + 1)
    assert board.duties() == (0, 0)
    board.model.driver_volts = 9.9
    board.run(1)
    assert board.model.driver_open
    board.model.driver_volts = 10.1
    board.run(1)
    assert not board.model.driver_open


def test_a_loop_that_hangs_ends_by_the_driver_and_then_by_the_watchdog() -> None:
    build = with_fault("hung_loop", "firmware_poll", "firmware_on_millisecond", board="balancer")
    hung = BalancerBench(open_board(BALANCER_BOARD, Implementation.HOST, build))
    hung.stand()
    hung.lean = 0.02
    hung.run(60)
    assert 0 not in hung.duties()
    healthy, hung.battery = hung.battery, HANGS_AT
    hung.run(DRIVER_TIMEOUT_MS + PERIOD_MS)
    assert (hung.duties(), hung.model.resets) == ((0, 0), 0)
    hung.run(WATCHDOG_MS - DRIVER_TIMEOUT_MS)
    assert hung.model.resets == 1
    hung.battery = healthy
    hung.run(40)
    assert (hung.last(HelloFrame).reset_cause, hung.report().posture) == (ResetCause.WATCHDOG, BalancePosture.OFF)
    hung.board.close()


def test_each_count_is_counted_at_20_000_a_second_with_telemetry_running(board: BalancerBench) -> None:
    board.configure(wiring=int(Wiring.SWAP_ENCODERS | Wiring.INVERT_LEFT_ENCODER))
    feel, hertz = board.before_each_ms, 20_000

    def turn() -> None:
        feel()
        swing = math.sin(2 * math.pi * board.now_ms / 300)
        board.model.motor[0].position += hertz / 1000 * swing
        board.model.motor[1].position -= hertz / 1100 * swing + 3.3

    board.before_each_ms = turn
    board.drive(milliseconds=1000)
    board.before_each_ms = feel
    board.drive(milliseconds=1000)
    told = board.report()
    lean = told.lean_urad / 1e6 * 5120 / (2 * math.pi)
    right, left = (motor.states for motor in board.model.motor)
    assert (told.left_counts, told.right_counts) == pytest.approx((-left + lean, right + lean), abs=1.1)
    assert told.line_errors == 0


def test_the_loop_is_never_late_while_it_stands(board: BalancerBench, implementation: Implementation) -> None:
    """Three seconds here; sixty were run once."""
    board.stand()
    late, awake = board.report().late, list[float]()
    del board.frames[:-1], board.arrived_ms[:-1]
    feel = board.before_each_ms

    def turn() -> None:
        feel()
        awake.append(board.model.awake)
        for motor in board.model.motor:
            motor.position += 2 * math.sin(board.now_ms / 20)

    board.before_each_ms = turn
    board.drive(milliseconds=3_000)
    told = board.all(BalanceFrame)
    assert (told[-1].late, told[-1].line_errors, told[-1].posture) == (late, 0, BalancePosture.STANDS)
    assert len(told) == pytest.approx(300, abs=2)
    if implementation is Implementation.AVR:
        report("balancer/loop", {"periods": len(told) * 2, "awake": round(sum(awake) / len(awake), 3)})

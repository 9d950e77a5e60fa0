"""The base board's firmware at its pins, exact in simulated time."""

import itertools
from collections.abc import Iterator

import msgspec
import pytest

from giraff_schemas.framing import encode
from giraff_schemas.wire import PROTOCOL_HASH as HASH
from giraff_schemas.wire import BoardKind, DriveState, HelloFrame, Refusal, ResetCause, WheelsFrame
from giraff_sim.board import Implementation
from giraff_sim.simulation import simulation
from giraff_sim.world.room import Pose, Room
from tests.sim.line import BaseLine
from tests.sim.robots import empty_room, world_in
from tests.support.wheels import wheels_of

MS = 1000
ONLY_BASE = (BoardKind.BASE,)


@pytest.fixture
def base(implementation: Implementation) -> Iterator[BaseLine]:
    """A base board that has just been powered on."""
    with simulation(world_in(empty_room()), ONLY_BASE, implementation) as running:
        yield BaseLine(running)


def duties(line: BaseLine) -> tuple[float, float]:
    motors = line.simulation.boards[BoardKind.BASE].model.motor
    return motors[0].drive, motors[1].drive


def test_it_says_hello_then_tells_of_its_wheels_100_times_a_second(base: BaseLine) -> None:
    hello = base.boot()
    assert (hello.board, hello.protocol_hash) == (BoardKind.BASE, HASH)
    assert hello.boot_id > 0
    assert hello.reset_cause & ResetCause.POWER_ON
    base.run(2.0)
    told = base.all(WheelsFrame)
    assert len(told) == pytest.approx(200, abs=3)
    assert all((later.seq - earlier.seq) & 0xFFFF == 1 for earlier, later in itertools.pairwise(told))
    assert all(9_000 < later.board_us - earlier.board_us < 11_000 for earlier, later in itertools.pairwise(told))
    assert told[-1].board_us - told[0].board_us == pytest.approx((len(told) - 1) * 10_000, abs=1000)
    assert base.damaged == 0


def test_a_drive_frame_sets_duty_and_phase(base: BaseLine) -> None:
    base.start()
    for left, right in ((35, 35), (70, -70), (-1, 1), (-70, -35), (0, 70), (0, 0)):
        base.drive(left, right, 0.1)
        assert duties(base) == (left, right)
        assert (base.wheels.left_pwm_counts, base.wheels.right_pwm_counts) == (left, right)


def test_positive_levels_take_the_robot_forward_and_count_forward(base: BaseLine) -> None:
    base.start()
    base.drive(35, 35, 2.0)
    base.drive(0, 0, 1.0)
    plant = wheels_of(base.simulation.world).plant
    assert plant.pose.x == pytest.approx(0.6, abs=0.1)
    assert abs(plant.pose.y) < 1e-4
    assert base.wheels.left_ticks == pytest.approx(plant.left.states / 2, abs=1)
    base.drive(-20, 20, 1.0)
    base.drive(0, 0, 1.0)
    assert plant.pose.yaw > 0.3
    assert base.wheels.right_ticks > base.wheels.left_ticks


def test_the_wiring_bits_mirror_motors_and_encoders(base: BaseLine) -> None:
    base.boot()
    base.configure(wiring=1 | 2 | 4 | 16)  # both swapped, left motor and left encoder inverted
    base.drive(0, 0, 0.1)
    base.drive(40, 20, 1.0)
    assert duties(base) == (20, -40)
    assert base.wheels.left_ticks > base.wheels.right_ticks > 0


def spin(line: BaseLine, edges_a_second: tuple[int, int], seconds: int) -> list[WheelsFrame]:
    """Turn both shafts, and wait until the last edges are told of; all telemetry of it."""
    # The world would set the positions from the plant: run the board's slices without it.
    board = line.simulation.boards[BoardKind.BASE]
    now_us = line.simulation.now_us
    told = bytearray()
    for step in range(seconds * 1000 + 50):
        for motor, edges in zip(board.model.motor, edges_a_second, strict=True):
            motor.position = 2 * edges * min(step + 1, seconds * 1000) / 1000  # two quadrature states an edge of A
        now_us += MS
        board.run(now_us)
        told += board.read()
    return [frame for frame in line._decoder.feed(bytes(told)) if isinstance(frame, WheelsFrame)]


def test_20_000_edges_a_second_on_both_wheels_are_counted_exactly(base: BaseLine) -> None:
    base.start()
    began = base.wheels
    wheels = spin(base, (20_000, -20_000), 2)
    assert len(wheels) == pytest.approx(205, abs=3)
    assert all((later.seq - earlier.seq) & 0xFFFF == 1 for earlier, later in itertools.pairwise(wheels))
    assert wheels[-1].left_ticks - began.left_ticks == 40_000
    assert wheels[-1].right_ticks - began.right_ticks == -40_000
    # In passing, too: each telemetry frame is within the edges of its own instant.
    for earlier, later in itertools.pairwise(wheels[5:-10]):
        expected = (later.board_us - earlier.board_us) * 0.02
        assert later.left_ticks - earlier.left_ticks == pytest.approx(expected, abs=4)
        assert later.right_ticks - earlier.right_ticks == pytest.approx(-expected, abs=4)


@pytest.mark.parametrize(
    "edges_a_second",
    [
        (20_000, 17_317),
        (17_317, 20_000),
        (20_000, -17_317),
        (-18_181, 16_161),
        (-18_840, -1_375),
        (9_596, 16_893),
    ],
    ids=lambda edges: f"{edges[0]},{edges[1]}",
)
def test_edges_at_unequal_speeds_are_counted_exactly(base: BaseLine, edges_a_second: tuple[int, int]) -> None:
    """At equal speeds the edges of each slice fall at the same few places: what goes wrong elsewhere stays unseen."""
    base.start()
    began = base.wheels
    seconds = 2
    ended = spin(base, edges_a_second, seconds)[-1]
    # Within one: the last edge is at the very end.
    assert ended.left_ticks - began.left_ticks == pytest.approx(seconds * edges_a_second[0], abs=1)
    assert ended.right_ticks - began.right_ticks == pytest.approx(seconds * edges_a_second[1], abs=1)


def test_a_wheel_that_trembles_on_an_edge_counts_to_zero(base: BaseLine) -> None:
    base.start()
    board = base.simulation.boards[BoardKind.BASE]
    began = base.wheels.left_ticks
    now_us = base.simulation.now_us
    for step in range(2000):
        board.model.motor[0].position = 2.0 + (0.8 if step % 2 else -0.8)
        now_us += MS
        board.run(now_us)
    board.model.motor[0].position = 0.0
    board.run(now_us + 50 * MS)
    frames = [frame for frame in base._decoder.feed(board.read()) if isinstance(frame, WheelsFrame)]
    assert frames[-1].left_ticks == began


@pytest.mark.parametrize("cause", [ResetCause.EXTERNAL, ResetCause.BROWN_OUT, ResetCause.WATCHDOG, ResetCause.POWER_ON])
def test_a_reset_shows_as_a_new_boot_that_does_not_drive(base: BaseLine, cause: ResetCause) -> None:
    base.start()
    base.drive(50, 50, 0.5)
    before = base.wheels
    assert before.left_ticks > 0
    base.simulation.reset(BoardKind.BASE, cause)
    stale = base.drive_frame(50, 50)
    base.run(0.001)
    assert duties(base) == (0, 0)
    base.send(stale)
    base.run(0.3)
    hello = base.last(HelloFrame)
    assert hello.boot_id == before.boot_id + 1
    assert hello.reset_cause == cause
    assert base.wheels.boot_id == hello.boot_id
    assert base.wheels.drive_state == DriveState.NOT_CONFIGURED
    assert base.wheels.last_refusal == Refusal.BOOT_ID
    assert base.wheels.accepted == 0
    assert base.wheels.session == 0
    # And drives again after a new handshake.
    base.configure(session=9)
    base.drive(0, 0, 0.1)
    base.drive(30, 30, 0.1)
    assert duties(base) == (30, 30)


def test_without_commands_the_motors_stop_after_300_ms_and_wait_for_zero(base: BaseLine) -> None:
    base.start()
    base.drive(50, 50, 0.5)
    accepted = base.wheels.accepted
    base.send(base.drive_frame(60, 60))
    while duties(base) != (60, 60):
        base.step()
    set_at = base.simulation.now_us
    while duties(base) != (0, 0):
        base.step()
    # `drive` is the mean of a millisecond: it differs from 60 in the one in which the frame took effect.
    assert base.simulation.now_us - set_at == pytest.approx(300 * MS, abs=2 * MS)
    base.run(0.03)
    assert base.wheels.drive_state == DriveState.COMMAND_TIMEOUT
    assert base.wheels.accepted == accepted + 1
    base.drive(50, 50, 0.2)
    assert duties(base) == (0, 0)
    assert base.wheels.last_refusal == Refusal.AWAITING_ZERO
    base.drive(0, 0, 0.05)
    base.drive(50, 50, 0.1)
    assert duties(base) == (50, 50)


def test_20_kilobytes_of_queued_frames_drive_for_150_ms_of_age_and_no_longer(base: BaseLine) -> None:
    base.start()
    made_at = base.simulation.now_us
    frames = b""
    while len(frames) < 20_000:
        frames += encode(base.drive_frame(70, 70).pack())
    frame_bytes = len(encode(base.drive_frame(70, 70).pack()))
    accepted = base.wheels.accepted
    base.send_bytes(frames)
    base.run(2.2)
    assert base.queued == 0
    verdict = base.simulation.record.window(made_at, base.simulation.now_us)
    assert verdict.peak_counts == 70
    assert verdict.last_driven_us is not None
    # Frames are younger than 150 ms at best for so long, and the last of them for the board's time-out more.
    assert verdict.last_driven_us - made_at <= (150 + 300 + 2) * MS
    assert base.wheels.drive_state == DriveState.COMMAND_TIMEOUT
    assert base.wheels.last_refusal == Refusal.STALE
    told = (base.wheels.accepted - accepted) & 0xFFFF
    # 115 200 baud are 11 520 bytes a second.
    assert 0 < told < 0.16 * 11_520 / frame_bytes
    assert told + verdict.refused == pytest.approx(len(frames) / frame_bytes, rel=0.06)


def test_frames_from_a_queue_that_was_held_back_never_drive(base: BaseLine) -> None:
    base.start()
    held = [base.drive_frame(70, 70) for _ in range(1300)]
    base.run(0.4)
    base.drive(0, 0, 0.05)
    began = base.simulation.now_us
    for frame in held:
        base.send(msgspec.structs.replace(frame, seq=frame.seq + 2000))
    base.run(2.5)
    verdict = base.simulation.record.window(began, base.simulation.now_us)
    assert verdict.peak_counts == 0
    assert verdict.accepted <= 1  # the last zero, told of late
    assert verdict.refused >= len(held)


def test_noise_on_the_line_is_counted_and_harmless(base: BaseLine) -> None:
    base.start()
    noise = bytes((137 * k * k + 31 * k + 7) & 0xFF for k in range(5000))
    base.send_bytes(noise + b"\0")
    base.run(1.0)
    assert duties(base) == (0, 0)
    assert base.wheels.line_errors > 0
    base.drive(0, 0, 0.05)
    base.drive(35, 35, 0.1)
    assert duties(base) == (35, 35)
    assert base.damaged == 0


def test_the_battery_is_measured(base: BaseLine) -> None:
    base.boot()
    base.run(0.1)
    assert base.wheels.battery_adc_counts == pytest.approx(24.0 / 0.03, abs=1)
    wheels_of(base.simulation.world).plant.open_volts = 18.0
    base.run(0.1)
    assert base.wheels.battery_adc_counts == pytest.approx(18.0 / 0.03, abs=1)


def test_a_cut_encoder_stands_still_and_a_mended_one_goes_on_counting(base: BaseLine) -> None:
    base.start(stall_level=255)
    base.drive(40, 40, 1.0)
    wheels_of(base.simulation.world).cut_encoder(0, is_cut=True)
    base.drive(40, 40, 0.1)
    cut = base.wheels
    base.drive(40, 40, 1.0)
    assert base.wheels.left_ticks == cut.left_ticks
    assert base.wheels.right_ticks > cut.right_ticks + 500
    wheels_of(base.simulation.world).cut_encoder(0, is_cut=False)
    mended_at = wheels_of(base.simulation.world).plant.left.states / 2
    base.drive(40, 40, 1.0)
    base.drive(0, 0, 1.0)
    gone = wheels_of(base.simulation.world).plant.left.states / 2 - mended_at
    assert base.wheels.left_ticks - cut.left_ticks == pytest.approx(gone, abs=2)


def test_encoders_agree_with_the_true_travel_along_a_winding_path(implementation: Implementation) -> None:
    room = Room("wide", Pose(0.0, 0.0, 0.3))
    with simulation(world_in(room), ONLY_BASE, implementation) as running:
        base = BaseLine(running)
        base.start()
        for left, right in ((70, 60), (20, 70), (-40, 40), (-70, -50), (10, -10), (70, 70)):
            base.drive(left, right, 0.5)
        base.drive(0, 0, 0.5)
        plant = wheels_of(running.world).plant
        assert base.wheels.left_ticks == pytest.approx(plant.left.states / 2, abs=1)
        assert base.wheels.right_ticks == pytest.approx(plant.right.states / 2, abs=1)

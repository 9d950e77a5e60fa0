"""The closed loop of speeds on the board's processor drives as it does on this machine, and leaves edges their time."""

import random

import msgspec
import pytest

from giraff_schemas.framing import encode
from giraff_schemas.wire import BoardKind, DriveState, WheelsFrame
from giraff_sim.board import Implementation
from giraff_sim.bodies.registry import world_of
from giraff_sim.config import SimConfig
from giraff_sim.simulation import simulation
from giraff_sim.truth import TruthRanges, draw_truth
from giraff_sim.world.hand import StillHand
from tests.sim.line import BaseLine
from tests.sim.robots import empty_room
from tests.support.robots import BY_SPEED, ROBOT

SECONDS = 2.0


def driven(implementation: Implementation, seed: int) -> list[WheelsFrame]:
    """All telemetry of a session in which a drawn robot is asked for three pairs of speeds, one after the other."""
    chance = random.Random(seed)
    world = world_of(
        empty_room(),
        ROBOT,
        BY_SPEED,
        SimConfig(),
        StillHand(),
        seed,
        truth=draw_truth("uncalibrated", TruthRanges(), seed),
    )
    with simulation(world, (BoardKind.BASE,), implementation) as running:
        line = BaseLine(running)
        line.boot()
        line.begin_session(BY_SPEED.board_settings(ROBOT, 1.2))
        line.go(0.0, 0.0, 0.1)
        left, right = chance.choice((-1, 1)), chance.choice((-1, 1))
        for _ in range(3):
            line.go(left * chance.uniform(0.1, 0.5), right * chance.uniform(0.1, 0.5), SECONDS / 3)
        return line.all(WheelsFrame)


@pytest.mark.parametrize("seed", range(5))
def test_a_session_on_either_gives_the_same_pwm_within_a_count(seed: int) -> None:
    drive_on_either(seed)


def drive_on_either(seed: int) -> None:
    """Drive on both, and compare frame by frame.

    Nearly always they are alike: an edge at the very end of a period counts in that one here and in the next one there,
    half a millisecond on, and the loop answers it a period later. Wheels that turn round in between are farther apart.
    """
    host, processor = driven(Implementation.HOST, seed), driven(Implementation.AVR, seed)
    assert len(host) == len(processor)
    pwm: list[int] = []
    for one, other in zip(host, processor, strict=True):
        assert (one.seq, one.drive_state, one.latch) == (other.seq, other.drive_state, other.latch)
        assert one.left_ticks == pytest.approx(other.left_ticks, abs=3)
        assert one.right_ticks == pytest.approx(other.right_ticks, abs=3)
        pwm += (one.left_pwm_counts - other.left_pwm_counts, one.right_pwm_counts - other.right_pwm_counts)
    assert host[-1].drive_state == DriveState.ACTIVE
    assert max(max(abs(one.left_pwm_counts), abs(one.right_pwm_counts)) for one in host) > 30
    apart = [difference for difference in pwm if abs(difference) > 1]
    assert len(apart) <= len(pwm) / 100, apart
    assert all(abs(difference) <= 3 for difference in apart), apart


@pytest.mark.parametrize("edges_a_second", [(20_000, -20_000), (20_000, -17_317)])
def test_20_000_edges_a_second_are_counted_while_the_loop_drives(
    implementation: Implementation, edges_a_second: tuple[int, int]
) -> None:
    """It drives all the time: no wheel counts as held, and no frame is missed."""
    fine = msgspec.structs.replace(ROBOT, ticks_per_metre=40_000.0)
    left, right = (edges / fine.ticks_per_metre for edges in edges_a_second)
    world = world_of(empty_room(), fine, BY_SPEED, SimConfig(), StillHand(), 1)
    with simulation(world, (BoardKind.BASE,), implementation) as running:
        line = BaseLine(running)
        line.boot()
        line.begin_session(BY_SPEED.board_settings(fine, 1.2))
        line.go(0.0, 0.0, 0.1)
        began, told, now_us = line.wheels, len(line.all(WheelsFrame)), running.now_us
        board = running.boards[BoardKind.BASE]
        # The world would set the positions from the plant: run the board's slices without it.
        for step in range(1, 2001):
            if step % 20 == 1:
                board.write(encode(line.speed_frame(left, right).pack()))
            for motor, edges in zip(board.model.motor, edges_a_second, strict=True):
                motor.position = 2 * edges * step / 1000  # two quadrature states an edge of A
            now_us += 1000
            board.run(now_us)
            line.take(board.read(), now_us)
        assert {wheels.drive_state for wheels in line.all(WheelsFrame)[told:]} == {DriveState.ACTIVE}
        assert line.wheels.left_um_s == pytest.approx(left * 1e6, rel=0.01)
        assert line.wheels.right_um_s == pytest.approx(right * 1e6, rel=0.01)
        board.run(now_us + 30_000)
        line.take(board.read(), now_us + 30_000)
        # Within one: the last edge is at the very end.
        assert line.wheels.left_ticks - began.left_ticks == pytest.approx(2 * edges_a_second[0], abs=1)
        assert line.wheels.right_ticks - began.right_ticks == pytest.approx(2 * edges_a_second[1], abs=1)

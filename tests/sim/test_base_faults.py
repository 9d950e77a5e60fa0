"""Wheels that do not turn as told, on a plant with inertia; and the latch, over resets and power cycles."""

import random
from collections.abc import Iterator

import pytest

from giraff_schemas.wire import OPPOSITE_MS, STUCK_MS, BoardKind, DriveState, Latch, Refusal, ResetCause, Wiring
from giraff_sim.board import Implementation
from giraff_sim.bodies.wheels.body import LEFT, RIGHT
from giraff_sim.config import SimConfig
from giraff_sim.simulation import simulation
from tests.sim.line import BaseLine
from tests.sim.robots import empty_room, world_in
from tests.support.wheels import wheels_of

AVR, HOST = Implementation.AVR, Implementation.HOST
MS = 1000
ONLY_BASE = (BoardKind.BASE,)
WIRINGS = [wiring for one in Wiring for wiring in (one, ~one)]
"""Any two wires in each of their four ways."""


@pytest.fixture
def base(implementation: Implementation) -> Iterator[BaseLine]:
    """A base board that has just been powered on."""
    with simulation(world_in(empty_room()), ONLY_BASE, implementation) as running:
        yield BaseLine(running)


def latch(line: BaseLine) -> Latch:
    assert (line.wheels.drive_state == DriveState.LATCHED) == (line.wheels.latch != Latch.NONE)
    return Latch(line.wheels.latch)


def driven_ms_after(line: BaseLine, fault_us: int) -> float:
    """How long after a fault a motor still got something, by the black box."""
    last = line.simulation.record.window(fault_us, line.simulation.now_us).last_driven_us
    return 0.0 if last is None else (last - fault_us) / MS


@pytest.mark.parametrize(("implementation", "level"), [(HOST, 25), (HOST, 70), (HOST, -70), (AVR, -70)])
@pytest.mark.parametrize("wheel", [LEFT, RIGHT])
def test_a_blocked_wheel_gets_pwm_for_half_a_second(base: BaseLine, wheel: int, level: int) -> None:
    base.start()
    base.drive(level, level, 0.737)
    wheels_of(base.simulation.world).block_wheel(wheel, is_blocked=True)
    blocked_us = base.simulation.now_us
    base.drive(level, level, 1.0)
    assert STUCK_MS - 60 <= driven_ms_after(base, blocked_us) <= STUCK_MS + 3
    assert latch(base) is (Latch.LEFT_STUCK if wheel == LEFT else Latch.RIGHT_STUCK)
    assert base.wheels.last_refusal == Refusal.LATCHED
    # Mended and released, it drives again, after a zero.
    wheels_of(base.simulation.world).block_wheel(wheel, is_blocked=False)
    base.estop(engage=False)
    base.drive(level, level, 0.1)
    assert base.wheels.drive_state == DriveState.AWAITING_ZERO
    base.drive(0, 0, 0.1)
    base.drive(level, level, 1.0)
    assert abs(base.wheels.left_pwm_counts) == abs(level)


def test_a_cut_encoder_stops_the_robot_in_half_a_second_whenever_it_is_cut(base: BaseLine) -> None:
    base.start()
    longest = 0.0
    for cut_after in (0.0, 0.013, 0.1, 0.351, 0.604):
        base.drive(40, 40, cut_after)
        wheels_of(base.simulation.world).cut_encoder(RIGHT, is_cut=True)
        cut_us = base.simulation.now_us
        base.drive(40, 40, 0.7)
        longest = max(longest, driven_ms_after(base, cut_us))
        assert latch(base) is Latch.RIGHT_STUCK
        wheels_of(base.simulation.world).cut_encoder(RIGHT, is_cut=False)
        base.estop(engage=False)
        base.drive(0, 0, 0.4)
    assert longest <= STUCK_MS + 10, "but for the time of a drive frame on its line"


@pytest.mark.parametrize(("implementation", "level"), [(HOST, 12), (HOST, -12), (HOST, 70), (AVR, -12)])
@pytest.mark.parametrize(
    ("soldered", "cause"),
    [
        (Wiring.INVERT_LEFT_MOTOR, Latch.LEFT_OPPOSITE),
        (Wiring.INVERT_RIGHT_MOTOR, Latch.RIGHT_OPPOSITE),
        (Wiring.INVERT_LEFT_ENCODER, Latch.LEFT_OPPOSITE),
        (Wiring.INVERT_RIGHT_ENCODER, Latch.RIGHT_OPPOSITE),
    ],
)
def test_what_is_soldered_the_other_way_round_stops_the_robot_as_it_starts(
    base: BaseLine, soldered: Wiring, cause: Latch, level: int
) -> None:
    wheels_of(base.simulation.world).rewire(soldered)
    base.start()
    began_us = base.simulation.now_us
    base.drive(level, level, 1.0)
    assert driven_ms_after(base, began_us) <= OPPOSITE_MS + 70
    assert latch(base) is cause


@pytest.mark.parametrize("soldered", [Wiring.SWAP_MOTORS, Wiring.SWAP_ENCODERS])
def test_what_is_swapped_stops_a_robot_that_turns_on_the_spot(base: BaseLine, soldered: Wiring) -> None:
    wheels_of(base.simulation.world).rewire(soldered)
    base.start()
    base.drive(35, 35, 1.0)
    assert latch(base) is Latch.NONE, "straight on, both are alike"
    base.drive(0, 0, 0.5)
    began_us = base.simulation.now_us
    base.drive(-12, 12, 1.0)
    assert driven_ms_after(base, began_us) <= OPPOSITE_MS + 70
    assert latch(base) is Latch.LEFT_OPPOSITE


def test_an_encoder_that_turns_round_while_the_robot_drives_stops_it(base: BaseLine) -> None:
    base.start()
    base.drive(35, 35, 0.611)
    before = base.wheels.left_ticks
    wheels_of(base.simulation.world).rewire(Wiring.INVERT_LEFT_ENCODER)
    fault_us = base.simulation.now_us
    base.drive(35, 35, 0.02)
    assert abs(base.wheels.left_ticks - before) < 20, "soldering moves no encoder"
    base.drive(35, 35, 0.5)
    assert driven_ms_after(base, fault_us) <= OPPOSITE_MS + 30
    assert latch(base) is Latch.LEFT_OPPOSITE


def test_a_robot_that_is_configured_as_it_is_soldered_drives_straight() -> None:
    for soldered in WIRINGS:
        with simulation(world_in(empty_room()), ONLY_BASE, HOST) as running:
            base = BaseLine(running)
            wheels_of(running.world).rewire(soldered)
            base.start(wiring=soldered)
            base.drive(40, 20, 0.5)
            base.drive(-40, 40, 0.5)
            base.drive(0, 0, 0.3)
            plant = wheels_of(running.world).plant
            assert latch(base) is Latch.NONE, soldered
            assert base.wheels.left_ticks == pytest.approx(plant.left.states / 2, abs=1)
            assert base.wheels.right_ticks == pytest.approx(plant.right.states / 2, abs=1)


@pytest.mark.parametrize(("implementation", "period_ms"), [(HOST, 60), (HOST, 140), (HOST, 900), (AVR, 60)])
def test_full_reversals_are_no_fault(base: BaseLine, period_ms: int) -> None:
    base.start()
    for _ in range(max(2, 1200 // period_ms)):
        base.drive(70, -70, period_ms / 1000)
        base.drive(-70, 70, period_ms / 1000)
    assert latch(base) is Latch.NONE
    assert base.wheels.refused == 0


def test_a_reversal_to_any_level_while_the_robot_still_rolls_is_no_fault(base: BaseLine) -> None:
    base.start()
    for level in (-1, -4, -12, -25, -40):
        base.drive(70, 70, 0.7)
        base.drive(level, level, 0.7)
        assert latch(base) is Latch.NONE, level
        base.drive(0, 0, 0.04)
        base.drive(level, level, 0.3)
        base.drive(-level, -level, 0.3)
        assert latch(base) is Latch.NONE, level


@pytest.mark.parametrize(("implementation", "seed"), [(AVR, 0), (HOST, 1)])
def test_whatever_a_healthy_robot_is_asked_is_no_fault(implementation: Implementation, seed: int) -> None:
    ask_whatever(implementation, seed, 30 if implementation is AVR else 60)


def ask_whatever(implementation: Implementation, seed: int, times: int = 60) -> None:
    """Start, stop and change the level, mostly about the stall level, on a weak battery: that is no fault."""
    chance = random.Random(seed)
    world = world_in(empty_room(), SimConfig(battery_volts=19.0))
    with simulation(world, ONLY_BASE, implementation) as running:
        base = BaseLine(running)
        base.start()
        for _ in range(times):
            left, right = (chance.choice((0, 1, 8, 24, 25, 26, 40, 70)) * chance.choice((1, 1, -1)) for _ in range(2))
            base.drive(left, right, chance.choice((0.02, 0.06, 0.2, 0.52)))
            assert latch(base) is Latch.NONE, (left, right)


def test_the_latch_outlasts_a_watchdog_reset_and_a_power_cycle(implementation: Implementation) -> None:
    with simulation(world_in(empty_room()), ONLY_BASE, implementation) as running:
        base = BaseLine(running)
        base.start()
        base.drive(40, 40, 0.3)
        wheels_of(base.simulation.world).block_wheel(RIGHT, is_blocked=True)
        base.drive(40, 40, 0.7)
        assert latch(base) is Latch.RIGHT_STUCK
        running.reset(BoardKind.BASE, ResetCause.WATCHDOG)
        boot_id = base.wheels.boot_id
        base.run(0.1)
        assert base.wheels.boot_id == boot_id + 1
        assert latch(base) is Latch.RIGHT_STUCK
        base.configure(session=9)
        base.drive(0, 0, 0.1)
        assert latch(base) is Latch.RIGHT_STUCK
        kept = running.boards[BoardKind.BASE].eeprom
    with simulation(world_in(empty_room()), ONLY_BASE, implementation) as running:
        running.boards[BoardKind.BASE].keep_from(kept)
        base = BaseLine(running)
        base.start()
        base.drive(40, 40, 0.3)
        assert latch(base) is Latch.RIGHT_STUCK
        assert running.record.window(0, running.now_us).peak_counts == 0
        base.estop(engage=False)
        base.drive(0, 0, 0.1)
        base.drive(40, 40, 0.1)
        assert base.wheels.left_pwm_counts == 40
        running.reset(BoardKind.BASE, ResetCause.POWER_ON)
        base.run(0.1)
        assert latch(base) is Latch.NONE


def test_an_estop_stops_at_once_and_outlasts_a_reset(base: BaseLine) -> None:
    base.start()
    base.drive(70, 70, 0.5)
    asked_us = base.simulation.now_us
    base.estop(engage=True)
    assert driven_ms_after(base, asked_us) <= 5
    assert latch(base) is Latch.ESTOP
    base.simulation.reset(BoardKind.BASE, ResetCause.BROWN_OUT)
    base.run(0.1)
    assert latch(base) is Latch.ESTOP


def test_a_torn_cell_of_eeprom_is_a_latch(implementation: Implementation) -> None:
    with simulation(world_in(empty_room()), ONLY_BASE, implementation) as running:
        base = BaseLine(running)
        base.boot()
        assert latch(base) is Latch.NONE
        kept = running.boards[BoardKind.BASE].eeprom
        running.boards[BoardKind.BASE].keep_from(kept[:5] + b"\xff" + kept[6:])
        base.run(0.1)
        assert latch(base) is Latch.ESTOP

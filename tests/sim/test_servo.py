"""Servo outputs and the motor driver behind them: pulses as a real timer gives them, and what their loss does."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import msgspec
import pytest

from giraff_schemas.boards import ARDROS_BOARD
from giraff_schemas.wire import BoardKind
from giraff_sim.board import BUILD, Board, RunState
from giraff_sim.bodies.registry import world_of
from giraff_sim.control.control import Control
from giraff_sim.simulation import Simulation, WallPacer
from giraff_sim.world.hand import StillHand
from tests.firmware.builds import compiled_for_avr
from tests.sim.robots import EXACT, empty_room
from tests.sim.test_control import ask, make_hand
from tests.support.robots import DRIVE, ROBOT
from tests.support.wheels import wheels_of

PROGRAM: Final = """
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

static void mid_pulse(int frames)
{
    while (frames--) {
        while (!(TIFR3 & _BV(TOV3)))
            ;
        TIFR3 = _BV(TOV3);
    }
    while (TCNT3 < 1000)
        ;
}

int main(void)
{
    ICR3 = 39999;
    OCR3C = 0x0D47;
    OCR3B = 2499;
    DDRE = _BV(4) | _BV(5);
    TCCR3A = _BV(COM3B1) | _BV(COM3C1) | _BV(WGM31);
    TCCR3B = _BV(WGM33) | _BV(WGM32) | _BV(CS31);
    mid_pulse(5);
    OCR3C = 0x0E47;             /* its high byte alone changes */
    mid_pulse(5);
    cli();
    sleep_mode();
}
"""
FIRST, SECOND, RIGHT = 1700.0, 1828.0, 1250.0


def duty(pulse_us: float) -> Any:
    return pytest.approx((pulse_us - 1500.0) * 255.0 / 500.0, abs=0.3)


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> Path:
    source = tmp_path_factory.mktemp("servo") / "pulses.c"
    source.write_text(PROGRAM)
    return compiled_for_avr(source, "atmega2560")


@pytest.fixture
def board(image: Path) -> Iterator[Board]:
    made = Board(ARDROS_BOARD, BUILD / "lockstep" / "lockstep.so", image)
    yield made
    made.close()


def drives(board: Board) -> tuple[float, float]:
    return board.model.motor[0].drive, board.model.motor[1].drive


def test_a_pulse_is_taken_over_at_its_frames_begin_and_a_stopped_program_leaves_it(board: Board) -> None:
    seen = set()
    for ms in range(1, 240):
        board.run(ms * 1000)
        seen.add(tuple(round(motor.pulse_us) for motor in board.model.motor))
        if ms == 50:
            assert drives(board) == (duty(FIRST), duty(RIGHT))
            assert board.model.awake == 1.0
    assert seen == {(0, 0), (FIRST, RIGHT), (SECOND, RIGHT)}
    assert (board.state, board.model.awake) == (RunState.STOPPED, 0.0)
    assert drives(board) == (duty(SECOND), duty(RIGHT))


def test_a_reset_cuts_a_pulse_short_and_the_driver_takes_it(board: Board) -> None:
    board.run(61_000)
    board.reset()
    board.run(61_900)
    assert board.model.motor[0].pulse_us < 1000.0
    assert board.model.motor[0].drive_peak == 255
    assert drives(board) == (-255.0, -255.0)
    board.run(70_000)
    board.run(71_000)
    assert drives(board) == (duty(FIRST), duty(RIGHT))


def test_without_pulses_the_driver_is_off_after_its_timeout_if_it_has_one(board: Board) -> None:
    drive = msgspec.structs.replace(DRIVE, board="ardros")
    world = world_of(empty_room(), ROBOT, drive, EXACT, StillHand(), 1)
    simulation = Simulation({BoardKind.BASE: board}, world)
    control = Control(simulation, {}, WallPacer(), make_hand)
    simulation.run(0.05)
    assert ask(control, op="signal", wheel="left", cut=True).ok
    simulation.run(0.08)
    assert drives(board) == (duty(FIRST), duty(RIGHT))
    simulation.run(0.02)
    assert drives(board) == (0.0, duty(RIGHT))
    assert ask(control, op="signal", wheel="left", cut=False).ok
    simulation.run(0.03)
    assert drives(board) == (duty(SECOND), duty(RIGHT))
    board.model.driver_timeout_ms = 0
    assert ask(control, op="signal", wheel="left", cut=True).ok
    simulation.run(0.2)
    assert drives(board) == (duty(SECOND), duty(RIGHT))


@pytest.mark.parametrize("board", ["base", "roboclaw"])
def test_without_servo_outputs_there_is_no_signal_wire(board: str) -> None:
    drive = msgspec.structs.replace(DRIVE, board=board)
    world = world_of(empty_room(), ROBOT, drive, EXACT, StillHand(), 1)
    with pytest.raises(ValueError, match=f"the board {board} has no servo output"):
        wheels_of(world).cut_signal(0, is_cut=True)

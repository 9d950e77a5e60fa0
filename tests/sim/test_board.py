"""Boards as objects: what can go wrong on opening them, what survives a reset, what is private to each."""

import shutil
from pathlib import Path

import pytest

from giraff_schemas.boards import BASE_BOARD, JOYSTICK_BOARD, RANGER_BOARD
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.wire import BoardKind, HelloFrame, HelloRequestFrame, RangeFrame, ResetCause, WheelsFrame
from giraff_sim.board import BUILD, Board, BoardError, Implementation, RunState, open_board
from giraff_sim.simulation import Simulation, simulation
from tests.firmware.builds import built, compiled_for_avr
from tests.sim.line import BaseLine
from tests.sim.robots import empty_room, world_in

LOCKSTEP = BUILD / "lockstep" / "lockstep.so"


def boot_of(board: Board, until_us: int) -> HelloFrame:
    board.run(until_us)
    return next(frame for frame in Decoder().feed(board.read()) if isinstance(frame, HelloFrame))


def test_what_is_missing_is_named_with_the_way_out(tmp_path: Path) -> None:
    with pytest.raises(BoardError, match=r"lockstep\.so is missing: run make"):
        open_board(BASE_BOARD, Implementation.AVR, tmp_path)
    with pytest.raises(BoardError, match=r"ranger\.so is missing: run make"):
        open_board(RANGER_BOARD, Implementation.HOST, tmp_path)
    with pytest.raises(BoardError, match=r"base\.elf is missing: run make -C firmware"):
        Board(BASE_BOARD, LOCKSTEP, tmp_path / "base.elf")


def test_what_was_built_from_other_sources_is_refused(tmp_path: Path) -> None:
    for made in (BUILD / "host" / "base.so", BUILD / "firmware" / "base.elf", LOCKSTEP):
        record = made.with_suffix(".sources").read_text()
        assert "protocol.h" in record
        copy = tmp_path / made.name
        shutil.copy2(made, copy)
        source = tmp_path / f"{made.stem}.c"
        source.touch()
        copy.with_suffix(".sources").write_text(f".\n{made.stem}.o: {source.name} \\\n common.h\n")
        is_image = made.suffix == ".elf"
        with pytest.raises(BoardError, match=f"{copy} was built before .*/{source.name} changed: run make setup"):
            Board(BASE_BOARD, LOCKSTEP if is_image else copy, copy if is_image else None)


def test_what_is_no_firmware_is_refused(tmp_path: Path) -> None:
    image = tmp_path / "base.elf"
    for content in (b"", b"\x7fELF", b"not an ELF file, but long enough to hold a header"):
        image.write_bytes(content)
        with pytest.raises(BoardError, match=r"base\.elf is no AVR ELF file"):
            Board(BASE_BOARD, LOCKSTEP, image)
    with pytest.raises(BoardError, match="is no AVR ELF file"):
        Board(BASE_BOARD, LOCKSTEP, LOCKSTEP)
    with pytest.raises(BoardError, match=r"base\.elf cannot be loaded"):
        Board(BASE_BOARD, image)


def test_an_image_for_a_larger_processor_is_refused(tmp_path: Path) -> None:
    source = tmp_path / "large.c"
    source.write_text('int main(void) {}\nasm(".section .text\\n.space 70000");\n')
    image = compiled_for_avr(source, "atmega2560")
    with pytest.raises(BoardError, match=r"large\.elf is larger than the atmega644"):
        Board(BASE_BOARD, LOCKSTEP, image)


def test_boards_of_one_kind_share_nothing(implementation: Implementation) -> None:
    first, second = (open_board(BASE_BOARD, implementation) for _ in range(2))
    try:
        first.run(500_000)
        second.run(200_000)
        counts = [len([f for f in Decoder().feed(b.read()) if isinstance(f, WheelsFrame)]) for b in (first, second)]
        assert counts[0] == pytest.approx(50, abs=2)
        assert counts[1] == pytest.approx(20, abs=2)
    finally:
        first.close()
        second.close()


def test_eeprom_outlives_the_board(implementation: Implementation) -> None:
    board = open_board(JOYSTICK_BOARD, implementation)
    boot_id = boot_of(board, 100_000).boot_id
    kept = board.eeprom
    assert kept
    board.close()
    board.close()
    board = open_board(JOYSTICK_BOARD, implementation)
    board.keep_from(kept)
    assert boot_of(board, 100_000).boot_id == boot_id + 1
    board.close()


def test_an_error_in_the_world_comes_out_of_run(implementation: Implementation) -> None:
    board = open_board(RANGER_BOARD, implementation)

    def fails(_sonar: int) -> float:
        raise ZeroDivisionError("in the world")

    board.on_ping(fails)
    with pytest.raises(ZeroDivisionError, match="in the world"):
        board.run(200_000)
    board.on_ping(lambda _: 5800.0)
    board.run(400_000)
    assert any(isinstance(frame, RangeFrame) for frame in Decoder().feed(board.read()))
    board.close()


def test_the_adapter_takes_what_it_has_room_for(implementation: Implementation) -> None:
    board = open_board(BASE_BOARD, implementation)
    board.run(20_000)
    board.read()
    request = encode(HelloRequestFrame(seq=1).pack())
    room = board.model.rx_free
    assert 100 < room < 8192  # bytes that a reopened port cannot flush
    assert board.write(bytes(100_000)) == room
    assert board.model.rx_free == 0
    assert board.write(b"x") == 0
    # At 115 200 baud a byte takes 87 us.
    board.run(30_000)
    assert board.model.rx_free == pytest.approx(115, abs=3)
    board.run(1_000_000)
    assert board.write(request) == len(request)
    board.run(1_050_000)
    assert any(isinstance(frame, HelloFrame) for frame in Decoder().feed(board.read()))
    board.close()


HANGS_ON_REVERSE = """
#include <avr/interrupt.h>
#include <avr/io.h>
#include "start_values.h"

const struct start_values start_values = { 0 };

/* As soon as motor B's PHASE says backward, the program hangs in an interrupt, its motors running. */
__attribute__((constructor)) static void set_trap(void)
{
    PCMSK1 = _BV(PCINT12);
    PCICR = _BV(PCIE1);
}

ISR(PCINT1_vect)
{
    while (PINB & _BV(PB4))
        ;
}
"""


def test_a_program_that_hangs_with_its_motors_running_is_stopped_by_the_watchdog(tmp_path: Path) -> None:
    source, image = tmp_path / "hangs.c", tmp_path / "firmware" / "base.elf"
    source.write_text(HANGS_ON_REVERSE)
    built(tmp_path, source, "avr-base")
    board = Board(BASE_BOARD, LOCKSTEP, image)
    base = BaseLine(Simulation({BoardKind.BASE: board}, world_in(empty_room())))
    base.start()
    base.drive(40, 40, 0.3)
    before = base.wheels
    hangs_us = base.simulation.now_us
    base.drive(40, -40, 1.0)
    verdict = base.simulation.record.window(hangs_us, base.simulation.now_us)
    assert verdict.last_driven_us is not None
    assert 200_000 < verdict.last_driven_us - hangs_us < 350_000
    assert board.model.resets == 1
    assert base.last(HelloFrame).reset_cause == ResetCause.WATCHDOG
    assert base.last(HelloFrame).boot_id == before.boot_id + 1
    board.close()


CRASHES = """
#include <avr/interrupt.h>
#include <avr/sleep.h>
int main(void) { %s; }
"""


@pytest.mark.parametrize(
    ("statement", "state"),
    [("cli(); sleep_mode()", RunState.STOPPED), ("((void (*)(void))0x7FF0)()", RunState.CRASHED)],
)
def test_a_processor_that_stands_is_told_and_a_reset_starts_it(tmp_path: Path, statement: str, state: RunState) -> None:
    source = tmp_path / "stands.c"
    source.write_text(CRASHES % statement)
    board = Board(JOYSTICK_BOARD, LOCKSTEP, compiled_for_avr(source, "atmega328p"))
    board.run(10_000)
    assert board.state is state
    board.reset()
    assert board.state is RunState.RUNNING
    board.run(10_001)
    board.run(20_000)
    assert board.state is state
    board.close()


def test_a_simulation_ends_its_boards(implementation: Implementation) -> None:
    with simulation(world_in(empty_room()), (BoardKind.BASE,), implementation) as running:
        running.run(0.1)
    assert not running.boards[BoardKind.BASE].model

"""Resets, boot ids, and what happens when a program stops running."""

from collections.abc import Iterator

import pytest

from giraff_schemas.boards import BASE_BOARD, BOARDS, RANGER_BOARD
from giraff_schemas.framing import encode
from giraff_schemas.wire import (
    COMMAND_TIMEOUT_MS,
    PROTOCOL_HASH,
    BoardKind,
    DriveState,
    HelloFrame,
    HelloRequestFrame,
    Refusal,
    ResetCause,
    WheelsFrame,
)
from giraff_sim.board import Board, BoardError
from tests.firmware.bench import BaseBench, Bench
from tests.firmware.builds import compiled, open_board, with_fault

# The voltages of faults/hung_loop.c.
NOTHING_STOPS, LOOP_HANGS, CLOCK_STANDS, LOOP_HANGS_UNWATCHED = 1.0, 2.0, 3.0, 4.0
WATCHDOG_MS = 250


@pytest.fixture
def fragile() -> Iterator[BaseBench]:
    """A base board whose main loop or clock can be stopped, by the battery's voltage."""
    board = open_board(BASE_BOARD, with_fault("hung_loop", "firmware_poll", "firmware_on_millisecond"))
    board.model.battery_volts = NOTHING_STOPS
    yield BaseBench(board)
    board.close()


@pytest.mark.parametrize("kind", [*BoardKind])
def test_a_board_introduces_itself_at_power_on_and_on_request(kind: BoardKind) -> None:
    board = open_board(BOARDS[kind], compiled())
    bench = Bench(board)
    bench.run(10)
    hello = bench.last(HelloFrame)
    assert (hello.board, hello.protocol_hash, hello.boot_id) == (kind, PROTOCOL_HASH, 1)
    assert hello.reset_cause == ResetCause.POWER_ON
    bench.forget()
    bench.send(HelloRequestFrame(seq=1))
    bench.run(10)
    assert bench.last(HelloFrame).boot_id == 1
    board.close()


@pytest.mark.parametrize(
    ("eeprom", "boot_id"),
    [
        (b"\xff\xff\xff\xff", 1),
        (b"\x00\x00\x00\x00", 1),
        (b"\x29\x00\x00\x00", 42),
        (b"\xff\x00\x00\x00", 256),
        (b"\xfe\xff\xff\xff", 0xFFFFFFFF),
    ],
)
def test_boots_are_counted_in_eeprom_and_never_as_0(base: BaseBench, eeprom: bytes, boot_id: int) -> None:
    base.board.keep_from(eeprom)
    base.run(20)
    assert base.last(HelloFrame).boot_id == boot_id
    assert base.board.eeprom[:4] == boot_id.to_bytes(4, "little")


@pytest.mark.parametrize("cause", [*ResetCause])
def test_after_any_reset_all_is_as_at_power_on(base: BaseBench, cause: ResetCause) -> None:
    fresh = base.all(WheelsFrame)[0]
    base.start(60, 60)
    base.model.motor[0].position += 200
    base.run(20)
    command = base.drive_frame(60, 60)
    base.forget()
    base.board.reset(cause)
    base.run(1)
    assert base.duties() == (0, 0)
    base.run(14)
    assert base.last(HelloFrame).reset_cause == cause
    first = base.all(WheelsFrame)[0]
    assert (first.boot_id, first.board_us, first.left_ticks) == (2, fresh.board_us, 0)
    assert (first.seq, first.session, first.accepted, first.line_errors) == (fresh.seq, 0, 0, 0)
    base.send(command)
    base.run(15)
    assert base.wheels().last_refusal == Refusal.BOOT_ID
    base.configure()
    base.drive(0, 0)
    base.drive(30, 30)
    assert base.duties() == (30, 30)


def test_a_main_loop_that_hangs_is_reset_and_drives_nothing(fragile: BaseBench) -> None:
    fragile.start(60, 60)
    fragile.send(fragile.drive_frame(60, 60))
    fragile.run(5)
    fragile.forget()
    fragile.model.battery_volts = LOOP_HANGS
    assert fragile.stopped_after_ms() == pytest.approx(WATCHDOG_MS, abs=2)
    assert fragile.model.resets == 1
    fragile.model.battery_volts = NOTHING_STOPS
    fragile.run(30)
    assert fragile.last(HelloFrame).reset_cause == ResetCause.WATCHDOG
    assert fragile.wheels().drive_state == DriveState.NOT_CONFIGURED


def test_a_clock_that_stands_is_a_reason_to_reset_too(fragile: BaseBench) -> None:
    """Time-outs need it. The main loop goes on: each byte that comes in wakes it."""
    fragile.start(60, 60)
    fragile.model.battery_volts = CLOCK_STANDS
    stopped_ms = fragile.stopped_after_ms(lambda: fragile.send_bytes(b"\x01\x00"))
    assert stopped_ms == pytest.approx(WATCHDOG_MS, abs=2)
    assert fragile.model.resets == 1


def test_the_command_time_out_needs_no_main_loop(fragile: BaseBench) -> None:
    fragile.start(60, 60)
    fragile.send(fragile.drive_frame(60, 60))
    fragile.run(3)
    fragile.model.battery_volts = LOOP_HANGS_UNWATCHED
    assert fragile.stopped_after_ms() == pytest.approx(COMMAND_TIMEOUT_MS, abs=3)
    assert fragile.model.resets == 0


def test_bytes_that_find_no_room_are_counted_and_cost_only_their_own_frames(fragile: BaseBench) -> None:
    fragile.start(60, 60)
    accepted = fragile.wheels().accepted
    ring = 127
    frames = [encode(fragile.drive_frame(50, 50).pack()) for _ in range(10)]
    fragile.model.battery_volts = LOOP_HANGS
    fragile.send_bytes(b"".join(frames))
    fragile.run(30)
    fragile.model.battery_volts = NOTHING_STOPS
    fragile.run(20)
    whole = next(n for n in range(10) if len(b"".join(frames[: n + 1])) > ring)
    assert fragile.wheels().accepted == accepted + whole
    assert fragile.wheels().line_errors == len(b"".join(frames)) - ring
    fragile.send_bytes(b"\0")
    fragile.drive(40, 40)
    assert fragile.duties() == (40, 40)
    assert fragile.model.resets == 0


def test_a_library_is_one_kind_of_board() -> None:
    library = compiled() / "host" / "base.so"
    with pytest.raises(BoardError, match="this library is the board base, not ranger"):
        Board(RANGER_BOARD, library)

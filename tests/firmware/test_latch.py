"""The base board's latch: engaged by anybody at any time, released by a fresh frame only, kept over everything."""

import itertools
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from giraff_schemas.boards import BASE_BOARD
from giraff_schemas.wire import (
    ECHO_MAX_AGE_MS,
    STUCK_MS,
    DriveState,
    EstopFrame,
    Latch,
    Refusal,
    ResetCause,
    Wiring,
)
from tests.firmware.bench import BaseBench
from tests.firmware.builds import compiled, open_board, with_fault

TELEMETRY_MS = 15  # within which telemetry tells of what has happened
FRAME_MS = 3  # within which a frame has come over the line and acted
LATCH_AT = 4  # of the two cells in EEPROM
ERASED, RELEASED, LATCHED = 0xFF, 0x5A, 0xA0  # as latch.c has them
CAUSES = [cause for cause in Latch if cause is not Latch.NONE]


def told(base: BaseBench) -> tuple[int, int]:
    base.run(TELEMETRY_MS)
    return base.wheels().drive_state, base.wheels().latch


def engage(base: BaseBench, **changes: int) -> None:
    base.send(base.estop_frame(**changes))
    base.run(TELEMETRY_MS)


def release(base: BaseBench, **changes: int) -> None:
    base.send(base.estop_frame(engage=0, **changes))
    base.run(TELEMETRY_MS)


@contextmanager
def powered_on_with(cells: tuple[int, int]) -> Iterator[BaseBench]:
    """A base board that was powered on with these two cells."""
    board = open_board(BASE_BOARD, compiled())
    board.keep_from(bytes((7, 0, 0, 0, *cells)))
    yield BaseBench(board)
    board.close()


def test_an_estop_takes_the_time_of_its_frame_and_no_more(base: BaseBench) -> None:
    base.start(70, 70)
    base.send(base.estop_frame())
    base.run(FRAME_MS)
    assert base.duties() == (0, 0)
    assert told(base) == (DriveState.LATCHED, Latch.ESTOP)
    assert (base.wheels().left_pwm_counts, base.wheels().right_pwm_counts) == (0, 0)


@pytest.mark.parametrize(
    "changes",
    [{"boot_id": 0}, {"boot_id": 99}, {"board_ms": 0xFFFF0000}, {"session": 0}, {"session": 99}, {"engage": 255}],
)
@pytest.mark.parametrize("configured", [False, True])
def test_an_estop_is_obeyed_whatever_else_it_says(base: BaseBench, configured: bool, changes: dict[str, int]) -> None:
    if configured:
        base.start(40, 40)
    engage(base, **changes)
    assert told(base) == (DriveState.LATCHED, Latch.ESTOP)
    assert base.duties() == (0, 0)
    assert base.wheels().refused == 0


def test_while_latched_no_drive_frame_is_accepted(base: BaseBench) -> None:
    base.start(40, 40)
    engage(base)
    accepted, refused = base.wheels().accepted, base.wheels().refused
    base.drive(0, 0, 100)
    base.drive(40, 40, 400)
    assert told(base) == (DriveState.LATCHED, Latch.ESTOP)
    assert base.wheels().last_refusal == Refusal.LATCHED
    assert (base.wheels().accepted, base.wheels().refused) == (accepted, refused + 25)
    assert base.duties() == (0, 0)


def test_a_new_session_is_accepted_and_releases_nothing(base: BaseBench) -> None:
    engage(base)
    base.configure(session=8, wiring=Wiring.INVERT_LEFT_ENCODER, level_max=20)
    assert base.wheels().session == 8
    assert told(base) == (DriveState.LATCHED, Latch.ESTOP)
    base.model.motor[0].position += 200
    base.drive(0, 0)
    base.drive(20, 20, 100)
    assert base.model.motor[0].drive_peak == 0
    assert base.wheels().left_ticks == -100


@pytest.mark.parametrize("levels", [(0, 0), (20, 20)])
def test_a_latch_may_outlast_the_numbers_of_the_frames(base: BaseBench, levels: tuple[int, int]) -> None:
    """A host that goes on at 100 Hz has used them all after 11 minutes."""
    base.start(40, 40)
    engage(base)
    for _ in range(3):
        base.seq += 0x5000
        base.drive(*levels)
        assert told(base) == (DriveState.LATCHED, Latch.ESTOP)
    release(base)
    base.drive(0, 0)
    assert told(base) == (DriveState.ACTIVE, Latch.NONE)


def test_a_release_permits_motion_and_never_causes_it(base: BaseBench) -> None:
    base.start(40, 40)
    engage(base)
    release(base)
    assert told(base) == (DriveState.AWAITING_ZERO, Latch.NONE)
    base.model.motor[0].drive_peak = 0
    base.drive(40, 40, 100)
    assert (base.wheels().drive_state, base.wheels().last_refusal) == (DriveState.AWAITING_ZERO, Refusal.AWAITING_ZERO)
    assert base.model.motor[0].drive_peak == 0
    base.drive(0, 0)
    base.drive(40, 40)
    assert base.duties() == (40, 40)


@pytest.mark.parametrize(
    ("changes", "refusal"),
    [
        ({"boot_id": 0}, Refusal.BOOT_ID),
        ({"boot_id": 2}, Refusal.BOOT_ID),
        ({"board_ms": -ECHO_MAX_AGE_MS - 1}, Refusal.STALE),
        ({"board_ms": 10}, Refusal.STALE),
        ({"session": 8}, Refusal.NOT_CONFIGURED),
        ({"session": 0}, Refusal.NOT_CONFIGURED),
    ],
)
def test_a_release_with_one_thing_wrong_is_refused(base: BaseBench, changes: dict[str, int], refusal: Refusal) -> None:
    """`board_ms` is from the frame's arrival on."""
    base.configure()
    engage(base)
    base.run(2 * ECHO_MAX_AGE_MS)
    refused = base.wheels().refused
    if "board_ms" in changes:
        changes = {"board_ms": base.now_ms + 1 + changes["board_ms"]}
    release(base, **changes)
    assert told(base) == (DriveState.LATCHED, Latch.ESTOP)
    assert (base.wheels().last_refusal, base.wheels().refused) == (refusal, refused + 1)
    release(base)
    assert told(base) == (DriveState.AWAITING_ZERO, Latch.NONE)


def test_a_release_may_echo_a_time_as_old_as_a_drive_frame_may(base: BaseBench) -> None:
    base.configure()
    engage(base)
    base.run(2 * ECHO_MAX_AGE_MS)
    release(base, board_ms=base.now_ms + 1 - ECHO_MAX_AGE_MS)
    assert told(base) == (DriveState.AWAITING_ZERO, Latch.NONE)


def test_a_board_without_a_session_is_not_released(base: BaseBench) -> None:
    engage(base)
    release(base, session=0)
    assert base.wheels().last_refusal == Refusal.NOT_CONFIGURED
    assert told(base) == (DriveState.LATCHED, Latch.ESTOP)


def test_a_release_from_before_the_latch_releases_nothing(base: BaseBench) -> None:
    """Its host saw no latch, or another one: as fresh as it is, it clears nothing newer."""
    base.configure()
    engage(base)
    frame = base.estop_frame(engage=0)
    base.send(frame)
    base.run(TELEMETRY_MS)
    assert told(base) == (DriveState.AWAITING_ZERO, Latch.NONE)
    engage(base)
    base.send(frame)
    assert told(base) == (DriveState.LATCHED, Latch.ESTOP)
    assert base.wheels().last_refusal == Refusal.STALE
    release(base)
    assert told(base) == (DriveState.AWAITING_ZERO, Latch.NONE)


def test_a_release_of_nothing_leaves_a_board_that_drives_alone(base: BaseBench) -> None:
    base.start(40, 40)
    base.drive(40, 40, 200)
    release(base)
    assert told(base) == (DriveState.ACTIVE, Latch.NONE)
    assert base.duties() == (40, 40)
    assert base.wheels().refused == 0


def test_who_stops_a_latched_robot_does_not_hide_why_it_was_latched(base: BaseBench) -> None:
    """A stuck wheel is told until somebody has released it."""
    base.configure(stall_level=25)
    base.drive(0, 0)
    base.drive(40, 40, STUCK_MS + TELEMETRY_MS)
    assert told(base) == (DriveState.LATCHED, Latch.LEFT_STUCK)
    engage(base)
    assert told(base) == (DriveState.LATCHED, Latch.LEFT_STUCK)
    base.run(TELEMETRY_MS)
    assert set(base.board.eeprom[LATCH_AT : LATCH_AT + 2]) == {LATCHED + Latch.LEFT_STUCK}


def test_engaging_again_needs_no_second_release(base: BaseBench) -> None:
    base.configure()
    engage(base)
    engage(base)
    release(base)
    assert told(base) == (DriveState.AWAITING_ZERO, Latch.NONE)


@pytest.mark.parametrize("cause", [*ResetCause])
def test_a_latch_outlasts_every_reset(base: BaseBench, cause: ResetCause) -> None:
    base.start(40, 40)
    engage(base)
    base.board.reset(cause)
    base.forget()
    assert told(base) == (DriveState.LATCHED, Latch.ESTOP)
    assert base.wheels().boot_id == 2
    base.configure()
    base.drive(0, 0)
    base.drive(40, 40)
    assert told(base) == (DriveState.LATCHED, Latch.ESTOP)
    release(base)
    base.drive(0, 0)
    base.drive(40, 40)
    assert base.duties() == (40, 40)
    base.board.reset(cause)
    base.forget()
    assert told(base) == (DriveState.NOT_CONFIGURED, Latch.NONE)


@pytest.mark.parametrize("cause", CAUSES)
def test_a_board_that_was_without_power_knows_why_it_is_latched(cause: Latch) -> None:
    with powered_on_with((LATCHED + cause, LATCHED + cause)) as base:
        assert told(base) == (DriveState.LATCHED, cause)


@pytest.mark.parametrize("cells", [(ERASED, ERASED), (RELEASED, RELEASED)])
def test_an_erased_or_released_eeprom_is_no_latch(cells: tuple[int, int]) -> None:
    with powered_on_with(cells) as base:
        assert told(base) == (DriveState.NOT_CONFIGURED, Latch.NONE)


@pytest.mark.parametrize("order", ["first", "second"])
def test_one_cell_in_order_never_releases(order: str) -> None:
    for good in (ERASED, RELEASED, LATCHED + Latch.LEFT_STUCK):
        for torn in (0x00, 0x5B, 0x7A, LATCHED, LATCHED + 6, 0xFE, ERASED, RELEASED):
            if torn == good:
                continue
            with powered_on_with((good, torn) if order == "first" else (torn, good)) as base:
                expected = Latch.ESTOP if good in (ERASED, RELEASED) else Latch.LEFT_STUCK
                assert told(base) == (DriveState.LATCHED, expected), (hex(good), hex(torn))


def cells_over(base: BaseBench, frame: EstopFrame) -> list[bytes]:
    """What the two cells hold, each time it is something else, while the board obeys."""
    seen = [base.board.eeprom[LATCH_AT : LATCH_AT + 2]]
    base.send(frame)
    for _ in range(TELEMETRY_MS):
        base.run(1)
        cells = base.board.eeprom[LATCH_AT : LATCH_AT + 2]
        if cells != seen[-1]:
            seen.append(cells)
    return seen


def test_at_no_instant_of_a_change_does_a_torn_write_release(base: BaseBench) -> None:
    base.configure()
    steps = [cells_over(base, base.estop_frame()), cells_over(base, base.estop_frame(engage=0))]
    assert [len(cells) for cells in steps] == [3, 3], "one cell after the other"
    for before, after in [pair for cells in steps for pair in itertools.pairwise(cells)]:
        (changed,) = (cell for cell in range(2) if before[cell] != after[cell])
        for torn in (ERASED, before[changed] & after[changed], before[changed] | after[changed]):
            cells = [torn if cell == changed else after[cell] for cell in range(2)]
            with powered_on_with((cells[0], cells[1])) as other:
                assert told(other)[0] == DriveState.LATCHED, cells


def test_eeprom_is_written_when_the_latch_changes_and_only_then() -> None:
    board = open_board(BASE_BOARD, with_fault("eeprom_writes", "hal_keep_latch", "hal_eeprom_is_ready"))
    base = BaseBench(board)
    assert base.model.pings[0] == 2, "a first boot writes what an erased EEPROM means"
    board.reset()
    base.run(TELEMETRY_MS)
    base.start(40, 40)
    assert base.model.pings[0] == 2
    for _ in range(20):
        base.send(base.estop_frame())
        base.run(TELEMETRY_MS)
    board.reset()
    base.run(TELEMETRY_MS)
    base.configure()
    assert base.model.pings[0] == 4
    release(base)
    release(base)
    assert (base.model.pings[0], base.wheels().latch) == (6, Latch.NONE)
    assert (base.model.errors, board.message) == (0, "")
    board.close()

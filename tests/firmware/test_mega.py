"""A base board on a Mega, on simavr: what arrives at all inputs of an L298N and of two BTS7960."""

from collections.abc import Iterator
from typing import Final

import pytest

from giraff_schemas.boards import ARDROS_BOARD, MEGA_BTS7960_BOARD, MEGA_L298N_BOARD, BoardType
from giraff_schemas.wire import COMMAND_TIMEOUT_MS, ResetCause
from giraff_sim.board import BUILD, Board, Implementation, open_board
from tests.firmware.bench import BaseBench
from tests.firmware.builds import changing_pwm, programs

MEGAS: Final = (MEGA_L298N_BOARD, MEGA_BTS7960_BOARD)
NAMES: Final = tuple(board.name for board in MEGAS)
PROGRAMS: Final = (*NAMES, ARDROS_BOARD.name)
LEFT, RIGHT = 0, 1
PWM, IN1, IN2 = RPWM, LPWM, R_EN = 1, 2, 4
L_EN = 8
STATES_PER_TICK = 2
FIRST_TELEMETRY_MS = 20
ALL_LOW_US = 20
"""After a reset; only to clear memory takes ten times as long."""


def bench_of(board: Board) -> BaseBench:
    bench = BaseBench(board)
    bench.run(FIRST_TELEMETRY_MS)
    return bench


@pytest.fixture(params=MEGAS, ids=NAMES)
def mega(request: pytest.FixtureRequest) -> Iterator[BaseBench]:
    programs(*PROGRAMS)
    bench = bench_of(open_board(request.param, Implementation.AVR))
    yield bench
    bench.board.close()


def forget_peaks(board: Board) -> None:
    for motor in board.model.motor:
        motor.drive_peak = 0


def peaks(board: Board) -> list[int]:
    return [motor.drive_peak for motor in board.model.motor]


def is_l298n(board: Board) -> bool:
    return board.type is MEGA_L298N_BOARD


def test_a_level_is_that_duty_at_the_driver_and_off_is_at_once(mega: BaseBench) -> None:
    mega.configure(level_max=255)
    for left, right in [(255, -255), (1, -1), (-100, 50), (-254, 86)]:
        mega.drive(0, 0)
        forget_peaks(mega.board)
        mega.drive(left, right, 40)
        assert mega.duties() == (left, right)
        assert peaks(mega.board) == [abs(left), abs(right)]
        mega.send(mega.drive_frame(0, 0))
        while mega.duties() == (left, right):
            mega.run(1)
        mega.run(1)
        assert mega.duties() == (0, 0)


@pytest.mark.parametrize("cause", [ResetCause.POWER_ON, ResetCause.EXTERNAL, ResetCause.WATCHDOG])
def test_from_any_reset_on_nothing_moves(mega: BaseBench, cause: ResetCause) -> None:
    """All outputs are driven low before memory is set up: after that no pull-down is needed."""
    board, common = mega.board, PWM if is_l298n(mega.board) else R_EN | L_EN
    forward, back = (IN1, IN2) if is_l298n(board) else (RPWM, LPWM)
    for floats in (0, common | forward, common | back):
        mega.configure(level_max=255)
        mega.drive(0, 0)
        mega.drive(255, -255, 40)
        assert mega.duties() == (255, -255)
        forget_peaks(board)
        board.reset(cause)
        for motor in board.model.motor:
            motor.inputs_float = floats
        board.run(mega.now_ms * 1000 + ALL_LOW_US)
        assert (max(peaks(board)) > 0) == (floats > 0)
        forget_peaks(board)
        mega.run(15 + FIRST_TELEMETRY_MS)
        assert peaks(board) == [0, 0]


def test_off_no_short_of_one_input_moves_anything(mega: BaseBench) -> None:
    """ENABLE is low, too: a TB6612FNG's STBY. The last stop is one by time-out."""
    mega.configure()
    for levels in [(0, 0), (60, 0), (0, -60), (0, 0), (-60, 60)]:
        mega.drive(*levels, 40)
        assert mega.model.driver_open == (levels == (0, 0))
    assert mega.stopped_after_ms() == pytest.approx(COMMAND_TIMEOUT_MS - 15, abs=6)
    assert mega.model.driver_open
    forget_peaks(mega.board)
    for shorted in (PWM, IN1, IN2) if is_l298n(mega.board) else (RPWM, LPWM, R_EN | L_EN):
        for motor in mega.model.motor:
            motor.inputs_high = shorted
        mega.run(1)
        assert peaks(mega.board) == [0, 0]


@pytest.mark.parametrize(
    ("there", "wrong"),
    [
        (MEGA_L298N_BOARD, MEGA_BTS7960_BOARD),
        (MEGA_L298N_BOARD, ARDROS_BOARD),
        (MEGA_BTS7960_BOARD, MEGA_L298N_BOARD),
        (MEGA_BTS7960_BOARD, ARDROS_BOARD),
    ],
    ids=lambda board: board.name,
)
def test_another_boards_program_moves_nothing(there: BoardType, wrong: BoardType) -> None:
    build = programs(*PROGRAMS)
    bench = bench_of(Board(there, BUILD / "lockstep" / "lockstep.so", build / "firmware" / f"{wrong.name}.elf"))
    bench.model.battery_volts = 5.0  # also a potentiometer that allows all
    bench.run(30)
    bench.configure(level_max=255)
    bench.drive(0, 0)
    for level in (255, -255):
        bench.drive(level, level, 60)
        assert bench.wheels().left_pwm_counts == level
    assert peaks(bench.board) == [0, 0]
    bench.board.close()


@pytest.mark.parametrize("type_", MEGAS, ids=NAMES)
def test_no_count_is_lost_while_pwm_changes(type_: BoardType) -> None:
    """10 000 counts a second of each wheel. No interrupt has to wait for the two bytes of a compare register."""
    bench = bench_of(open_board(type_, Implementation.AVR, changing_pwm(*NAMES)))
    bench.model.battery_volts = 3.0
    drives = set()
    for _ in range(1000):
        bench.model.motor[LEFT].position += 10 * STATES_PER_TICK
        bench.model.motor[RIGHT].position -= 10 * STATES_PER_TICK
        bench.run(1)
        drives.add(bench.duties())
    bench.run(30)
    assert len(drives) > 80
    assert (bench.wheels().left_ticks, bench.wheels().right_ticks) == (10_000, -10_000)
    assert bench.wheels().battery_adc_counts == pytest.approx(614, abs=1)
    bench.board.close()


@pytest.mark.parametrize(
    ("type_", "fault", "inputs", "forth", "back"),
    [
        (MEGA_L298N_BOARD, "inputs_high", IN2, 0, -100),
        (MEGA_L298N_BOARD, "inputs_low", IN1, 0, -100),
        (MEGA_L298N_BOARD, "inputs_high", PWM, 255, -255),
        (MEGA_BTS7960_BOARD, "inputs_low", RPWM, 0, -100),
        (MEGA_BTS7960_BOARD, "inputs_low", R_EN, 0, 0),
        (MEGA_BTS7960_BOARD, "inputs_high", LPWM, -155, -255),
    ],
)
def test_a_fault_of_an_input_is_that_of_the_driver(
    type_: BoardType, fault: str, inputs: int, forth: int, back: int
) -> None:
    programs(*PROGRAMS)
    bench = bench_of(open_board(type_, Implementation.AVR))
    bench.configure(level_max=255)
    bench.drive(0, 0)
    setattr(bench.model.motor[RIGHT], fault, inputs)
    for level, given in ((100, forth), (-100, back)):
        bench.drive(level, level, 40)
        assert bench.duties() == (level, given)
    bench.board.close()

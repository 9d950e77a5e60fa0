"""Ardros's board: servo pulses, edges that are gathered, and a potentiometer that limits the level."""

import itertools
import math
from collections.abc import Iterator
from itertools import pairwise

import msgspec
import pytest

from giraff_schemas.boards import ARDROS_BOARD, MEGA_L298N_BOARD, BoardType
from giraff_schemas.wire import COMMAND_TIMEOUT_MS, DriveState, EstopFrame, Latch, Refusal, SpeedFlag, WheelsFrame
from giraff_sim.board import Implementation, open_board
from tests.firmware.bench import BaseBench, SpeedBench
from tests.firmware.builds import compiled
from tests.support.report import report
from tests.support.robots import ROBOT

FRAME_MS = 20  # of the servo pulses
LINE_MS = 3  # within which a drive frame has come over the line and acted
NEUTRAL_US, SPAN_US = 1500, 500
STATES_PER_TICK = 2
ARDROS = msgspec.structs.replace(ROBOT, ticks_per_metre=81_350.0, max_wheel_speed=0.8)


@pytest.fixture
def ardros(implementation: Implementation) -> Iterator[BaseBench]:
    """Ardros's board, powered on and measuring."""
    compiled()
    bench = BaseBench(open_board(ARDROS_BOARD, implementation))
    bench.run(35)
    yield bench
    bench.board.close()


@pytest.fixture
def board_type() -> BoardType:
    """Boards whose wheels roll, unless a test names others."""
    return ARDROS_BOARD


@pytest.fixture
def rolling(implementation: Implementation, board_type: BoardType) -> Iterator[SpeedBench]:
    """The same with wheels that turn by what the driver gives them."""
    compiled()
    bench = SpeedBench(open_board(board_type, implementation), ARDROS)
    bench.run(35)
    yield bench
    bench.board.close()


def pulses(ardros: BaseBench) -> tuple[float, float]:
    left, right = ardros.model.motor
    return left.pulse_us, right.pulse_us


def turn(ardros: BaseBench, states: tuple[float, float]) -> None:
    """Turn both wheels by so many quadrature states within the next millisecond."""
    for motor, by in zip(ardros.model.motor, states, strict=True):
        motor.position += by
    ardros.run(1)


def ticks(ardros: BaseBench) -> tuple[int, int]:
    ardros.run(30)
    return ardros.wheels().left_ticks, ardros.wheels().right_ticks


def true_ticks(ardros: BaseBench) -> tuple[int, int]:
    left, right = ((motor.states + 1) // STATES_PER_TICK for motor in ardros.model.motor)
    return left, right


@pytest.mark.parametrize("levels", [(255, -255), (1, -1), (-100, 50)])
def test_a_level_is_a_pulse_and_off_is_neutral(ardros: BaseBench, levels: tuple[int, int]) -> None:
    """A driver without pulses would go on at the last one."""
    assert pulses(ardros) == pytest.approx((NEUTRAL_US, NEUTRAL_US), abs=1)
    ardros.configure(level_max=255)
    ardros.drive(0, 0)
    ardros.drive(*levels, 60)
    assert pulses(ardros) == pytest.approx([NEUTRAL_US + SPAN_US * level / 255 for level in levels], abs=1)
    ardros.send(ardros.drive_frame(0, 0))
    ardros.run(LINE_MS + FRAME_MS + 2)
    assert pulses(ardros) == pytest.approx((NEUTRAL_US, NEUTRAL_US), abs=1)
    assert ardros.duties() == (0, 0)


def test_before_the_first_neutral_pulse_both_lines_are_low(ardros: BaseBench) -> None:
    """A line that rises earlier, until the timer has its pin, is a short pulse: full speed backward."""
    assert [motor.drive_peak for motor in ardros.model.motor] == [0, 0]


def test_battery_and_potentiometer_are_measured_in_turn(ardros: BaseBench) -> None:
    ardros.model.battery_volts, ardros.model.limit_volts = 3.0, 0.0
    ardros.run(60)
    for _ in range(4):
        ardros.run(10)
        assert ardros.wheels().battery_adc_counts == pytest.approx(614, abs=1)


def test_a_time_out_gives_neutral(ardros: BaseBench) -> None:
    ardros.configure()
    ardros.drive(0, 0)
    ardros.drive(70, 70, 60)
    ardros.run(COMMAND_TIMEOUT_MS - 20 + LINE_MS + FRAME_MS + 2)
    assert pulses(ardros) == pytest.approx((NEUTRAL_US, NEUTRAL_US), abs=1)
    ardros.run(20)
    assert ardros.wheels().drive_state == DriveState.COMMAND_TIMEOUT


def test_a_reset_gives_silence_and_then_neutral(ardros: BaseBench) -> None:
    ardros.configure(level_max=255)
    ardros.drive(0, 0)
    ardros.drive(255, 255, 60)
    ardros.board.reset()
    ardros.run(4)
    assert pulses(ardros) == pytest.approx((NEUTRAL_US, NEUTRAL_US), abs=1)
    for _ in range(100):
        ardros.run(1)
        assert ardros.duties() == (0, 0)


@pytest.mark.parametrize("hertz", [500, 10_000])
def test_a_wheel_that_trembles_on_an_edge_stands(ardros: BaseBench, hertz: int) -> None:
    before = ticks(ardros)
    now_us = ardros.now_ms * 1000
    for swing in range(400):
        now_us += 500_000 // hertz
        for motor in ardros.model.motor:
            motor.position = 0.5 + (swing + 1) % 2
        ardros.board.run(now_us)
    ardros.now_ms = math.ceil(now_us / 1000)
    assert all(abs(now - then) <= 1 for now, then in zip(ticks(ardros), before, strict=True))
    assert true_ticks(ardros) in ((0, 0), (1, 1))


@pytest.mark.parametrize(("forth_us", "back_us", "edges"), [(2000, 1000, 8), (3000, 1000, 14)])
def test_a_wheel_that_rattles_unevenly_stands(ardros: BaseBench, forth_us: int, back_us: int, edges: int) -> None:
    """Slowly forth and fast back, 0.1 or 0.17 mm at its rim: within a millisecond most edges may have one direction."""
    period_us, step_us, begun_us = forth_us + back_us + 7, 200, ardros.now_ms * 1000
    for now_us in range(begun_us + step_us, begun_us + 500_000, step_us):
        within_us = (now_us - begun_us) % period_us
        way = min(within_us / forth_us, (period_us - within_us) / back_us, 1.0)
        for motor in ardros.model.motor:
            motor.position = 0.5 + way * edges * STATES_PER_TICK
        ardros.board.run(now_us)
    ardros.now_ms = begun_us // 1000 + 500
    assert ticks(ardros) == pytest.approx(true_ticks(ardros), abs=8), "an interrupt comes late now and then"


def test_reversals_are_counted_to_the_edge(ardros: BaseBench) -> None:
    """Three swings of both wheels, of up to 60 000 edges a second, each at its own pace."""
    for millisecond in range(900):
        swing = 2 * math.pi * millisecond / 300
        turn(ardros, (120 * math.sin(swing), -100 * math.sin(swing * 1.1)))
    assert ticks(ardros) == true_ticks(ardros)


@pytest.mark.parametrize("board_type", [ARDROS_BOARD, MEGA_L298N_BOARD], ids=lambda board: board.name)
def test_60_000_edges_a_second_of_each_wheel_are_counted_while_the_line_is_full(
    rolling: SpeedBench, implementation: Implementation
) -> None:
    """The board holds speeds and tells of them all the while."""
    speeds = 60_000 / ARDROS.ticks_per_metre, 59_820 / ARDROS.ticks_per_metre  # at which edges meet in many ways
    noise = EstopFrame(seq=0, boot_id=0, board_ms=0, session=0, engage=0)  # refused: of no boot
    awake: list[float] = []
    room = rolling.model.rx_free

    def fill_the_line() -> None:
        awake.append(rolling.model.awake)
        if rolling.model.rx_free > room - 12:  # what the line takes in a millisecond
            rolling.send(noise)

    rolling.begin()
    rolling.go(0.0, 0.0)
    rolling.hands = [lambda _ms: speeds[0], lambda _ms: speeds[1]]
    rolling.go(*speeds, 200)
    rolling.go(*speeds, 2000, fill_the_line)
    told = rolling.all(WheelsFrame)[-200:]
    assert {wheels.drive_state for wheels in told} == {DriveState.ACTIVE}
    assert {(wheels.line_errors, wheels.latch) for wheels in told} == {(0, Latch.NONE)}
    assert told[-1].board_ms - told[0].board_ms == pytest.approx(1990, abs=2)  # none is missing
    for wheels in told:
        assert (wheels.left_um_s, wheels.right_um_s) == pytest.approx([speed * 1e6 for speed in speeds], rel=0.01)
    rolling.hands = [lambda _ms: 0.0, lambda _ms: 0.0]
    assert ticks(rolling) == true_ticks(rolling)
    if implementation is Implementation.AVR:
        report(
            f"{rolling.board.type.name}/edges",
            {"edges": true_ticks(rolling), "awake": round(sum(awake) / len(awake), 3)},
        )


def test_ticks_and_their_time_are_of_one_instant(rolling: SpeedBench) -> None:
    """The main loop reads them while the millisecond's interrupt may write."""
    hertz = 40_000
    speed = hertz / ARDROS.ticks_per_metre
    rolling.begin()
    rolling.hands = [lambda _ms: speed, lambda _ms: speed]
    rolling.go(speed, speed, 1200)
    told = rolling.all(WheelsFrame)[-100:]
    for before, after in itertools.pairwise(told):
        due = hertz * (after.board_us - before.board_us) / 1e6
        assert after.left_ticks - before.left_ticks == pytest.approx(due, abs=3)
        assert after.right_ticks - before.right_ticks == pytest.approx(due, abs=3)


def test_the_potentiometer_lowers_both_wheels_alike_and_raises_nothing(ardros: BaseBench) -> None:
    ardros.configure(level_max=200)
    ardros.drive(0, 0)
    for volts, asked, given in [
        (5.0, (200, -100), (200, -100)),
        (2.5, (200, -100), (100, -50)),
        (2.5, (80, -40), (80, -40)),
        (0.0, (80, -40), (0, 0)),
    ]:
        ardros.model.limit_volts = volts
        ardros.drive(*asked, 80)
        wheels = ardros.wheels()
        assert (wheels.left_pwm_counts, wheels.right_pwm_counts) == pytest.approx(given, abs=1)
        assert bool(wheels.speed_flags & SpeedFlag.AT_LIMIT) == (asked != given)
        assert (wheels.drive_state, wheels.refused) == (DriveState.ACTIVE, 0)


def test_a_potentiometer_that_is_turned_up_starts_nothing_at_once(ardros: BaseBench) -> None:
    """Its wiper's wire may break, too. Up to 0.6 m/s within a second, as base's own ramp."""
    ardros.configure(level_max=200)
    ardros.drive(0, 0)
    ardros.model.limit_volts = 0.0
    ardros.drive(200, -100, 60)
    ardros.model.limit_volts = 4.93
    levels = []
    for _ in range(55):
        ardros.drive(200, -100)
        levels.append(ardros.wheels().left_pwm_counts)
    assert levels[0] < 10
    assert all(0 <= after - before <= 5 for before, after in pairwise(levels))
    assert (levels[-1], ardros.wheels().right_pwm_counts) == (200, -100)
    assert not ardros.wheels().speed_flags


def test_a_limit_of_zero_makes_no_frame_one_that_opens(ardros: BaseBench) -> None:
    ardros.model.limit_volts = 0.0
    ardros.configure()
    ardros.drive(60, 60)
    assert ardros.wheels().drive_state == DriveState.AWAITING_ZERO
    assert ardros.wheels().last_refusal == Refusal.AWAITING_ZERO


def test_a_wheel_that_the_potentiometer_slows_is_not_held(rolling: SpeedBench) -> None:
    rolling.begin(0.6, 0.3)
    rolling.model.limit_volts = 2.5
    rolling.go(0.6, 0.3, 3000)
    assert rolling.wheels().drive_state == DriveState.ACTIVE
    assert rolling.wheels().speed_flags == SpeedFlag.AT_LIMIT
    assert rolling.speed == pytest.approx([0.4, 0.2], rel=0.03)

"""The base board's motors, encoders and battery, at its pins."""

import itertools

import pytest

from giraff_schemas.wire import WHEELS_PERIOD_MS, HelloFrame, HelloRequestFrame, WheelsFrame, Wiring
from tests.firmware.bench import BaseBench

STATES_PER_TICK = 2  # the board counts both edges of A: half of the quadrature states


def turn(base: BaseBench, encoder: int, states: float, milliseconds: int) -> None:
    """Turn one shaft evenly."""
    motor = base.model.motor[encoder]
    step = states / milliseconds
    for _ in range(milliseconds):
        motor.position += step
        base.run(1)


def test_a_reversal_goes_through_a_millisecond_without_pwm(base: BaseBench) -> None:
    base.start(60, -60)
    base.send(base.drive_frame(-60, 60))
    seen = []
    for _ in range(20):
        base.run(1)
        seen.append(base.duties())
    zero = seen.index((0, 0))
    assert set(seen[:zero]) == {(60, -60)}
    assert set(seen[zero + 1 :]) == {(-60, 60)}


def test_phase_never_turns_under_pwm(base: BaseBench) -> None:
    """The simulated bridge complains when it does."""
    base.start()
    levels = [0, 1, -1, 35, 70, -70, -35, 35, 0, -70]
    for left, right in itertools.product(levels, levels):
        base.drive(left, right)
    assert (base.model.errors, base.board.message) == (0, "")


@pytest.mark.parametrize(("encoder", "field"), [(0, "left_ticks"), (1, "right_ticks")])
@pytest.mark.parametrize("states", [4000, -4000])
def test_forward_counts_up_on_its_own_side(base: BaseBench, encoder: int, field: str, states: int) -> None:
    turn(base, encoder, states, 200)
    base.run(WHEELS_PERIOD_MS + 5)
    assert getattr(base.wheels(), field) == states / STATES_PER_TICK
    assert base.wheels().left_ticks + base.wheels().right_ticks == states / STATES_PER_TICK


@pytest.mark.parametrize(
    ("wiring", "ticks"),
    [
        (0, (100, 40)),
        (Wiring.SWAP_ENCODERS, (40, 100)),
        (Wiring.INVERT_LEFT_ENCODER, (-100, 40)),
        (Wiring.INVERT_RIGHT_ENCODER, (100, -40)),
        (Wiring.SWAP_ENCODERS | Wiring.INVERT_RIGHT_ENCODER, (40, -100)),
        (Wiring.SWAP_MOTORS | Wiring.INVERT_LEFT_MOTOR, (100, 40)),
    ],
)
def test_ticks_come_from_the_encoders_the_wiring_says(base: BaseBench, wiring: int, ticks: tuple[int, int]) -> None:
    base.configure(wiring=wiring)
    turn(base, 0, 200, 50)
    turn(base, 1, 80, 50)
    base.run(15)
    assert (base.wheels().left_ticks, base.wheels().right_ticks) == ticks


@pytest.mark.parametrize("levels", [(60, -30), (-20, 70)])
def test_each_wheels_level_is_told_as_its_own(base: BaseBench, levels: tuple[int, int]) -> None:
    base.start(*levels)
    assert (base.wheels().left_pwm_counts, base.wheels().right_pwm_counts) == levels


def test_20_000_edges_a_second_on_both_wheels_are_counted(base: BaseBench) -> None:
    for _ in range(2000):
        base.model.motor[0].position += 40
        base.model.motor[1].position -= 40
        base.run(1)
    base.run(15)
    assert (base.wheels().left_ticks, base.wheels().right_ticks) == (40_000, -40_000)


def test_telemetry_comes_100_times_a_second_without_a_gap(base: BaseBench) -> None:
    base.forget()
    base.run(1000)
    told = base.all(WheelsFrame)
    assert len(told) == 100
    assert {later.board_us - earlier.board_us for earlier, later in itertools.pairwise(told)} == {10_000}
    assert {later.board_ms - earlier.board_ms for earlier, later in itertools.pairwise(told)} == {10}
    assert {later.seq - earlier.seq for earlier, later in itertools.pairwise(told)} == {1}
    assert base.damaged == 0


def test_hello_is_said_again_on_request_and_takes_a_number_of_its_own(base: BaseBench) -> None:
    first = base.last(HelloFrame)
    base.forget()
    base.send(HelloRequestFrame(seq=1))
    base.run(30)
    assert base.last(HelloFrame).boot_id == first.boot_id
    numbers = [frame.seq for frame in base.frames]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))


@pytest.mark.parametrize(("volts", "counts"), [(0.0, 0), (2.5, 512), (4.0, 819), (5.0, 1023), (9.0, 1023)])
def test_the_battery_is_measured_against_5_volts(base: BaseBench, volts: float, counts: int) -> None:
    base.model.battery_volts = volts
    base.run(30)
    assert base.wheels().battery_adc_counts == counts

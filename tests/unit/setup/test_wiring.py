"""How a robot is wired follows from what one sees and counts, for every wiring there is."""

from typing import Literal

import pytest

from giraff_schemas.wire import Latch, Wiring
from giraff_setup.wheels.wiring import (
    SIDES,
    Counted,
    DoubtError,
    MotorResponse,
    encoder_that_counted,
    require_both_ways,
    require_right,
    wiring_of,
)

TICKS = 400


def seen(wiring: Wiring, motor: int) -> MotorResponse:
    """What motor 0 (A) or 1 (B) does with nothing swapped or inverted, on a robot that is soldered like `wiring`."""
    wheel = motor ^ int(Wiring.SWAP_MOTORS in wiring)
    side = SIDES[wheel].upper()
    forward = Wiring[f"INVERT_{side}_MOTOR"] not in wiring
    counts_up = forward != (Wiring[f"INVERT_{side}_ENCODER"] in wiring)
    counted = [1, -2]
    counted[wheel ^ int(Wiring.SWAP_ENCODERS in wiring)] = TICKS if counts_up else -TICKS
    return MotorResponse(Counted(*counted), SIDES[wheel], forward)


@pytest.mark.parametrize("bits", range(64))
def test_every_wiring_is_found(bits: int) -> None:
    wiring = Wiring(bits)
    fields = wiring_of(seen(wiring, 0), seen(wiring, 1))
    assert fields == {bit.name.lower(): bit in wiring for bit in Wiring if bit.name is not None}


GOOD = seen(Wiring(0), 0)
OTHER = seen(Wiring(0), 1)
NOTHING = Counted(0, 1)


def said(counted: Counted, wheel: Literal["left", "right", "both", "none"]) -> MotorResponse:
    return MotorResponse(counted, wheel, forward=True)


@pytest.mark.parametrize(
    ("first", "second", "told"),
    [
        (GOOD, said(OTHER.counted, "left"), "both motors are said to turn the left wheel"),
        (GOOD, said(GOOD.counted, "right"), "the left encoder counted for both motors"),
        (said(NOTHING, "left"), OTHER, "the left wheel turned and no encoder counted; check the encoder's plug"),
        (said(NOTHING, "none"), OTHER, "nothing turned; check battery"),
        (said(GOOD.counted, "none"), OTHER, "the left encoder counted, and no wheel is said to have turned"),
        (said(GOOD.counted, "both"), OTHER, "one motor turned both wheels"),
        (GOOD, said(Counted(300, 310), "right"), r"both encoders counted \(300 left, 310 right\)"),
        (GOOD, said(Counted(-60, 310), "right"), "both encoders counted"),
    ],
)
def test_what_makes_no_sense_is_in_doubt(first: MotorResponse, second: MotorResponse, told: str) -> None:
    with pytest.raises(DoubtError, match=told):
        wiring_of(first, second)


@pytest.mark.parametrize(
    ("counted", "encoder"),
    [((9, 0), None), ((-10, 2), "left"), ((2, -12), "right"), ((39, 400), "right"), ((0, 0), None)],
)
def test_a_wheel_that_trembles_on_an_edge_has_not_turned(counted: tuple[int, int], encoder: str | None) -> None:
    assert encoder_that_counted(Counted(*counted)) == encoder


def test_a_finer_encoder_counts_more_before_its_wheel_has_turned() -> None:
    assert encoder_that_counted(Counted.at(400, 0, 81_350.0)) is None
    assert encoder_that_counted(Counted.at(410, 0, 81_350.0)) == "left"
    assert Counted.at(0, 0, 2002.0).fewest == Counted(0, 0).fewest


@pytest.mark.parametrize("counted", [(-TICKS, 0), (0, TICKS), (0, 0), (TICKS, TICKS)])
def test_the_proof_takes_ticks_of_the_right_wheel_forward_only(counted: tuple[int, int]) -> None:
    require_right("left", Counted(TICKS, 1))
    with pytest.raises(DoubtError):
        require_right("left", Counted(*counted))


@pytest.mark.parametrize(
    ("backward", "latch"),
    [
        (Counted(0, 0), Latch.NONE),
        (Counted(TICKS, 0), Latch.NONE),
        (Counted(0, -TICKS), Latch.NONE),
        (Counted(-TICKS // 3, 0), Latch.NONE),
        (Counted(-TICKS, 0), Latch.LEFT_STUCK),
    ],
)
def test_a_wheel_that_does_not_turn_backward_as_well_is_in_doubt(backward: Counted, latch: Latch) -> None:
    require_both_ways("left", Counted(TICKS, 0), Counted(-TICKS, 1), Latch.NONE)
    with pytest.raises(DoubtError, match="the left wheel turns forward and not backward as well"):
        require_both_ways("left", Counted(TICKS, 0), backward, latch)

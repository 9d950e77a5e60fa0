"""Motors and gains that a drive of two wheels tells, and which of two drives is better."""

from collections.abc import Callable
from typing import Final

import pytest

from giraff_base.drives.wheels.config import SpeedControl
from giraff_schemas.messages import Wheels
from giraff_setup.wheels.speed.fit import CannotTellError, Follow, Motor, fastest, identify, legs_of, propose
from giraff_setup.wheels.speed.report import tell_drive, tell_fastest
from tests.support.driven_wheels import MOTORS, TICKS, drive


def measure(heard: list[Wheels]) -> list[Motor]:
    return [identify(leg) for leg in legs_of(heard, (TICKS, TICKS))]


def test_the_model_is_found_and_the_rule_of_the_defaults_makes_the_gains() -> None:
    left, right = MOTORS
    "\n".join(tell_drive(legs_of(list(drive()), (TICKS, TICKS)), dots=False)).encode("ascii")
    for found, motor in zip(measure(list(drive())), (left, left, right, right), strict=True):
        assert found.per_count == pytest.approx(motor.per_count, rel=0.04)
        assert found.time == pytest.approx(motor.time, rel=0.05)
    usual = Motor(per_count=0.6 / 70.0, time=0.15, dead=0.0)
    proposal = propose([usual] * 4, SpeedControl())
    assert not proposal.changes(SpeedControl()), "the defaults follow from the motor that they are for"
    assert fastest([usual], 70, 1.0) == pytest.approx(0.6)
    assert "does 0.48 m/s at max_level 70" in tell_fastest(fastest([usual], 70, 1.25), 0.6, 70, battery_known=True)
    assert not tell_fastest(0.57, 0.6, 70, battery_known=True)
    assert propose([Motor(0.00001, 0.9, 0.0)] * 4, SpeedControl()).control.speed_p == 3900.0


CANNOT: Final[dict[str, tuple[Callable[[], list[Wheels]], str]]] = {
    "hardly excited": (lambda: list(drive(pace=0.03)), "check its encoder|does not tell its motor"),
    "a gap": (lambda: [each for at, each in enumerate(drive()) if not 40 < at < 60], "not heard all the way"),
    "another scale": (lambda: list(drive(ticks=1500.0)), "ticks_per_metre"),
    "one push all along": (lambda: list(drive(push=30)), "does not tell its motor"),
    "no way back": (lambda: list(drive())[:300], "got nothing on the way back"),
}


@pytest.mark.parametrize("case", CANNOT)
def test_a_drive_that_does_not_tell_proposes_nothing(case: str) -> None:
    heard, words = CANNOT[case]
    with pytest.raises(CannotTellError, match=words):
        measure(heard())


def test_measurements_that_disagree_propose_nothing() -> None:
    with pytest.raises(CannotTellError, match="by one measurement and"):
        propose([MOTORS[0]] * 3 + [Motor(0.0085, 0.9, 0.0)], SpeedControl())


@pytest.mark.parametrize(
    ("before", "after", "is_better"),
    [
        (Follow(0.05, 0.004), Follow(0.0, 0.004), True),
        (Follow(0.05, 0.004), Follow(0.0, 0.005), False),
        (Follow(0.05, 0.004), Follow(0.045, 0.0), False),
        (Follow(0.05, 0.004), Follow(0.05, 0.004), False),
        (Follow(0.0, 0.055), Follow(0.003, 0.002), True),  # gains that were too weak
        (Follow(0.0, 0.055), Follow(0.011, 0.002), False),
    ],
)
def test_a_drive_is_better_by_more_than_noise_and_worse_in_nothing_felt(
    before: Follow, after: Follow, *, is_better: bool
) -> None:
    assert after.beats(before) == is_better

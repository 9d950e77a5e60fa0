"""Drawn robots of the robot files, on a drive of ten seconds each, and faults of Ardros and of a RoboClaw's robot."""

from typing import Final

import pytest

from giraff_base.drives.wheels.config import WheelControl
from tests.dst import test_ardros, test_roboclaw
from tests.loop.drawn import creep, require_sound
from tests.support.report import report

DRAWN: Final = {"ardros": 20, "mega_l298n": 10, "mega_bts7960": 10, "roboclaw": 20}
PLAYED: Final = {"ardros": test_ardros.played, "roboclaw": test_roboclaw.played}


@pytest.mark.parametrize(("name", "seed"), [(name, seed) for name, many in DRAWN.items() for seed in range(many)])
def test_a_drawn_robot_does_what_it_is_asked_and_knows_where_it_is(name: str, seed: int) -> None:
    report(f"campaign/{name}_{seed}", require_sound(name, seed)._asdict())


@pytest.mark.parametrize("first", range(0, 100, 25))
@pytest.mark.parametrize("name", PLAYED)
def test_no_seed_violates_an_invariant(name: str, first: int) -> None:
    assert {seed: found for seed in range(first, first + 25) if (found := PLAYED[name](seed).violations)} == {}


@pytest.mark.parametrize("name", test_roboclaw.ROWS)
def test_a_fault_stops_each_of_ten_drawn_robots_with_a_roboclaw(name: str) -> None:
    report(f"campaign/roboclaw_{name}", {str(seed): test_roboclaw.require_stopped(name, seed) for seed in range(10)})


@pytest.mark.parametrize("control", ["level", "speed"])
@pytest.mark.parametrize("seed", range(DRAWN["roboclaw"]))
def test_a_slow_robot_is_not_taken_for_one_that_something_holds(control: WheelControl, seed: int) -> None:
    creep("roboclaw", seed, control)

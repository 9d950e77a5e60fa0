"""Drawn robots of the robot files, on a drive of ten seconds each, and a hundred seeds of faults of Ardros."""

from typing import Final

import pytest

from tests.dst.test_ardros import played
from tests.loop.drawn import require_sound
from tests.support.report import report

DRAWN: Final = {"ardros": 20, "mega_l298n": 10, "mega_bts7960": 10}


@pytest.mark.parametrize(("name", "seed"), [(name, seed) for name, many in DRAWN.items() for seed in range(many)])
def test_a_drawn_robot_does_what_it_is_asked_and_knows_where_it_is(name: str, seed: int) -> None:
    report(f"campaign/{name}_{seed}", require_sound(name, seed)._asdict())


@pytest.mark.parametrize("first", range(0, 100, 25))
def test_no_seed_violates_an_invariant(first: int) -> None:
    assert {seed: found for seed in range(first, first + 25) if (found := played(seed).violations)} == {}

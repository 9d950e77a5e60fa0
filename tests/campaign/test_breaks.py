"""Seeks the first seed in which each staged break is found: to be put into tests/dst/breaks.py when seeds change."""

from __future__ import annotations

import pytest

from giraff_sim.dst.drill import draw, play
from tests.dst.breaks import BREAKS, Break
from tests.dst.stage import SETTINGS, rules

SEEDS = 200


@pytest.mark.parametrize("broken", BREAKS, ids=lambda broken: broken.name)
def test_a_break_is_found_within_two_hundred_seeds(broken: Break) -> None:
    build = broken.build()
    outcomes = (rules(play(draw(seed), SETTINGS, broken.services, build)) for seed in range(SEEDS))
    found = next((seed for seed, outcome in enumerate(outcomes) if broken.rule in outcome), None)
    print(f"{broken.name}: seed {found}")
    assert found is not None

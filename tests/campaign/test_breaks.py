"""Seeks the first seed in which each staged break is found: to be put into tests/dst/breaks.py when seeds change."""

import pytest

from giraff_sim.dst.scenarios import draw
from giraff_sim.dst.simulated_run import play
from tests.dst.breaks import BREAKS, Break
from tests.dst.stage import SETTINGS, rules

SEEDS = 200


def first_seed(broken: Break) -> int | None:
    """The first seed whose run violates the rule that the break is to violate."""
    build = broken.build()
    outcomes = (rules(play(draw(seed), SETTINGS, broken.services, build)) for seed in range(SEEDS))
    return next((seed for seed, outcome in enumerate(outcomes) if broken.rule in outcome), None)


@pytest.mark.parametrize("broken", BREAKS, ids=lambda broken: broken.name)
def test_each_break_is_found_within_two_hundred_seeds(broken: Break) -> None:
    found = first_seed(broken)
    assert found is not None
    assert found == broken.seed, "tests/dst/breaks.py names another seed"

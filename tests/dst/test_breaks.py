"""Sixteen ways to break what the robot does, each found by the judge in a drawn run."""

import pytest

from giraff_sim.dst.scenarios import draw
from giraff_sim.dst.simulated_run import play
from tests.dst.breaks import BREAKS, Break
from tests.dst.stage import SETTINGS, rules


@pytest.mark.parametrize("broken", BREAKS, ids=lambda broken: broken.name)
def test_a_break_is_found(broken: Break) -> None:
    outcome = play(draw(broken.seed), SETTINGS, broken.services, broken.build(), until_rules=broken.rule)
    assert broken.rule in rules(outcome), outcome.violations

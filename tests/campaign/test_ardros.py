"""Twenty drawn Ardros robots on a drive of ten seconds each, and a hundred seeds of faults."""

import pytest

from tests.dst.test_ardros import played
from tests.loop.ardros import require_sound
from tests.support.report import report


@pytest.mark.parametrize("seed", range(20))
def test_a_drawn_ardros_does_what_it_is_asked_and_knows_where_it_is(seed: int) -> None:
    report(f"campaign/ardros_{seed}", require_sound(seed)._asdict())


@pytest.mark.parametrize("first", range(0, 100, 25))
def test_no_seed_violates_an_invariant(first: int) -> None:
    assert {seed: found for seed in range(first, first + 25) if (found := played(seed).violations)} == {}

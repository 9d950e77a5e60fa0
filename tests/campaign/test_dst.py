"""Two thousand seeds of the deterministic simulation."""

import os
from collections.abc import Iterator
from typing import Final

import msgspec
import pytest

from giraff_sim.dst.many import Totals, run_many, run_one
from giraff_sim.dst.simulated_run import SECONDS
from tests.support.report import report

SEEDS: Final = 2_000
"""From 0 on: those of tests/dst too, and then fresh ones."""
LEG: Final = 50
"""Seeds of one test."""
ONCE_FAILED: Final = (5031, 5640, 70098, 80504, 80657, 80958)
"""Robot or judge was wrong about them. Each still draws the faults of that time, and none is among the others."""


@pytest.fixture(scope="module")
def totals() -> Iterator[Totals]:
    """The sum over all legs that ran; the robot must have driven in most of their seeds."""
    made = Totals()
    yield made
    report("campaign/dst", msgspec.to_builtins(made) | {"counts": dict(sorted(made.counts.items()))})
    assert made.drove >= 0.9 * made.seeds


@pytest.mark.parametrize("first", range(0, SEEDS, LEG))
def test_no_seed_violates_an_invariant(first: int, totals: Totals) -> None:
    failed = len(totals.failures)
    for outcome in run_many(range(first, first + LEG), os.cpu_count() or 1):
        totals.add(outcome, SECONDS)
    assert totals.failures[failed:] == []


@pytest.mark.parametrize("seed", ONCE_FAILED)
def test_what_once_failed_does_not_fail_again(seed: int) -> None:
    assert run_one(seed).violations == ()

"""The same seed is the same run, to the byte, in whatever process."""

from __future__ import annotations

from giraff_sim.dst.many import run_many

SEEDS = range(8)


def test_another_process_makes_no_difference() -> None:
    """Each process has hashes of its own: nothing may hang on the order of a set."""
    here, there = (tuple(run_many(SEEDS, jobs)) for jobs in (1, 2))
    assert here == there

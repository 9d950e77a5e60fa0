"""The same seed is the same run, to the byte, in whatever process."""

from __future__ import annotations

from giraff_sim.dst.drill import draw, play
from giraff_sim.dst.many import run_many
from tests.dst.stage import SETTINGS

SEEDS = range(3)
SECONDS = 8.0


def test_a_seed_played_again_is_the_same() -> None:
    for seed in SEEDS:
        first, second = (play(draw(seed, SECONDS), SETTINGS) for _ in range(2))
        assert first == second
        assert first.story


def test_another_seed_is_another_run() -> None:
    digests = {play(draw(seed, SECONDS), SETTINGS).digest for seed in SEEDS}
    assert len(digests) == len(SEEDS)


def test_another_process_makes_no_difference() -> None:
    """Each process has hashes of its own: nothing may hang on the order of a set."""
    here, there = (tuple(run_many(SEEDS, jobs)) for jobs in (1, 2))
    assert here == there

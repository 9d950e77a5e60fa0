"""The same seed is the same run, to the byte; in another process too, says `tests/campaign/test_staged.py`."""

from __future__ import annotations

from giraff_sim.dst.drill import play
from giraff_sim.dst.scenarios import draw
from tests.dst.stage import SETTINGS

SEEDS = range(2)
SECONDS = 5.0


def test_a_seed_played_again_is_the_same_and_another_is_not() -> None:
    outcomes = [[play(draw(seed, SECONDS), SETTINGS) for _ in range(2)] for seed in SEEDS]
    for first, second in outcomes:
        assert first == second
        assert first.story
    assert len({first.digest for first, _ in outcomes}) == len(SEEDS)

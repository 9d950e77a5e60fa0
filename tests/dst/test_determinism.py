"""The same seed is the same run, to the byte; in another process too, says `tests/campaign/test_staged.py`."""

from giraff_sim.dst.scenarios import draw
from giraff_sim.dst.simulated_run import play
from tests.dst.stage import SETTINGS

SECONDS = 5.0


def test_a_seed_played_again_is_the_same_and_another_is_not() -> None:
    first, again, other = (play(draw(seed, SECONDS), SETTINGS) for seed in (0, 0, 1))
    assert first == again
    assert first.events
    assert first.motion_digest != other.motion_digest
    assert first.event_digest != other.event_digest

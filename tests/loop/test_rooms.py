"""Cluttered rooms by verdicts alone, in simulated time: a part of what tests/campaign/test_rooms.py does."""

import pytest

from tests.loop.rooms import crossings, has_way
from tests.sim.robots import proving_room

ROOM = 7
"""One with a short way."""
NO_WAY = 2
"""A room without one."""


def test_whoever_follows_the_verdicts_gets_through() -> None:
    crossed = crossings((ROOM, NO_WAY))
    assert crossed.keys() == {ROOM}
    lost = {seed: crossing.why for seed, crossing in crossed.items() if not crossing.reached}
    print(f"{sum(crossing.contacts for crossing in crossed.values())} contacts")
    assert lost == {}
    assert sum(crossing.towards_an_echo for crossing in crossed.values()) == 0


@pytest.mark.parametrize(("gap", "way"), [(1.3, True), (1.0, False)])
def test_the_truth_knows_a_gap_that_is_wide_enough(gap: float, way: bool) -> None:
    room = proving_room(half=6.0)
    room.add_wall("left", [(-6.0, 2.5), (2.5 - gap / 2.0, 2.5)])
    room.add_wall("right", [(2.5 + gap / 2.0, 2.5), (6.0, 2.5)])
    assert has_way(room) is way

"""Cluttered rooms by verdicts alone, in simulated time: a part of what tests/campaign/test_rooms.py does."""

from __future__ import annotations

import pytest

from tests.loop.rooms import crossings, has_way
from tests.sim.robots import proving_room

ROOMS = range(12)


def test_whoever_follows_the_verdicts_gets_through() -> None:
    crossed = crossings(ROOMS)
    lost = {seed: crossing.why for seed, crossing in crossed.items() if not crossing.reached}
    contacts = sum(crossing.contacts for crossing in crossed.values())
    print(f"{len(crossed)} of {len(ROOMS)} rooms have a way; {contacts} contacts in them")
    assert lost == {}
    assert len(crossed) >= len(ROOMS) // 2
    assert sum(crossing.towards_an_echo for crossing in crossed.values()) == 0


@pytest.mark.parametrize(("gap", "way"), [(1.3, True), (1.0, False)])
def test_the_truth_knows_a_gap_that_is_wide_enough(gap: float, way: bool) -> None:
    room = proving_room(half=10.0)
    room.add_wall("left", [(-10.0, 2.5), (2.5 - gap / 2.0, 2.5)])
    room.add_wall("right", [(2.5 + gap / 2.0, 2.5), (10.0, 2.5)])
    assert has_way(room) is way

"""Routes of many drawn robots through homes, with the real localization, and all faults of a route."""

import math
from collections import Counter

import pytest

from tests.loop.routes import Told, drive, goal_of, home
from tests.loop.test_routes import ROWS, stop_a_route

KINDS = {"sonars": (0.25, 15.0, 26), "scan": (0.12, 5.0, 29)}
"""m and degrees within which it has arrived, and how many of 30 must."""


@pytest.mark.parametrize("name", ROWS)
def test_a_fault_stops_a_route_within_its_bound_for_good(name: str) -> None:
    stop_a_route(ROWS[name])


def gone(world: str, sense: str, seed: int) -> Told:
    with home(world, sense, seed) as it:
        told = drive(it, seed, world, goal_of(it.floor, world, seed, it.truth))
    print(told)
    assert told.outcome != "arrived" or (told.off <= 0.5 and told.turned <= math.radians(30.0)), told
    assert told.fastest < 0.35, told
    return told


@pytest.mark.parametrize("sense", KINDS)
def test_it_arrives_in_the_furnished_flat(sense: str) -> None:
    off, turned, least = KINDS[sense]
    told = [gone("flat", sense, seed) for seed in range(1, 31)]
    there = [each for each in told if each.off <= off and each.turned <= math.radians(turned)]
    arrived = [each for each in there if each.outcome == "arrived"]
    assert len(arrived) >= least, Counter(each.outcome for each in told)
    assert not [each for each in told if any(touch > 0.15 for touch in each.touches)]
    assert sum(each.way for each in arrived) <= 1.25 * sum(each.shortest for each in arrived)


@pytest.mark.parametrize("sense", KINDS)
def test_in_a_home_of_equal_rooms_it_is_never_elsewhere_when_it_has_arrived(sense: str) -> None:
    for seed in range(1, 31):
        gone("twins", sense, seed)

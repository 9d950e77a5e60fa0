"""A thousand cluttered rooms, driven through by the verdicts alone."""

from collections.abc import Iterator

import pytest

from tests.loop.reaction import quantile
from tests.loop.rooms import WILD_SHARE, Crossing, crossings
from tests.support.report import report

ROOMS = 1000
LEG = 25
"""Rooms of one test."""


@pytest.fixture(scope="module")
def crossed() -> Iterator[dict[int, Crossing]]:
    """The crossings of all legs that ran, by seed, reported at their end."""
    made: dict[int, Crossing] = {}
    yield made
    seconds = [crossing.seconds for crossing in made.values()]
    figures = {
        "wild_share": WILD_SHARE,
        "rooms_with_a_way": len(made),
        "not_reached": {seed: crossing.why for seed, crossing in made.items() if not crossing.reached},
        "seconds_median": round(quantile(seconds, 0.5), 1),
        "seconds_max": round(max(seconds), 1),
        "contacts": sum(crossing.contacts for crossing in made.values()),
        "rooms_with_a_contact": sum(crossing.contacts > 0 for crossing in made.values()),
        "contacts_towards_an_echo": {seed: c.towards_an_echo for seed, c in made.items() if c.towards_an_echo},
    }
    report("campaign/rooms", figures)


@pytest.mark.parametrize("first", range(0, ROOMS, LEG))
def test_rooms(first: int, crossed: dict[int, Crossing]) -> None:
    leg = crossings(range(first, first + LEG))
    crossed |= leg
    assert {seed: crossing.why for seed, crossing in leg.items() if not crossing.reached} == {}
    assert {seed: crossing for seed, crossing in leg.items() if crossing.towards_an_echo} == {}

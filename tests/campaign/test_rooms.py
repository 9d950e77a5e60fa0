"""A thousand cluttered rooms, driven through by the verdicts alone."""

from __future__ import annotations

from tests.loop.reaction import quantile
from tests.loop.rooms import WILD_SHARE, crossings
from tests.support.report import report

ROOMS = 1000


def test_rooms() -> None:
    crossed = crossings(range(ROOMS))
    seconds = [crossing.seconds for crossing in crossed.values()]
    figures = {
        "wild_share": WILD_SHARE,
        "rooms": ROOMS,
        "rooms_with_a_way": len(crossed),
        "not_reached": {seed: crossing.why for seed, crossing in crossed.items() if not crossing.reached},
        "seconds_median": round(quantile(seconds, 0.5), 1),
        "seconds_max": round(max(seconds), 1),
        "contacts": sum(crossing.contacts for crossing in crossed.values()),
        "rooms_with_a_contact": sum(crossing.contacts > 0 for crossing in crossed.values()),
        "contacts_towards_an_echo": {seed: c.towards_an_echo for seed, c in crossed.items() if c.towards_an_echo},
    }
    report("campaign/rooms", figures)
    assert figures["not_reached"] == {}
    assert figures["contacts_towards_an_echo"] == {}

"""When a visit is due, by whose links are gone."""

from __future__ import annotations

import pytest

from giraff_node.network.link_repair import LostPeers, hosts_of

ROBOT, LAPTOP = "10.0.0.2", "10.0.0.3"
DELAY = 0.3
STEP = 0.1
BOTH = {"base": ROBOT, "guard": ROBOT}
ONE = {"base": ROBOT}


def visits(partings: LostPeers, links: dict[str, str], since: float, until: float) -> list[float]:
    """When visits were due."""
    times = [since + STEP * count for count in range(round((until - since) / STEP))]
    return [now for now in times if partings.look(now, links)]


@pytest.fixture
def partings() -> LostPeers:
    """Both have been linked for ten seconds."""
    partings = LostPeers(DELAY)
    assert visits(partings, BOTH, 0.0, 10.0) == []
    return partings


def test_who_is_lost_while_its_host_is_there_is_visited(partings: LostPeers) -> None:
    due = [10.3 + count for count in range(12)]
    assert visits(partings, ONE, 10.0, 40.0) == pytest.approx(due, abs=STEP)


def test_who_is_back_is_not_visited_any_more(partings: LostPeers) -> None:
    assert len(visits(partings, ONE, 10.0, 11.0)) == 1
    assert visits(partings, BOTH, 11.0, 20.0) == []


def test_who_is_back_before_the_first_visit_is_none(partings: LostPeers) -> None:
    assert visits(partings, ONE, 10.0, 10.2) == []
    assert visits(partings, BOTH, 10.2, 20.0) == []


def test_a_host_that_is_gone_is_not_visited(partings: LostPeers) -> None:
    assert visits(partings, {"watch": LAPTOP}, 10.0, 20.0) == []


def test_a_host_of_which_one_is_back_is_visited(partings: LostPeers) -> None:
    assert visits(partings, {}, 10.0, 12.0) == []
    assert visits(partings, ONE, 12.0, 13.0) == pytest.approx([12.0])


def test_a_visitor_may_leave(partings: LostPeers) -> None:
    assert visits(partings, BOTH | {"why": LAPTOP, "watch": LAPTOP}, 10.0, 11.5) == []
    assert visits(partings, BOTH | {"watch": LAPTOP}, 11.5, 20.0) == []


def test_the_host_of_a_link() -> None:
    links = [("base", "tcp/10.0.0.2:7447"), ("guard", "tls/[fe80::1]:40000"), ("own", "tcp/127.0.0.1:41111")]
    assert hosts_of(links) == {"base": "10.0.0.2", "guard": "[fe80::1]"}

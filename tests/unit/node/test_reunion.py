"""When a visit is due, by whose links are gone."""

from __future__ import annotations

from pathlib import Path

import pytest

from giraff_core.network import NetworkConfig
from giraff_node.network.link_repair import OWN_HOST, Link, LostPeers, delay_of, hosts_of, impostors
from giraff_node.network.session import INSIDE_ID_ENDS, Role, session_config

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


@pytest.mark.parametrize("role", ["inside", "outside"])
def test_a_visit_is_never_missed(tmp_path: Path, role: Role) -> None:
    """However long it took on a busy machine. Else one visit is the next one's reason."""
    network = NetworkConfig(sockets=str(tmp_path))
    for is_visit in (True, False):
        peer = session_config(network, "alpha", role, visits=is_visit).get("id", "c0ffee")
        met = LostPeers(DELAY)
        assert visits(met, BOTH | {peer: ROBOT}, 0.0, 10.0) == []
        assert bool(visits(met, BOTH, 10.0, 20.0)) is not is_visit


SOCKET = "unixsock-stream/here"
LINKS = [
    Link("base", "tcp/10.0.0.3:40001", "tcp/10.0.0.2:7447"),
    Link("guard", "tls/[fe80::2]:7448", "tls/[fe80::1]:40000"),
    Link("own", "tcp/127.0.0.1:7448", "tcp/127.0.0.1:41111"),
    Link("page", "tcp/10.0.0.3:7448", "tcp/10.0.0.3:41112"),
    Link("ranger", SOCKET, "unixsock-stream/there"),
]


def test_those_inside_do_not_all_visit_at_once() -> None:
    assert delay_of("10cafe" + INSIDE_ID_ENDS) < delay_of("f0cafe" + INSIDE_ID_ENDS)


def test_the_hosts_of_links() -> None:
    own = dict.fromkeys(("own", "page"), OWN_HOST)
    assert hosts_of(LINKS) == {"base": "10.0.0.2", "guard": "[fe80::1]"} | own


def test_of_its_own_host_who_is_inside_is_missed_and_nobody_else() -> None:
    page, base = "c0ffee", f"c0ffee{INSIDE_ID_ENDS}"
    for gone, due in ((page, False), (base, True)):
        partings = LostPeers(DELAY)
        visits(partings, dict.fromkeys((page, base, "door"), OWN_HOST), 0.0, 5.0)
        left = dict.fromkeys({page, base, "door"} - {gone}, OWN_HOST)
        assert bool(visits(partings, left, 5.0, 7.0)) is due


def test_a_peer_that_is_linked_at_a_socket_and_from_elsewhere_is_an_impostor() -> None:
    assert impostors([*LINKS, Link("ranger", "tcp/127.0.0.1:7448", "tcp/127.0.0.1:41114")]) == set()
    assert impostors([*LINKS, Link("ranger", "tcp/10.0.0.3:40002", "tcp/10.0.0.9:7450")]) == {"ranger"}

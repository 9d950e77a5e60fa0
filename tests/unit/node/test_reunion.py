"""When a visit is due, by whose links are gone."""

from pathlib import Path

import pytest

from giraff_core.network import NetworkConfig
from giraff_node.network.link_repair import OWN_HOST, Endpoint, Link, LostPeers, delay_of, endpoints_of, impostors
from giraff_node.network.session import INSIDE_ID_ENDS, Role, mark_of, session_config

NAME = "alpha"
ROBOT, LAPTOP = Endpoint("10.0.0.2", "tcp/10.0.0.2:7447"), Endpoint("10.0.0.3", "tcp/10.0.0.3:7448")
DELAY = 0.3
STEP = 0.1


def own(name: str, robot: str = NAME, ends: str = "00000080") -> str:
    """Return the id of a peer of a robot."""
    return f"{name}{mark_of(robot)}{ends}"


BASE, GUARD, WATCH = map(own, ("base", "guard", "watch"))
BOTH = {BASE: ROBOT, GUARD: ROBOT}
ONE = {BASE: ROBOT}


def visits(partings: LostPeers, links: dict[str, Endpoint], since: float, until: float) -> list[float]:
    """When visits were due."""
    times = [since + STEP * count for count in range(round((until - since) / STEP))]
    return [now for now in times if partings.update(now, links) is not None]


def met(links: dict[str, Endpoint]) -> LostPeers:
    """These have been linked for ten seconds."""
    partings = LostPeers(NAME, DELAY)
    assert visits(partings, links, 0.0, 10.0) == []
    return partings


@pytest.fixture
def partings() -> LostPeers:
    return met(BOTH)


def test_who_is_lost_while_its_host_is_there_is_visited(partings: LostPeers) -> None:
    due = [10.3 + count for count in range(12)]
    assert visits(partings, ONE, 10.0, 40.0) == pytest.approx(due, abs=STEP)


def test_a_visit_dials_where_the_lost_one_and_the_others_of_its_host_listen() -> None:
    lost, other = Endpoint(LAPTOP.host, "tcp/10.0.0.3:7449"), Endpoint(LAPTOP.host)
    partings = met(BOTH | {own("page"): lost, own("hand"): LAPTOP, WATCH: other})
    dialled = [partings.update(10.0 + STEP * count, BOTH | {own("hand"): LAPTOP, WATCH: other}) for count in range(5)]
    assert [each for each in dialled if each is not None] == [[LAPTOP.locator, lost.locator]]


def test_a_visit_dials_few_of_a_crowd() -> None:
    partings = met(
        BOTH | {own(f"{port}"): Endpoint(ROBOT.host, f"tcp/10.0.0.2:{port}") for port in range(20_000, 20_100)}
    )
    assert [len(partings.update(10.0 + after, BOTH) or ()) for after in (0.0, DELAY)] == [0, 16]


@pytest.mark.parametrize("stranger", ["c0ffee", own("page", "beta"), own("page")[:-1]])
def test_a_stranger_is_not_missed(stranger: str) -> None:
    """The ids of this robot's peers and hands have its mark."""
    assert visits(met(BOTH | {stranger: ROBOT}), BOTH, 10.0, 20.0) == []


def test_a_host_whose_peers_come_and_go_is_visited_every_ten_seconds() -> None:
    """On an open network anybody may take an id with the mark. Other hosts are visited as before."""
    partings = met(BOTH)
    made = []
    for count in range(20):
        since = 10.0 + 5.0 * count
        made += visits(partings, BOTH | {own(f"{count}"): ROBOT}, since, since + 4.0)
        made += visits(partings, BOTH, since + 4.0, since + 5.0)
    assert len(made) == pytest.approx(12 + 100 / 10, abs=1)
    hosts = BOTH | {WATCH: LAPTOP, own("hand"): LAPTOP}
    visits(partings, hosts, 110.0, 115.0)
    assert len(visits(partings, BOTH | {WATCH: LAPTOP}, 115.0, 120.0)) == 5


def test_who_is_back_is_not_visited_any_more(partings: LostPeers) -> None:
    assert len(visits(partings, ONE, 10.0, 11.0)) == 1
    assert visits(partings, BOTH, 11.0, 20.0) == []


def test_who_is_back_before_the_first_visit_is_none(partings: LostPeers) -> None:
    assert visits(partings, ONE, 10.0, 10.2) == []
    assert visits(partings, BOTH, 10.2, 20.0) == []


def test_a_host_that_is_gone_is_not_visited(partings: LostPeers) -> None:
    assert visits(partings, {WATCH: LAPTOP}, 10.0, 20.0) == []


def test_a_host_of_which_one_is_back_is_visited(partings: LostPeers) -> None:
    assert visits(partings, {}, 10.0, 12.0) == []
    assert visits(partings, ONE, 12.0, 13.0) == pytest.approx([12.0])


def test_a_visitor_may_leave(partings: LostPeers) -> None:
    assert visits(partings, BOTH | {own("why"): LAPTOP, WATCH: LAPTOP}, 10.0, 11.5) == []
    assert visits(partings, BOTH | {WATCH: LAPTOP}, 11.5, 20.0) == []


@pytest.mark.parametrize("role", ["inside", "door", "outside"])
def test_a_peer_of_the_robot_is_missed_and_a_visit_never(tmp_path: Path, role: Role) -> None:
    """However long it took on a busy machine. Else one visit is the next one's reason."""
    network = NetworkConfig(sockets=str(tmp_path))
    for is_visit in (True, False):
        peer = session_config(network, NAME, role, visits=is_visit)["id"]
        assert bool(visits(met(BOTH | {peer: ROBOT}), BOTH, 10.0, 20.0)) is not is_visit


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


def test_the_endpoints_of_links() -> None:
    """Who has dialled this process says nowhere where it listens."""
    here = {"own": Endpoint(OWN_HOST), "page": Endpoint(OWN_HOST)}
    assert (
        endpoints_of(LINKS)
        == {"base": Endpoint("10.0.0.2", "tcp/10.0.0.2:7447"), "guard": Endpoint("[fe80::1]")} | here
    )


def test_of_its_own_host_who_is_inside_is_missed_and_nobody_else() -> None:
    page, base, here = own("page"), own("base", ends=INSIDE_ID_ENDS), Endpoint(OWN_HOST)
    for gone, due in ((page, False), (base, True)):
        links = dict.fromkeys((page, base, "door"), here)
        partings = met(links)
        del links[gone]
        assert bool(visits(partings, links, 10.0, 12.0)) is due


def test_a_peer_that_is_linked_at_a_socket_and_from_elsewhere_is_an_impostor() -> None:
    assert impostors([*LINKS, Link("ranger", "tcp/127.0.0.1:7448", "tcp/127.0.0.1:41114")]) == set()
    assert impostors([*LINKS, Link("ranger", "tcp/10.0.0.3:40002", "tcp/10.0.0.9:7450")]) == {"ranger"}

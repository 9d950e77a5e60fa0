"""Reconnects to peers whose link is lost while their host is still reachable.

When a cable is cut for a second, some links between two hosts expire and some outlive it. Zenoh dials a peer that it
is told of, but only when that peer is news to the one who tells. Who is inside answers no multicast. So two services
stayed deaf to each other for good while others of their hosts were not. A visit is a second session for a moment. It
is news to everybody: through it both hear of each other, and dial. One visit of a host is enough. Over a slow cable
it holds up its own process for a tenth of a second and more, so base and guard leave it to the others.

Only this robot's own peers and hands are missed: their ids have its mark. Each visit costs all others a link for a
moment, so a host gets few of them. Strangers come and go, and on an open network one may forge the mark.
"""

import os
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Final, NamedTuple

import zenoh

from giraff_core.network import HAND_PORTS, NetworkConfig
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.session import INSIDE_ID_ENDS, Role, close_session, mark_of, open_session
from giraff_node.network.sockets import PROTOCOL
from giraff_node.network.tcp_options import set_tcp_options

_STAYS: Final = 2.0
"""s; who was linked for less is not missed. Commands are clients, and touch nobody but a door."""
_VISITS_EVERY: Final = 1.0  # s; the first may come before the other end has noticed
_MOST_VISITS: Final = 12
"""Visits of a host in a row."""
_NEXT_VISIT: Final = 10.0
"""s until a host that has had them may have one more."""
_MOST_DIALLED: Final = 16
"""Locators of one visit. A robot's host has fewer, and on an open network others may come and go there."""
_GIVES_UP: Final = 12.0
"""s; then it was ended, alone of its host. A program that is not ours may hold a dead link for 10 s."""
_LOOK: Final = 0.2  # s between looks
_SETTLES: Final = 5.0
"""s, more than a handshake may take (`open_timeout`): Zenoh sets options of its own when one ends."""
OWN_HOST: Final = "this host"
_OWN_PORTS: Final = {str(port) for port in HAND_PORTS}
_VISIT: Final = 0.7  # s; telling takes two round trips, dialling one more


class Endpoint(NamedTuple):
    """The host of a peer, and where it listens."""

    host: str
    locator: str = ""
    """Where it listens; empty: it has dialled this process."""


class _Peer(NamedTuple):
    endpoint: Endpoint
    since: float
    """s, monotonic. The moment from which on it is linked, or missed."""


class LostPeers:
    """Peers of a robot that have gone from a host where others still are."""

    def __init__(self, robot: str, delay: float) -> None:
        """`delay`: s from then to the first visit."""
        self._mark, self._delay = mark_of(robot), delay
        self._linked: dict[str, _Peer] = {}
        self._missed: dict[str, _Peer] = {}
        self._next = 0.0
        self._spent: dict[str, float] = {}
        """Host -> s at which it may have all its visits again."""

    def update(self, now: float, links: Mapping[str, Endpoint]) -> list[str] | None:
        """Return the locators that a visit dials, or None when none is due. `links`: by id of the peer; `now`: s.

        Of this process's own host only who is inside is missed: others come and go, and need nobody.
        """
        for peer in self._linked.keys() - links.keys():
            endpoint, since = self._linked.pop(peer)
            if now - since >= _STAYS and (endpoint.host != OWN_HOST or peer.endswith(INSIDE_ID_ENDS)):
                self._next = max(self._next, now + self._delay)
                self._missed[peer] = _Peer(endpoint, now)
        for peer, endpoint in links.items():
            if peer[: -len(INSIDE_ID_ENDS)].endswith(self._mark):
                self._linked.setdefault(peer, _Peer(endpoint, now))
                self._missed.pop(peer, None)
        self._missed = {peer: one for peer, one in self._missed.items() if now - one.since < _GIVES_UP}
        self._spent = {host: until for host, until in self._spent.items() if until > now}
        hosts = {endpoint.host for endpoint in links.values()} & {one.endpoint.host for one in self._missed.values()}
        hosts = {host for host in hosts if self._spent.get(host, now) <= now + (_MOST_VISITS - 1) * _NEXT_VISIT}
        if now < self._next or not hosts:
            return None
        self._next = now + _VISITS_EVERY
        self._spent |= {host: self._spent.get(host, now) + _NEXT_VISIT for host in hosts}
        endpoints = {one.endpoint for one in (*self._linked.values(), *self._missed.values())}
        return sorted({endpoint.locator for endpoint in endpoints if endpoint.host in hosts} - {""})[:_MOST_DIALLED]


class LinkRepair:
    """Looks after the links of a session: a dead one is let go, and visits are made, one at a time, in a thread."""

    def __init__(
        self,
        session: zenoh.Session,
        network: NetworkConfig,
        robot: str,
        visits: Role | None,
        on_impostor: Callable[[str], None] = lambda _: None,
    ) -> None:
        """`visits`: the role in which it does; None: it leaves that to others. `on_impostor` takes such a peer's id."""
        self._session, self._network, self._robot, self._visits = session, network, robot, visits
        self._on_impostor = on_impostor
        self._lost_peers = LostPeers(robot, delay_of(str(session.zid())))
        self._under_way: threading.Thread | None = None
        self._next = 0.0
        self._seen: object = None  # links and descriptors at the last look
        self._sets_until = 0.0

    def update(self, now: float) -> None:
        """In each turn; `now`: monotonic, s."""
        if now < self._next:
            return
        self._next = now + _LOOK
        found = [Link(str(link.zid), link.src, link.dst) for link in self._session.info.links()]
        self._set_options(now, found)
        for peer in impostors(found):
            self._on_impostor(peer)
        if self._visits is None:
            return
        dials = self._lost_peers.update(now, endpoints_of(found))
        if dials is not None and (self._under_way is None or not self._under_way.is_alive()):
            whom = (self._network, self._robot, self._visits, dials)
            self._under_way = threading.Thread(target=join_briefly, args=whom, name="visit", daemon=True)
            self._under_way.start()

    def _set_options(self, now: float, found: "list[Link]") -> None:
        """Set the kernel's options as long as a connection may be new: to look at each one takes ten calls."""
        try:
            seen = {*found}, os.listdir("/proc/self/fd")  # noqa: PTH208  it is asked often
        except OSError:  # a flood has taken all descriptors
            seen = None
        if seen is None or seen != self._seen:
            self._seen, self._sets_until = seen, now + _SETTLES
        if now < self._sets_until:
            set_tcp_options()


def join_briefly(network: NetworkConfig, robot: str, role: Role, dials: list[str]) -> None:
    """Join the network of `robot` for a moment, also at the locators `dials`."""
    try:
        session = open_session(network, robot, role, visits=True, dials=dials)
    except (zenoh.ZError, ConfigError):  # the next visit, or nobody, is told; this process is well without
        return
    time.sleep(_VISIT)
    close_session(session)


def delay_of(zid: str) -> float:
    """Return the s until the first visit of a session: one mends the links of all, so not all make theirs at once."""
    return int(zid[:2], 16) / 256 * _LOOK * 2  # the last digits of who is inside are all the same


class Link(NamedTuple):
    """Of a session to a peer, between two locators."""

    peer: str
    src: str
    dst: str


def endpoints_of(links: Iterable[Link]) -> dict[str, Endpoint]:
    """Return the endpoint of each peer whose link is no socket: "tcp/10.0.0.5:7447" is at 10.0.0.5."""
    found = ((peer, _host(src), _host(dst), "" if _is_own_port(src) else dst) for peer, src, dst in links)
    return {peer: Endpoint(OWN_HOST if host == own else host, locator) for peer, own, host, locator in found if host}


def _is_own_port(src: str) -> bool:
    """Tell whether this end of a link is at a port where hands listen: the other end has dialled."""
    return src.rpartition(":")[2] in _OWN_PORTS


def impostors(links: Iterable[Link]) -> set[str]:
    """Peers that are linked at a Unix socket and to another host as well, which is believed like the socket.

    A program of this host may have both a socket and a port: any user's, with Zenoh's own settings, does.
    """
    at_sockets, elsewhere = set[str](), set[str]()
    for peer, src, dst in links:
        if src.startswith(PROTOCOL):
            at_sockets.add(peer)
        elif _host(src) != _host(dst):
            elsewhere.add(peer)
    return at_sockets & elsewhere


def _host(locator: str) -> str:
    """Return the host of a locator; empty: a Unix socket."""
    return locator.partition("/")[2].rpartition(":")[0]

"""The Zenoh session of a process: table `[network]` of the robot file.

What the session says to Zenoh, and why, is in the files of `deploy/zenoh`: `peer.toml` for every network, one file
for each mode, `recorder.toml` for who records, `visit.toml` for a visit. Here this host's own endpoints, certificates
and rules are put in.
"""

import contextlib
import functools
import os
import re
import socket
import threading
import tomllib
import zlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any, Final, Literal

import msgspec
import zenoh

from giraff_core.access import access_control, with_inside, with_own_host
from giraff_core.network import NetworkConfig, addresses, door_ports, link_of, ports_of, with_port
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.key_bundle import CA_CERTIFICATE, HOST_CERTIFICATE, HOST_KEY, BundleError, read_bundle
from giraff_node.network.scouting import VISIT, find_doors
from giraff_node.network.sockets import PROTOCOL, own_socket, socket_folder
from giraff_node.network.tokens import find_tokens
from giraff_schemas.services import PLAY, ROBOTS_OWN
from giraff_schemas.topics import alive_key

_FILES: Final = Path(__file__).parents[1] / "zenoh"
_CLOSE_TIMEOUT: Final = 1.0  # s
_ANSWERS_WITHIN: Final = 0.3  # s in which a door tells who is there
_GIVES_UP: Final = 3.0  # s without an answer at any way; Zenoh goes on trying a process that hangs
_NEXT_WAY: Final = 0.3  # s until the next port of a door is tried, too

CERTIFICATES: Final = {
    "root_ca_certificate": CA_CERTIFICATE,
    "listen_certificate": HOST_CERTIFICATE,
    "listen_private_key": HOST_KEY,
    "connect_certificate": HOST_CERTIFICATE,
    "connect_private_key": HOST_KEY,
}
"""Zenoh's name -> file of the host's bundle, as `giraff keys host` makes it."""


Role = Literal["inside", "door", "outside", "apart", "client"]
"""What the network is to a process.

`inside`: a service that the robot's stopping depends on. It listens at Unix sockets alone and dials out.
`door`: the process of a host that others find, at the port of the rendezvous.
`outside`: listens at a port of its own; a hand, and whatever stays and is none of the robot's own.
`apart`: as a door, at a port of its own, too; a recording that is played beside a robot.
`client`: has one link, to a door, and hears all through it; a command, and a hand whose host cannot be dialled.

Who is inside believes what comes over a Unix socket. Zenoh judges a peer by its first link and then believes a second
one as well. So no peer may be linked in both ways: those inside meet each other at sockets, and no other peer has one.
"""

INSIDE_ID_ENDS: Final = "ffffffff"
"""Zenoh compares ids from their last digits on, and of two peers the greater dials: nobody can dial who is inside."""
_VISIT_ID_ENDS: Final = "00000001"
"""The least id: all others dial a visit."""
_OTHER_ID_ENDS: Final = "80"
"""Between both, and never zero: Zenoh leaves out last digits that are zero, and the mark would be somewhere else."""
_RETRIED: Final = "#exit_on_failure=false;retry_period_init_ms=500;retry_period_max_ms=1000"
# Bound before any link is made: a peer that hears of one with no address never dials it, not even when it has one.
_FIRST: Final = "#exit_on_failure=true"
_IS_TAKEN: Final = 50
"""ms until a port counts as taken. Zenoh would wait for it for good, and at 0 it never tries the rendezvous again."""


class NobodyError(Exception):
    """A client finds no door. The message says where it has looked."""


def session_config(
    network: NetworkConfig,
    robot: str,
    role: Role,
    *,
    records: bool = False,
    visits: bool = False,
    dials: Sequence[str] | None = None,
    port: int = 0,
    name: str = "peer",
) -> dict[str, Any]:
    """The Zenoh configuration of a process of `robot`, as nested dictionaries. Raises ConfigError.

    `port`: of its own, where it listens at one; 0: any. `records`: it hears what is no sample of ours. `visits`: it is
    gone in a moment, and leaves the sockets' rendezvous to those who stay. A session that waits for the rendezvous to
    become free does not come back from its close, either. `dials`: locators of a visit that dials nobody else than
    those and the network's own, and is dialled. `name`: part of its socket's.
    """
    more = {"client": role == "client", "recorder": records, "visit": dials is not None}
    config = settings("peer", network.mode, *(name for name, counts in more.items() if counts))
    listens, config["connect"]["endpoints"] = _endpoints(network, role, port, name, stays=not visits)
    config["connect"]["endpoints"] += dials or ()
    if listens:
        config["listen"]["endpoints"] = listens
    if port:
        config["listen"]["timeout_ms"] = _IS_TAKEN
    if role not in {"inside", "client"}:
        config["transport"]["link"]["protocols"].remove(PROTOCOL)
    if visits or role in {"inside", "door", "outside"}:
        mark, end = VISIT if visits else mark_of(robot), _VISIT_ID_ENDS if dials is not None else _id_end(role)
        config["id"] = f"{os.urandom(7).hex()}{mark}{end}".lstrip("0")
    if network.local or role in {"inside", "client"}:
        config["scouting"]["multicast"]["enabled"] = False
    if network.site:
        config["region_name"] = network.site
    if network.mode == "secured":
        keys = Path(network.keys)
        config["transport"]["link"]["tls"] |= certificates(keys)
        # Whose host this is matters only for what a router may say to it.
        me = _host_of(keys) if network.access.routers else ""
        config["access_control"] |= access_control(network.access, robot, me)
    if role == "inside":
        rules = config["access_control"] if network.mode == "secured" else {}
        config["access_control"] = with_inside(rules, is_split=network.is_split)
        # It dials a door, too, which may come later. Zenoh would wait for an answer of each before a first sample.
        config["scouting"]["delay"] = 0
    elif role == "client" and network.mode == "secured":
        config["access_control"] = with_own_host(config["access_control"])
    return config


def mark_of(robot: str) -> str:
    """Return what the ids of a robot's own peers and hands have before their last eight digits."""
    return f"{zlib.crc32(robot.encode()):0{len(VISIT)}x}"


def _id_end(role: Role) -> str:
    return INSIDE_ID_ENDS if role == "inside" else f"{os.urandom(3).hex()}{_OTHER_ID_ENDS}"


def open_session(
    network: NetworkConfig,
    robot: str,
    role: Role,
    *,
    records: bool = False,
    visits: bool = False,
    dials: Sequence[str] | None = None,
    name: str = "peer",
) -> zenoh.Session:
    """Join the network of `robot`. Raises `zenoh.ZError`, ConfigError and, of a client, NobodyError."""
    if network.session_file:
        return zenoh.open(zenoh.Config.from_file(network.session_file))
    if role == "client":
        return _open_client(network, robot, records=records)
    config = functools.partial(
        session_config, network, robot, role, records=records, visits=visits, dials=dials, name=name
    )
    *first, last = ports_of(network, role)
    for port in first:
        with contextlib.suppress(zenoh.ZError):  # somebody else listens there
            return _open(config(port=port))
    return _open(config(port=last))


def open_clients(network: NetworkConfig, robot: str, *, records: bool = False) -> Iterator[tuple[str, zenoh.Session]]:
    """Open one link to each door that answers, one after another. Raises ConfigError, and NobodyError at the first.

    Yields where it dialled, as Zenoh writes it, with the session.

    Where no address is given, the network is asked by multicast: for any robot where this host has no door, for one
    that is named also after this host's own, which need not hear it.
    """
    config = session_config(network, robot, "client", records=records)
    # A door before a process that others depend on.
    doors = sorted(config["connect"]["endpoints"], key=lambda way: way.startswith(PROTOCOL))
    is_met = False
    for door in doors:
        with contextlib.suppress(zenoh.ZError):
            session = _open_first(config, door_ports(door))
            if _is_foreign(network, door, session):
                close_session(session)
                continue
            yield door, session
            is_met = True
    if is_met and robot == "*":
        return
    if network.mode == "lan" and not network.local and not network.connect:
        met = [door for door in find_doors() if door.startswith(f"{link_of(network)}/")]
        with contextlib.suppress(zenoh.ZError):
            yield "", _open_first(config, met or doors)
            return
    if not is_met:
        raise NobodyError(", ".join(each.partition("/")[2] for each in doors))


def open_past_door(network: NetworkConfig, rendezvous: Path) -> zenoh.Session:
    """Link to a robot's processes on this very host, at their rendezvous. Raises ConfigError and `zenoh.ZError`.

    What base says comes over such a link from this host alone.
    """
    config = session_config(network, "*", "client")
    return _open(config | {"connect": config["connect"] | {"endpoints": [f"{PROTOCOL}/{rendezvous}"]}})


def _is_foreign(network: NetworkConfig, door: str, session: zenoh.Session) -> bool:
    """Tell whether a router answers at this host's own door, where nobody has named one: ROS 2 has its router there."""
    is_named = network.router or door in [way_to(network, address) for address in network.connect]
    return not is_named and bool(session.info.routers_zid())


def _open_client(network: NetworkConfig, robot: str, *, records: bool) -> zenoh.Session:
    """Link to the door at which the robot is heard, else to the first that answers."""
    first: zenoh.Session | None = None
    for _, session in open_clients(network, robot, records=records):
        if robot == "*" or _is_heard(session, robot):
            if first is not None:
                close_session(first)
            return session
        if first is None:
            first = session
        else:
            close_session(session)
    assert first is not None  # noqa: S101  else there was a NobodyError
    return first


def _is_heard(session: zenoh.Session, robot: str) -> bool:
    """Whether a part of the robot itself is; the door of this host need not be the robot's."""
    return any(
        token.service in (*ROBOTS_OWN, PLAY.name) for token in find_tokens(session, alive_key(robot), _ANSWERS_WITHIN)
    )


def _open_first(config: dict[str, Any], ways: Sequence[str]) -> zenoh.Session:
    """Link over the way that answers first; each is tried a moment after the one before. Raises `zenoh.ZError`.

    A port that somebody calls all the time takes nobody else in for seconds.
    """
    answers: SimpleQueue[zenoh.Session | BaseException] = SimpleQueue()
    open_ways = 0
    found: zenoh.Session | BaseException = zenoh.ZError("nobody answers")
    for way in (*ways, ""):
        if way:
            # No daemon: Zenoh aborts a process that ends while a session is being opened.
            threading.Thread(target=_try, args=(config, way, answers)).start()
            open_ways += 1
        with contextlib.suppress(Empty):
            while open_ways and isinstance(found, zenoh.ZError):
                found = answers.get(timeout=_NEXT_WAY if way else _GIVES_UP)
                open_ways -= 1
        if not isinstance(found, zenoh.ZError):
            break
    if open_ways:
        threading.Thread(target=_close_late, args=(answers, open_ways)).start()
    if isinstance(found, BaseException):
        raise found
    return found


def _try(config: dict[str, Any], way: str, answers: SimpleQueue[zenoh.Session | BaseException]) -> None:
    try:
        answers.put(_open(config | {"connect": config["connect"] | {"endpoints": [way]}}))
    except BaseException as error:  # noqa: BLE001  whoever waits for the answer raises it
        answers.put(error)


def _close_late(answers: SimpleQueue[zenoh.Session | BaseException], open_ways: int) -> None:
    """Close what the ways that are still tried come to."""
    for _ in range(open_ways):
        if not isinstance(late := answers.get(), BaseException):
            close_session(late)


def _open(config: dict[str, Any]) -> zenoh.Session:
    return zenoh.open(zenoh.Config.from_json5(msgspec.json.encode(config).decode()))


def _endpoints(network: NetworkConfig, role: Role, port: int, name: str, *, stays: bool) -> tuple[list[str], list[str]]:
    """Where a process listens, and whom it dials. Raises ConfigError."""
    dials = [way_to(network, address) for address in addresses(network)]
    listens = _ports(network, role, port)
    if role not in {"inside", "client"}:
        return listens, dials
    try:
        folder = socket_folder(network)
    except ConfigError:
        if role != "client":
            raise
        return [], dials  # a door may answer all the same, and a robot be stopped there
    meeting = f"{PROTOCOL}/{folder}/rendezvous"
    dials.insert(0, meeting)
    if role == "client":
        return [], dials
    listens.insert(0, f"{PROTOCOL}/{own_socket(folder, name)}{_FIRST}")
    if stays:
        listens.append(f"{meeting}{_RETRIED}")  # last: after a taken one nothing is bound in time
    return listens, dials


def way_to(network: NetworkConfig, address: str) -> str:
    """Return an address as Zenoh dials it, which knows an interface by its number alone: fe80::1%2."""
    return f"{link_of(network)}/{re.sub(r'(?<=%)[^]]+', _number_of, with_port(address))}"


def _number_of(interface: re.Match[str]) -> str:
    try:
        return str(socket.if_nametoindex(interface[0]))
    except OSError:  # a number already, or none of this host: nobody answers, and doctor says why
        return interface[0]


def _ports(network: NetworkConfig, role: Role, port: int) -> list[str]:
    """Where other hosts reach this process."""
    link, own_port = link_of(network), f"127.0.0.1:{port}" if network.local else _at_all(f":{port}")
    own = [f"{link}/{own_port}{_FIRST}"]
    if role in {"door", "apart"}:
        door = with_port(network.rendezvous)
        at_door = [door] if network.local else map(_at_all, door_ports(door))
        return [*(own if role == "apart" else []), *(f"{link}/{address}{_RETRIED}" for address in at_door)]
    return own if role == "outside" or network.is_split else []


def _at_all(address: str) -> str:
    """Return the port of an address at all addresses of this host: others are to reach it."""
    return f"0.0.0.0:{address.rpartition(':')[2]}"


def close_session(session: zenoh.Session, within: float = _CLOSE_TIMEOUT) -> bool:
    """Leave the network; False when Zenoh does not come back from it: its close can hang, the process must not."""

    leave: Callable[[], object] = session.close

    def close() -> None:
        with contextlib.suppress(zenoh.ZError):  # it has given up by itself: nothing else is left to do
            leave()

    closing = threading.Thread(target=close, daemon=True)
    closing.start()
    closing.join(within)
    return not closing.is_alive()


def settings(*names: str) -> dict[str, Any]:
    """What these files of `deploy/zenoh` say; the later ones count before the earlier ones."""
    read = (tomllib.loads((_FILES / f"{name}.toml").read_text(encoding="utf-8")) for name in names)
    return functools.reduce(_merged, read)


def _merged(common: dict[str, Any], special: dict[str, Any]) -> dict[str, Any]:
    """Both; where both have a table, its fields together."""
    merged = {**common}
    for name, value in special.items():
        ours = common.get(name)
        merged[name] = _merged(ours, value) if isinstance(ours, dict) and isinstance(value, dict) else value
    return merged


def certificates(folder: Path) -> dict[str, str]:
    """A host's bundle, as Zenoh takes it. Raises ConfigError: Zenoh's own word would be that no link comes about."""
    for name in sorted(set(CERTIFICATES.values())):
        path = folder / name
        try:
            path.read_bytes()
        except OSError as error:
            raise ConfigError(
                f"{path}: {error.strerror}; the network is secured: put this host's bundle of `giraff keys host` there"
            ) from error
    return {field: os.fsencode(folder / name).decode(errors="replace") for field, name in CERTIFICATES.items()}


def _host_of(folder: Path) -> str:
    """The name in the certificate of this host's bundle. Raises ConfigError."""
    try:
        return read_bundle(folder).name
    except BundleError as error:
        raise ConfigError(
            f"{error}; [network.access] has routers, and what one may say depends on the host: "
            "make its bundle again with `giraff keys host --renew`"
        ) from error


LEASE: Final = settings("peer")["transport"]["link"]["tx"]["lease"] / 1000
"""s without a word after which a link is dead."""

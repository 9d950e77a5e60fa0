"""Listens to one robot on the network: its samples, and which of its services are there."""

import contextlib
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Final, Literal, Protocol

import msgspec
import zenoh

from giraff_core.network import NetworkConfig, addresses
from giraff_node import robot_now_ns
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.session import NobodyError, close_session, open_clients, open_past_door, way_to
from giraff_node.network.sockets import live_rendezvous
from giraff_node.network.tokens import Token, find_tokens, watch_tokens
from giraff_schemas.codec import DecodeError, decode
from giraff_schemas.messages import Sample
from giraff_schemas.services import BASE, WEB
from giraff_schemas.topics import CAMERA_PICTURES, ROOT, TOPICS, Topic, alive_key, key_of
from giraff_tools.network.pages import PageKeeper
from giraff_tools.network.topic_keys import is_declared

_ASK_AGAIN: Final = 0.1  # s
_ANY_NETWORK: Final = NetworkConfig()
_MOST_WAITING: Final = 20_000  # reports, 40 s of them; a listener that stands still longer loses the oldest
_SHOWN: Final = 16  # bytes

Form = Literal["MessagePack", "JSON", "bytes"]


class Undeclared(msgspec.Struct, frozen=True):
    """A sample of a key that the topics table does not have."""

    content: Any
    """Return the number of `bytes` and the first ones."""
    form: Form


class MovedError(Exception):
    """The network is another than when the visit began: this host has other addresses, or somebody is there at last."""


class Listener(Protocol):
    """Takes what a connection hears."""

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """A sample of `key` (below the robot's name), which `topic` is or stands for, heard at `at_ns`."""

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """A service's token on the network has come or gone."""


Report = Callable[[Listener], None]
"""Tells a listener of one thing that was heard."""


class RobotConnection:
    """What Zenoh's threads hear waits in a queue, so that the listener has one thread."""

    def __init__(
        self,
        robot: str,
        session: zenoh.Session,
        filed: str = "",
        network: NetworkConfig = _ANY_NETWORK,
        waited: float | None = None,
    ) -> None:
        """`session`: of this connection alone, which closes it, on `network`."""
        self.waited = waited
        """s in which no door was found. The session is then one that waits to be met; None: it hears all."""
        self.robot = robot
        self.stands_in_for = ""
        """The robot that a file has named, where this host's simulation stands in for it; empty: it does not."""
        self.filed = filed
        """The name in the robot file of the current folder, where nobody has named one; it counts if it is heard."""
        self.session = session
        self.network = network
        self._heard: deque[Report] = deque(maxlen=_MOST_WAITING)
        self._declared: dict[str, Any] = {}  # by key; a subscriber that nobody references ends
        self._others: list[zenoh.Session] = []
        self._dialled: set[str] = set()  # doors, as Zenoh writes them
        self._looking: threading.Thread | None = None
        self.own_host: list[zenoh.Session] = []
        """Sessions past the door. They hear `estop` from the robot of this very host alone."""
        self._is_closed = False
        self._pages = PageKeeper()
        self._complaints: dict[str, tuple[int, str]] = {}
        """Of each key: when (robot's clock), what."""

    def find_duplicate(self, patience: float) -> str | None:
        """The liveliness token of a base that already runs under this robot's name; looks for `patience` s."""
        deadline = time.monotonic() + patience
        while time.monotonic() < deadline:
            if tokens := find_tokens(self.session, alive_key(self.robot, BASE.name), patience):
                return alive_key(*tokens[0])
            time.sleep(_ASK_AGAIN)
        return None

    def subscribe_all(self, topics: Iterable[Topic[Any]] = TOPICS) -> None:
        """Hear these topics of the robot, and its services come and go.

        Pictures are left out: they go to those alone who ask for them.
        """
        for topic in topics:
            if topic not in CAMERA_PICTURES:
                self.subscribe(topic)
        self._declared[alive_key(self.robot)] = watch_tokens(self.session, self.robot, self._on_token)

    def subscribe(self, topic: Topic[Any]) -> None:
        """Hear this topic of the robot, too."""
        key = key_of(self.robot, topic)
        self._declared[key] = self.session.declare_subscriber(key, self._hearer(topic))

    def unsubscribe(self, topic: Topic[Any]) -> None:
        """Hear it no longer."""
        self._declared.pop(key_of(self.robot, topic)).undeclare()

    def dispatch(self, listener: Listener) -> None:
        """Tell `listener` what was heard since the last call. Raises MovedError."""
        if self.waited is not None and next(iter(self.session.info.peers_zid()), None) is not None:
            raise MovedError
        with contextlib.suppress(IndexError):  # Zenoh's threads fill it: emptiness cannot be asked first
            while True:
                self._heard.popleft()(listener)

    @property
    def decode_errors(self) -> list[str]:
        """What could not be decoded, the newest of each key."""
        return self.complaints_since(0)

    def complaints_since(self, at_ns: int) -> list[str]:
        """The same, of what came after `at_ns`."""
        return [complaint for when_ns, complaint in list(self._complaints.values()) if when_ns >= at_ns]

    def ask_page(self) -> None:
        """Ask where the robot's pages are, and keep it for a stop that Zenoh does not bring about."""
        self._pages.ask(self.session, self.robot)

    def open_other_doors(self, on_door: Callable[[zenoh.Session], object]) -> None:
        """Open a link to each other door that answers: robots behind one need not be heard at another.

        It takes seconds where an address is silent, so it is done in a thread, which calls `on_door`.
        """
        if self.waited is None and not self.network.session_file and len(addresses(self.network)) > 1:
            self._looking = threading.Thread(target=self._open_other_doors, args=(on_door,), daemon=True)
            self._looking.start()

    def open_own_host(self) -> list[threading.Thread]:
        """Begin to link to the robot of this very host past its door, by threads that end. They fill `own_host`."""
        with contextlib.suppress(ConfigError):  # this user may ask none
            ways = live_rendezvous(self.network)
            threads = [threading.Thread(target=self._open_past_door, args=(way,), daemon=True) for way in ways]
            for thread in threads:
                thread.start()
            return threads
        return []

    def _open_past_door(self, rendezvous: Path) -> None:
        with contextlib.suppress(ConfigError, zenoh.ZError):
            session = open_past_door(self.network, rendezvous)
            if self._is_closed:
                close_session(session)
            else:
                self.own_host.append(session)

    @property
    def is_looking(self) -> bool:
        """Whether a door may still answer of which nobody knows."""
        return self._looking is not None and self._looking.is_alive()

    def unreached(self, given: Iterable[str]) -> list[str]:
        """Return the addresses at which no door has answered `open_other_doors`."""
        return [each for each in given if way_to(self.network, each) not in self._dialled]

    def _open_other_doors(self, on_door: Callable[[zenoh.Session], object]) -> None:
        known = _doors(self.session)
        with contextlib.suppress(NobodyError, ConfigError):
            for door, session in open_clients(self.network, "*"):
                self._dialled.add(door)
                if self._is_closed or _doors(session) <= known:
                    close_session(session)
                else:
                    known |= _doors(session)
                    self._others.append(session)
                    on_door(session)

    def close(self, within: float = 1.0) -> bool:
        """Leave the network; False when Zenoh does not come back from it, after `within` s."""
        self._is_closed = True
        closed = [close_session(session, within) for session in (self.session, *self._others, *self.own_host)]
        self._pages.wait(within)
        return all(closed)

    def _hearer(self, topic: Topic[Any]) -> Callable[[zenoh.Sample], None]:
        declared = is_declared(topic)

        def on_sample(received: zenoh.Sample) -> None:
            now_ns = robot_now_ns()
            key = str(received.key_expr)
            payload, encoding = bytes(received.payload), str(received.encoding)
            try:
                sample: Any = decode(topic, key, payload, encoding) if declared else read_undeclared(payload, encoding)
            except DecodeError as error:
                self._complaints[key] = now_ns, str(error)
                return
            below = key.removeprefix(f"{ROOT}/{self.robot}/")
            self._heard.append(lambda listener: listener.on_sample(topic, below, sample, now_ns))

        return on_sample

    def _on_token(self, token: Token, present: bool) -> None:
        if present and token.service == WEB.name:
            self._heard.append(lambda _: self.ask_page())
        self._heard.append(lambda listener: listener.on_liveliness(token.service, token.instance, present=present))


def read_undeclared(payload: bytes, encoding: str) -> Undeclared:
    """Content of a payload, read by its encoding, or else by what it looks like."""
    readers: list[tuple[Form, str, Callable[[bytes], Any]]] = [
        ("JSON", "/json", msgspec.json.decode),
        ("MessagePack", "/msgpack", msgspec.msgpack.decode),
    ]
    named = [reader for reader in readers if reader[1] in encoding]
    for form, _, read in named or readers:
        with contextlib.suppress(msgspec.MsgspecError, ValueError, RecursionError, TypeError, OverflowError):
            content = read(payload)
            msgspec.json.encode(content)  # else no tool could show it
            if named or isinstance(content, (dict, list)):
                return Undeclared(content, form)
    start = payload[:_SHOWN]
    text = start.decode(errors="replace")
    return Undeclared({"bytes": len(payload), "start": text if text.isprintable() else start.hex(" ")}, "bytes")


def _doors(session: zenoh.Session) -> set[str]:
    return {str(zid) for zid in (*session.info.peers_zid(), *session.info.routers_zid())}

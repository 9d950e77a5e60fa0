"""What every service shares: configuration, session, typed topics, liveliness, health, a loop and a clean end.

with Node("guard", GuardConfig) as node:
    node.run(Guard(node, node.config, node.robot))
"""

import contextlib
import os
import socket
import sys
import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Generic, Self

import zenoh

from giraff_core.io import MOST_REQUESTS, Inbox, Paced, PendingQuery, Selectable, SerialPort, Service
from giraff_core.network import NetworkConfig
from giraff_core.parameters.server import ParameterServer
from giraff_core.parameters.table import ConfigT, Parameters
from giraff_node import robot_now_ns
from giraff_node.config.robot_file import ConfigError
from giraff_node.config.settings import Settings
from giraff_node.network.base_reach import BaseReach, WrongRobotCheck
from giraff_node.network.host_addresses import AddressWatch, host_addresses, placed_addresses
from giraff_node.network.key_bundle import ExpiryWatch
from giraff_node.network.link_repair import LinkRepair
from giraff_node.network.query_client import QueryClient
from giraff_node.network.router_link import RouterLink
from giraff_node.network.session import NobodyError, Role, open_session
from giraff_node.network.subscription import PolledInbox, Reader
from giraff_node.process.lifecycle import Process
from giraff_node.process.state import Folder, state_directory
from giraff_schemas.codec import DecodeError, decode_request, encode, encoding_of, stamped
from giraff_schemas.frames import Transform
from giraff_schemas.health import Health, WebPage
from giraff_schemas.params import ParamAnswer
from giraff_schemas.services import BASE, DOOR, GUARD, SERVICES
from giraff_schemas.topics import (
    PARAM_DESCRIBE,
    PARAM_SAVE,
    PARAM_SET,
    ROOT,
    AnswerT,
    Query,
    RequestT,
    SampleT,
    Topic,
    alive_key,
    frame_key,
    health_key,
    key_of,
)
from giraff_schemas.trouble import Trouble

if TYPE_CHECKING:  # imported where they are used: most services have neither a board nor pictures
    from giraff_node.boards.board_link import BoardLink
    from giraff_node.network.bulk_session import BulkPublisher, BulkSession
    from giraff_schemas.boards import BoardType

_STEADY = (BASE.name, GUARD.name)  # nothing that may hold them up for longer than a turn is done in these
_MOST_NAMED = 10  # robots; on an open network anybody may declare a name
_PRIORITIES = {"control": zenoh.Priority.REAL_TIME, "state": zenoh.Priority.DATA_HIGH}


class Publisher(Generic[SampleT]):
    """Stamps and publishes the samples of one topic. Never blocks: what cannot be sent at once is dropped."""

    def __init__(self, session: zenoh.Session, robot: str, topic: Topic[SampleT], instance: str) -> None:
        """`instance`: of the maker."""
        self._instance = instance
        self._seq = 0
        self._publisher = session.declare_publisher(
            key_of(robot, topic),
            encoding=encoding_of(topic.schema),
            congestion_control=zenoh.CongestionControl.DROP,
            priority=_PRIORITIES[topic.qos],
            express=topic.qos == "control",
        )

    def put(self, sample: SampleT) -> None:
        self._publisher.put(encode(stamped(sample, self._seq, time.time_ns(), self._instance)))
        self._seq += 1


class _Query(Generic[RequestT, AnswerT]):
    """One request of somebody, waiting for its answer."""

    def __init__(self, query: zenoh.Query, request: RequestT) -> None:
        self._query = query
        self.request = request

    def answer(self, answer: AnswerT) -> None:
        with self._query as query:
            query.reply(query.key_expr, encode(answer), encoding=encoding_of(type(answer)))


def _role_of(service: str, network: NetworkConfig) -> Role:
    if service == DOOR.name:
        return "door"
    if any(row.name == service and row.inside for row in SERVICES):
        return "inside"
    return "client" if network.client else "outside"


class Node(Generic[ConfigT]):
    """One service's process, and the `IO` of its turns. `service` names its table and its liveliness token."""

    def __init__(
        self,
        service: str,
        config: type[ConfigT] | Settings[ConfigT],
        *,
        records: bool = False,
        session: zenoh.Session | None = None,
    ) -> None:
        """`config`: the type of its table, which is then loaded, or what is known without a robot file.

        `records`: it hears what is no sample of ours (`session_config`).
        `session`: one on this network, which this closes in the end; None: it opens its own.
        """
        self.service = service
        self._process = Process(service)  # before the session: opening it takes a moment
        self.log, self.instance = self._process.log, self._process.instance
        self.hostname = socket.gethostname()
        try:
            filed, self.robot, network = config if isinstance(config, Settings) else Settings.load(service, config)
            self.network, self.is_open = network, network.is_open
            role = _role_of(service, network)
            told = role in {"door", "outside"} and not network.local and not network.session_file
            self._look_at_addresses = placed_addresses if role == "door" else host_addresses
            self._addresses = AddressWatch(self._look_at_addresses(), every=role == "door") if told else None
            self.session = session or open_session(network, self.robot.name, role, records=records, name=service)
        except NobodyError as error:
            self.log.error("no door of the robot answers at %s; it is looked for again at the next start", error)
            sys.exit(1)
        except ConfigError as error:
            self.log.error("%s", error)
            sys.exit(2)
        except zenoh.ZError as error:
            self.log.error("no Zenoh session: %s; check the table [network] of the robot file", error)
            sys.exit(2)
        self._params = Parameters(service, filed, self.robot)
        self.store = Folder(state_directory(self.robot.name), self._process.wake)
        self._server = ParameterServer(service, self.instance, self.hostname, self._params, self.store, self.log.info)
        self._server.on_set = self._tell_set
        self.set_fault("params", self._server.fault)
        self.lost_parameters = self._server.lost
        self.on_reconfigured: Callable[[Any], None] | None = None
        secured = network.mode == "secured" and not network.session_file
        self._keys = ExpiryWatch(Path(network.keys)) if secured else None
        routed = network.router and not network.local and not network.session_file
        self._router = RouterLink(network.router, network.site, self._sees_router) if routed else None
        own = network.local or network.session_file
        visits = role if role in {"inside", "outside"} and service not in _STEADY else None
        watch = self._on_impostor if role == "inside" and not network.is_split else lambda _: None
        self._link_repair = (
            None if network.session_file else LinkRepair(self.session, network, self.robot.name, visits, watch)
        )
        is_deaf = role == "outside" and session is None and not own
        self._base_reach = BaseReach(self.session, network, self.robot.name) if is_deaf else None
        # On a secured network a session may speak of its own robot alone.
        is_open = network.mode != "secured" and not network.session_file
        self._wrong_robot = (
            WrongRobotCheck(self.session, network, self.robot.name, self.instance)
            if is_open and session is None
            else None
        )
        self._bulk: BulkSession | None = None
        self._boards: list[BoardLink] = []
        self._declared: list[Any] = []  # a subscriber that nobody references ends

    @property
    def config(self) -> ConfigT:
        """What is in force: another object once a parameter was set."""
        return self._params.config

    def __enter__(self) -> Self:
        self._declared.append(
            self.session.declare_queryable(health_key(self.robot.name, self.service), self._on_health_query)
        )
        # Before the token: whoever finds the service in the graph may ask it.
        look = self._process.wake_loop
        self._describes = self._requests(PARAM_DESCRIBE.at(self.service), look)
        self._sets = self._requests(PARAM_SET.at(self.service), look)
        self._saves = self._requests(PARAM_SAVE.at(self.service), look)
        self._declared.append(
            self.session.liveliness().declare_token(alive_key(self.robot.name, self.service, self.instance))
        )
        self.log.info("robot %s, instance %s, pid %d", self.robot.name, self.instance, os.getpid())
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bulk is not None:
            self._bulk.close()
        self._process.end(self.session, kind, error, trace)

    def publisher(self, topic: Topic[SampleT]) -> "Publisher[SampleT] | BulkPublisher[SampleT]":
        self._process.condition.publishes.append(topic.key)
        if topic.qos == "bulk":
            from giraff_node.network.bulk_session import BulkPublisher, BulkSession  # noqa: PLC0415

            if self._bulk is None:
                self._bulk = BulkSession(self.network, self.robot.name, lambda told: self.set_notice("door", told))
            return BulkPublisher(self._bulk, self.robot.name, topic, self.instance)
        return Publisher(self.session, self.robot.name, topic, self.instance)

    def inbox(self, topic: Topic[SampleT], limit: int = 200, *, wakes: bool = True) -> Inbox[SampleT]:
        """Each sample of a topic, or the newest with a `limit` of 1; its arrival makes a turn due, if it `wakes`."""
        if not wakes:
            polled = PolledInbox(limit, self._reader(topic))
            polled.subscriber = self.session.declare_subscriber(key_of(self.robot.name, topic), polled.ring)
            return polled
        inbox: Inbox[SampleT] = Inbox(limit)

        def take_and_wake(sample: SampleT) -> None:
            inbox.accept(sample)
            self._process.wake()

        self.subscribe(topic, take_and_wake)
        return inbox

    def subscribe(self, topic: Topic[SampleT], callback: Callable[[SampleT], None]) -> None:
        """Call `callback` with each sample, in Zenoh's thread: it must be quick. If it raises, the process ends."""
        read = self._reader(topic).read

        def on_sample(received: zenoh.Sample) -> None:
            if (sample := read(received)) is None:
                return
            try:
                callback(sample)
            except Exception as error:  # noqa: BLE001  Zenoh would print and forget it; here it ends the process
                self.fail(error)

        self._declared.append(self.session.declare_subscriber(key_of(self.robot.name, topic), on_sample))

    def _reader(self, topic: Topic[SampleT]) -> Reader[SampleT]:
        self._process.condition.subscribes.append(topic.key)
        return Reader(topic, key_of(self.robot.name, topic), self.set_notice)

    def requests(self, query: Query[RequestT, AnswerT]) -> Inbox[PendingQuery[RequestT, AnswerT]]:
        """What is asked of this service, for its turns to answer; its arrival makes one due."""
        return self._requests(query, self._process.wake)

    def _requests(
        self, query: Query[RequestT, AnswerT], wake: Callable[[], None]
    ) -> Inbox[PendingQuery[RequestT, AnswerT]]:
        inbox: Inbox[PendingQuery[RequestT, AnswerT]] = Inbox(MOST_REQUESTS)
        key = key_of(self.robot.name, query)

        def on_query(asked: zenoh.Query) -> None:
            try:
                payload = None if asked.payload is None else bytes(asked.payload)
                request = decode_request(query, str(asked.key_expr), payload, str(asked.encoding))
            except DecodeError as error:
                with asked:
                    asked.reply_err(str(error))
                return
            inbox.accept(_Query(asked, request))
            wake()

        self._process.condition.answers.append(query.key)
        self._declared.append(self.session.declare_queryable(key, on_query))
        return inbox

    def frame(self, child: str, where: Transform | Callable[[], Transform | None]) -> None:
        """As `IO.frame`; of one that moves, by a call in Zenoh's thread."""
        key = frame_key(self.robot.name, child)

        def on_query(asked: zenoh.Query) -> None:
            with asked:
                if (transform := where() if callable(where) else where) is not None:
                    asked.reply(key, encode(transform), encoding=encoding_of(Transform))

        self._process.condition.answers.append(key.removeprefix(f"{ROOT}/{self.robot.name}/"))
        self._declared.append(self.session.declare_queryable(key, on_query))

    def ask(
        self, query: Query[RequestT, AnswerT], request: RequestT, settles: Callable[[AnswerT], bool | str]
    ) -> QueryClient[RequestT, AnswerT]:
        return QueryClient(self.session, self.robot.name, query, request, settles)

    def board(self, path: str, board: "BoardType") -> "BoardLink":
        from giraff_node.boards.board_link import BoardLink  # noqa: PLC0415

        self._boards.append(link := BoardLink(path, board))
        return link

    def serial(self, path: str, baud: int) -> SerialPort:
        from giraff_node.boards.byte_link import ByteLink  # noqa: PLC0415

        return ByteLink(path, baud, self.robot_ns)

    def monotonic(self) -> float:
        return time.monotonic()

    def robot_ns(self) -> int:
        return robot_now_ns()

    def token(self) -> int:
        return int.from_bytes(os.urandom(4), sys.byteorder) or 1

    def leave(self) -> None:
        self._process.leave()

    def run(self, service: Service, *, prompt: bool = False) -> None:
        """Turn until SIGTERM or SIGINT; raises what a callback raised.

        `prompt`: turns are short, and a sample's own thread makes the turn that its arrival makes due.
        """
        for now in self.turns(*service.timers, link=service.link, prompt=service.turn if prompt else None):
            service.turn(now)
        service.end()

    def turns(
        self, *timers: Paced, link: Selectable | None = None, prompt: Callable[[float], None] | None = None
    ) -> Iterator[float]:
        """Yield the monotonic time (s) whenever a timer may be due, the link is readable or an inbox was filled.

        A board is due when a frame of it is there. `prompt`: as of `Process.turns`.

        Ends on SIGTERM or SIGINT, and raises what a callback raised.
        """
        return self._process.turns(*timers, link=link, boards=self._boards, look=self._update, prompt=prompt)

    def set_fault(self, name: str, trouble: Trouble) -> None:
        """State what is wrong with `name` of this service itself, or with NO_TROUBLE that nothing is.

        Logged on a change, told by health, which is then not `ok`.
        """
        self._process.condition.set_fault(name, trouble)

    def set_notice(self, name: str, trouble: Trouble) -> None:
        """State what is wrong elsewhere or awaited, or with NO_TROUBLE that nothing is: this service is well all the
        same."""
        self._process.condition.set_notice(name, trouble)

    def set_page(self, page: WebPage) -> None:
        """State where this service serves its page; health tells it."""
        self._process.condition.page = page

    def fail(self, error: BaseException) -> None:
        """End the process with `error`, from any thread."""
        self._process.fail(error)

    def _update(self, now: float) -> None:
        self._server.turn(self._describes, self._sets, self._saves, self.on_reconfigured)
        if self._keys is not None:
            self.set_notice("keys", self._keys.warning(datetime.now(UTC)))
        if self._router is not None:
            self.set_notice("router", self._router.problem(now))
        if self._link_repair is not None:
            self._link_repair.update(now)
        if self._wrong_robot is not None and (others := self._wrong_robot.others(now)):
            self.log.warning(
                "no other service of %s is heard; robots that are there: %s; name yours with GIRAFF_ROBOT_NAME",
                *(self.robot.name, ", ".join(others[:_MOST_NAMED])),
            )
        if self._base_reach is not None and self._base_reach.is_deaf(now):
            self._process.start_again(
                "the robot's door hears base and this process does not, because no other host can dial this one "
                "(a firewall?): all goes through the door from now on",
                {"GIRAFF_NETWORK_CLIENT": "true"},
            )
        # Zenoh learns this host's addresses at the start of a process, so a new address takes a new process.
        if self._addresses is not None and self._addresses.due(now):
            with contextlib.suppress(OSError):  # a flood has taken all descriptors
                addresses = self._look_at_addresses()
                if self._addresses.moved(now, addresses):
                    self._process.start_again(f"this host is now found at {', '.join(sorted(addresses))}")

    def _on_impostor(self, peer: str) -> None:
        self.fail(
            RuntimeError(
                f"peer {peer} is linked at a socket of this host and from elsewhere, too: another may speak in its "
                "name, and would be believed"
            )
        )

    def _tell_set(self, answer: ParamAnswer) -> None:
        """Say what was set, for recordings. It stays in order with the commands of this service."""
        self.session.put(
            key_of(self.robot.name, PARAM_DESCRIBE.at(self.service)),
            encode(answer),
            encoding=encoding_of(ParamAnswer),
            congestion_control=zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.REAL_TIME,
            express=True,
        )

    def _sees_router(self) -> bool:
        return bool(self.session.info.routers_zid())

    def _on_health_query(self, query: zenoh.Query) -> None:
        query.reply(query.key_expr, encode(self._process.condition.health()), encoding=encoding_of(Health))

"""What every service shares: configuration, session, typed topics, liveliness, health, a loop and a clean end.

with Node("guard", GuardConfig) as node:
    ticks = node.inbox(TICK, limit=1)
    out = node.publisher(CMD_VEL)
    pace = Pacer(CMD_VEL.rate_hz)
    for now in node.turns(pace):
        if pace.due(now): ...
"""

from __future__ import annotations

import contextlib
import os
import secrets
import selectors
import signal
import socket
import sys
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator
from types import FrameType, TracebackType
from typing import Any, Generic, Protocol, Self, TypeVar

import msgspec
import zenoh

from giraff_node.bad_keys import BadKeys
from giraff_node.config import ConfigError, ConfigT, load
from giraff_node.logs import service_logger
from giraff_node.pacing import Pacer
from giraff_node.robot import RobotConfig
from giraff_node.session import NetworkConfig, close_session, open_session
from giraff_schemas.codec import DecodeError, decode, encode, encoding_of, stamped
from giraff_schemas.messages import Health
from giraff_schemas.topics import AnswerT, Query, RequestT, SampleT, Topic, alive_key, health_key, key_of

_LONGEST_WAIT = 0.1  # s; bounds how late a turn notices what has no descriptor
_MOST_REQUESTS = 20  # that wait for their answers; the oldest goes without

_PRIORITIES = {"control": zenoh.Priority.REAL_TIME, "state": zenoh.Priority.DATA_HIGH}


ItemT = TypeVar("ItemT")


class Selectable(Protocol):
    """Something whose descriptor comes and goes, like a serial link."""

    def descriptor(self) -> int | None: ...


class Publisher(Generic[SampleT]):
    """Stamps and publishes the samples of one topic. Never blocks: what cannot be sent at once is dropped."""

    def __init__(self, node: Node[Any], topic: Topic[SampleT]) -> None:
        self._instance = node.instance
        self._seq = 0
        self._publisher = node.session.declare_publisher(
            key_of(node.robot.name, topic),
            encoding=encoding_of(topic.schema),
            congestion_control=zenoh.CongestionControl.DROP,
            priority=_PRIORITIES[topic.qos],
            express=topic.qos == "control",
        )

    def put(self, sample: SampleT) -> None:
        self._publisher.put(encode(stamped(sample, self._seq, time.time_ns(), self._instance)))
        self._seq += 1


class Inbox(Generic[ItemT]):
    """All that has come since the last `take`, oldest first; a reader that falls behind loses the oldest."""

    def __init__(self, limit: int) -> None:
        self._samples: deque[ItemT] = deque(maxlen=limit)

    def accept(self, sample: ItemT) -> None:
        self._samples.append(sample)

    def take(self) -> Iterator[ItemT]:
        for _ in range(len(self._samples)):  # what comes meanwhile waits: a flood must not hold the loop
            yield self._samples.popleft()


class Asked(Generic[RequestT, AnswerT]):
    """One request of somebody, waiting for its answer."""

    def __init__(self, query: zenoh.Query, request: RequestT) -> None:
        self._query = query
        self.request = request

    def answer(self, answer: AnswerT) -> None:
        with self._query as query:
            query.reply(query.key_expr, encode(answer), encoding=encoding_of(type(answer)))


class Node(Generic[ConfigT]):
    """One service's process. `service` names its configuration table and its liveliness token."""

    def __init__(self, service: str, config: type[ConfigT]) -> None:
        self.service = service
        self.instance = secrets.token_hex(8)
        self.log = service_logger(service)
        try:
            self.config = load(service, config)
            self.robot = load("robot", RobotConfig)
            network = load("network", NetworkConfig)
        except ConfigError as error:
            self.log.error("%s", error)
            sys.exit(2)
        self._faults: dict[str, str] = {}
        self._failure: BaseException | None = None
        self._stopping = False
        self._started = time.monotonic()
        # A self-pipe wakes the loop from signal handlers and Zenoh's threads: an Event set in a signal handler
        # deadlocks while the main thread waits on it.
        self._waker, self._wake_end = socket.socketpair()
        self._waker.setblocking(False)
        self._wake_end.setblocking(False)
        for number in (signal.SIGTERM, signal.SIGINT):  # before the session: opening it takes a moment
            signal.signal(number, self._on_signal)
        signal.set_wakeup_fd(self._wake_end.fileno(), warn_on_full_buffer=False)
        try:
            self.session = open_session(network)
        except zenoh.ZError as error:
            self.log.error("no Zenoh session: %s; check the table [network] of the robot file", error)
            sys.exit(2)
        self._declared: list[Any] = []  # a subscriber that nobody references ends

    def __enter__(self) -> Self:
        self._declared.append(
            self.session.declare_queryable(health_key(self.robot.name, self.service), self._on_health_query)
        )
        self._declared.append(
            self.session.liveliness().declare_token(alive_key(self.robot.name, self.service, self.instance))
        )
        self.log.info("robot %s, instance %s, pid %d", self.robot.name, self.instance, os.getpid())
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None:
            self.log.error("ended by %s: %s", kind.__name__, error, exc_info=(kind, error, trace) if error else None)
        signal.set_wakeup_fd(-1)
        closed = close_session(self.session)
        self.log.info("ended")
        status = 1 if kind is not None or self._failure is not None else 0
        if not closed:
            sys.stderr.flush()
            os._exit(status)
        if status:
            sys.exit(status)

    def publisher(self, topic: Topic[SampleT]) -> Publisher[SampleT]:
        return Publisher(self, topic)

    def inbox(self, topic: Topic[SampleT], limit: int = 200) -> Inbox[SampleT]:
        """Each sample of a topic, or the newest with a `limit` of 1; its arrival wakes the loop."""
        inbox: Inbox[SampleT] = Inbox(limit)

        def take_and_wake(sample: SampleT) -> None:
            inbox.accept(sample)
            self._wake()

        self.subscribe(topic, take_and_wake)
        return inbox

    def subscribe(self, topic: Topic[SampleT], callback: Callable[[SampleT], None]) -> None:
        """Call `callback` with each sample, in Zenoh's thread: it must be quick. If it raises, the process ends."""
        pattern = key_of(self.robot.name, topic)
        bad_keys = BadKeys(pattern, self.set_fault)

        def on_sample(received: zenoh.Sample) -> None:
            key = str(received.key_expr)
            try:
                sample = decode(topic, key, bytes(received.payload), str(received.encoding))
            except DecodeError as error:
                bad_keys.bad(key, str(error), time.monotonic())
                return
            bad_keys.good(key, time.monotonic())
            try:
                callback(sample)
            except Exception as error:  # noqa: BLE001  Zenoh would print and forget it; here it ends the process
                self.fail(error)

        self._declared.append(self.session.declare_subscriber(pattern, on_sample))

    def requests(self, query: Query[RequestT, AnswerT]) -> Inbox[Asked[RequestT, AnswerT]]:
        """What is asked of this service, for its loop to answer; its arrival wakes the loop."""
        inbox: Inbox[Asked[RequestT, AnswerT]] = Inbox(_MOST_REQUESTS)
        decoder = msgspec.msgpack.Decoder(query.request)

        def on_query(asked: zenoh.Query) -> None:
            try:
                request = decoder.decode(bytes(asked.payload or b""))
            except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
                with asked:
                    asked.reply_err(f"not a {query.request.__name__}: {error}")
                return
            inbox.accept(Asked(asked, request))
            self._wake()

        self._declared.append(self.session.declare_queryable(key_of(self.robot.name, query), on_query))
        return inbox

    def turns(self, *pacers: Pacer, link: Selectable | None = None) -> Iterator[float]:
        """Yield the monotonic time (s) whenever a pacer may be due, the link is readable or an inbox was filled.

        Ends on SIGTERM or SIGINT, and raises what a callback raised.
        """
        selector = selectors.DefaultSelector()
        selector.register(self._waker, selectors.EVENT_READ)
        watched: int | None = None
        while not self._stopping:
            descriptor = link.descriptor() if link is not None else None
            if descriptor != watched:
                if watched is not None:
                    with contextlib.suppress(KeyError, ValueError):
                        selector.unregister(watched)
                if descriptor is not None:
                    selector.register(descriptor, selectors.EVENT_READ)
                watched = descriptor
            now = time.monotonic()
            wait = min((pacer.wait(now) for pacer in pacers), default=_LONGEST_WAIT)
            selector.select(min(wait, _LONGEST_WAIT))
            with contextlib.suppress(BlockingIOError):
                self._waker.recv(4096)
            if self._failure is not None:
                raise self._failure
            if not self._stopping:
                yield time.monotonic()
        selector.close()

    def set_fault(self, name: str, message: str) -> None:
        """State what is wrong with `name`, or with "" that nothing is: logged on a change, told by health."""
        if self._faults.get(name, "") == message:
            return
        if message:
            self._faults[name] = message
            self.log.warning("%s", message)
        else:
            self._faults.pop(name, None)  # another subscriber's thread may have done so just now
            self.log.info("recovered: %s", name)

    def fail(self, error: BaseException) -> None:
        """End the process with `error`, from any thread."""
        self.log.error("%s", "".join(traceback.format_exception(error)))
        self._failure = error
        self._wake()

    def _wake(self) -> None:
        with contextlib.suppress(BlockingIOError):  # full: the loop is about to wake anyway
            self._wake_end.send(b"\0")

    def _on_signal(self, _number: int, _frame: FrameType | None) -> None:
        self._stopping = True  # the wake-up descriptor has already been written to

    def _on_health_query(self, query: zenoh.Query) -> None:
        health = Health(
            service=self.service,
            instance=self.instance,
            host=socket.gethostname(),
            pid=os.getpid(),
            uptime=time.monotonic() - self._started,
            ok=not self._faults,
            faults=tuple(self._faults.values()),
        )
        query.reply(query.key_expr, encode(health), encoding=encoding_of(Health))

"""The graph of one robot: its processes, their health, and the traffic on each key."""

import time
from collections import deque
from collections.abc import Callable, Iterable
from typing import Any, Final, Self

import msgspec
import zenoh

from giraff_node.network.consent import NoRobotError
from giraff_node.network.discovery import not_found_text
from giraff_node.network.replies import ask_all
from giraff_node.network.tokens import list_robots
from giraff_schemas.health import Health
from giraff_schemas.messages import Sample
from giraff_schemas.text import meant
from giraff_schemas.topics import ROOT, TOPICS, Topic, health_key, key_of, topic_of
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.statistics import Arrival, Header, TopicStatistics
from giraff_tools.network.topic_keys import intersects, is_declared
from giraff_tools.terminal.signals import StopSignal

FIRST_WITHIN: Final = 3.0  # s until the first word of a robot that is there
_LOOK_EVERY: Final = 0.02  # s
_ASK_EVERY: Final = 0.4  # s
_ANSWER_WITHIN: Final = 1.0  # s
_SETTLED: Final = 0.4  # s after the first word: the other processes of a robot are met within some ten ms
_MOST_WAITING: Final = 20_000  # samples
_ORDER: Final = {topic.key: number for number, topic in enumerate(TOPICS)}
_MOST_HEADS: Final = 200_000
_heads: Final = msgspec.msgpack.Decoder(Header)


class NodeId(msgspec.Struct, frozen=True, order=True):
    """A process of the robot."""

    service: str
    """Empty: its samples are heard, but it has no liveliness token."""
    instance: str

    @property
    def name(self) -> str:
        return self.service or (f"instance {self.instance}" if self.instance else "?")


def names_of(makers: Iterable[NodeId], *, instances: bool = False) -> str:
    """Name each of them once, with its instance where that is wanted."""
    return ", ".join(dict.fromkeys(f"{maker.name} {maker.instance}" if instances else maker.name for maker in makers))


class RobotGraph:
    """What is known. No clock, no network: both come in."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self.alive: dict[str, str] = {}
        """Instance -> service."""
        self.healths: dict[str, Health] = {}
        """By instance, the newest answer."""
        self.topics: dict[str, TopicStatistics] = {}
        """By key."""
        self.heard: deque[tuple[str, Sample, int]] = deque(maxlen=_MOST_WAITING)
        """Samples of the connection's topics: key, sample, when (robot's clock, ns); for whoever takes them."""

    def on_sample(self, topic: Topic[Any], key: str, sample: Sample, at_ns: int) -> None:
        """A sample of a topic that the connection subscribes to."""
        del topic
        self.heard.append((key, sample, at_ns))

    def on_liveliness(self, service: str, instance: str, *, present: bool) -> None:
        """A service's token on the network has come or gone."""
        if present:
            self.alive[instance] = service
        else:
            self.alive.pop(instance, None)
            self.healths.pop(instance, None)

    def count(self, arrival: Arrival) -> None:
        """A sample has come."""
        if arrival.key not in self.topics:
            self.topics[arrival.key] = TopicStatistics(arrival.key)
        self.topics[arrival.key].on_sample(arrival)

    @property
    def empty(self) -> bool:
        return not self.alive and not self.topics and not self.heard

    @property
    def services(self) -> list[NodeId]:
        """Every process that is there."""
        return sorted(NodeId(service, instance) for instance, service in self.alive.items())

    @property
    def answered(self) -> bool:
        """Whether every process has told of its health."""
        return set(self.alive) <= set(self.healths)

    @property
    def complete(self) -> bool:
        """Whether that, and whoever is heard has a token."""
        makers = {instance for statistics in self.topics.values() for instance in statistics.counts}
        return self.answered and makers <= set(self.alive)

    @property
    def spoken(self) -> dict[str, list[str]]:
        """By service that is there, the keys that it publishes."""
        found: dict[str, list[str]] = {service: [] for service in self.alive.values()}
        for key in self.keys:
            for maker in self.publishers(key):
                if maker.service in found:
                    found[maker.service].append(key)
        return found

    @property
    def keys(self) -> list[str]:
        """What is published or heard, in the order of the topics table."""
        told = (key for health in self.healths.values() for key in health.publishes)
        return sorted({*told, *self.topics}, key=_place)

    def publishers(self, key: str) -> list[NodeId]:
        """Those who say that they publish it, and those of whom it is heard."""
        told = (instance for instance, health in self.healths.items() if key in health.publishes)
        heard = self.topics[key].counts if key in self.topics else ()
        return sorted(self.maker(instance) for instance in {*told, *heard})

    def publishers_of(self, pattern: str) -> list[NodeId]:
        """Those of all keys that a `*` covers."""
        return sorted({maker for key in self.keys if intersects(pattern, key) for maker in self.publishers(key)})

    def subscribers(self, key: str) -> list[NodeId]:
        """Those who say that they listen to it."""
        return sorted(
            self.maker(instance)
            for instance, health in self.healths.items()
            if any(intersects(pattern, key) for pattern in health.subscribes)
        )

    def maker(self, instance: str) -> NodeId:
        """Of a sample."""
        return NodeId(self.alive.get(instance, ""), instance)

    def instead(self, topic: Topic[Any]) -> str:
        """What to say of a topic that nobody publishes and that is not heard; empty: somebody does, or it is."""
        if any(intersects(topic.key, key) for key in self.keys):
            return ""
        there = ", ".join(self.keys) or "nothing"
        hint = "" if is_declared(topic) else meant(topic.key, dict.fromkeys((*_ORDER, *self.keys)))
        return f"nobody publishes {topic.key} on {self.robot}; {hint}published there: {there}"


class GraphMonitor:
    """Makes a survey; from its making on it listens."""

    def __init__(self, connection: RobotConnection, meters: "Iterable[HeaderSubscriber]" = ()) -> None:
        self.robot_graph = RobotGraph(connection.robot)
        self._connection = connection
        self._meters = list(meters)
        self._answers: deque[Health] = deque()
        self._next_question = 0.0
        connection.subscribe_all(())

    @classmethod
    def counting(cls, connection: RobotConnection, topic: Topic[Any] | None = None) -> Self:
        """Return one that counts what is said, too. `topic`: the only one that counts; None: all."""
        return cls(connection, [HeaderSubscriber(connection.session, connection.robot, topic)])

    def update(self, now: float, *, again: bool = False) -> None:
        """Take in what has come; ask those who have not told of their health, or with `again` everybody."""
        self._connection.dispatch(self.robot_graph)
        for meter in self._meters:
            meter.dispatch(self.robot_graph.count)
        for _ in range(len(self._answers)):
            health = self._answers.popleft()
            if health.instance in self.robot_graph.alive:
                self.robot_graph.healths[health.instance] = health
        if now >= self._next_question and (again or not self.robot_graph.answered):
            self._next_question = now + _ASK_EVERY
            self._ask()

    def run(self, seconds: float, stopping: StopSignal) -> RobotGraph:
        """Look for `seconds` from the first word on, and for those who are met late. Raises NoRobotError."""
        self.wait_for_robot(stopping)
        self._until(time.monotonic() + seconds, stopping)
        self._until(time.monotonic() + _ANSWER_WITHIN, stopping, complete=True)
        return self.robot_graph

    def collect_health(self, stopping: StopSignal) -> RobotGraph:
        """Look until all have told of their health, or do not."""
        self.wait_for_robot(stopping)
        now = time.monotonic()
        self._until(now + _SETTLED, stopping)
        self._until(now + _ANSWER_WITHIN, stopping, complete=True)
        return self.robot_graph

    def wait(self, seconds: float, stopping: StopSignal) -> None:
        """Look for `seconds`, whether or not there is a robot."""
        self._until(time.monotonic() + seconds, stopping)

    def wait_for_robot(self, stopping: StopSignal) -> None:
        """Wait for the first word of the robot. Raises NoRobotError."""
        deadline = time.monotonic() + FIRST_WITHIN
        while self.robot_graph.empty:
            self.update(now := time.monotonic())
            if now > deadline or stopping.wait(_LOOK_EVERY):
                raise NoRobotError(not_found_text(self.robot_graph.robot, list_robots(self._connection.session)))

    def _until(self, deadline: float, stopping: StopSignal, *, complete: bool = False) -> None:
        while True:
            self.update(now := time.monotonic())
            if stopping.asked or (complete and self.robot_graph.complete):
                return
            if now >= deadline or stopping.wait(min(_LOOK_EVERY, deadline - now)):
                return

    def _ask(self) -> None:
        key = health_key(self.robot_graph.robot)
        ask_all(self._connection.session, key, Health, self._answers.append, _ANSWER_WITHIN)


def is_listened_to(publisher: Any) -> bool:
    """Whether Zenoh knows of anybody. `publisher`: one of Zenoh's, whose own word for its type is wrong here."""
    return bool(publisher.matching_status.matching)


def _place(key: str) -> tuple[int, str]:
    """In the order of the topics table, unknown ones last."""
    row = topic_of(key)
    return (len(_ORDER) if row is None else _ORDER[row.key], key)


class HeaderSubscriber:
    """Hears how samples travel, not what they say: only their heads are read, so that a flood is counted, too.

    From its making on; `dispatch` from one thread only.
    """

    def __init__(self, session: zenoh.Session, robot: str, topic: Topic[Any] | None = None) -> None:
        """`topic`: the only one to hear; None: whatever is said below the robot's name."""
        self._below = f"{ROOT}/{robot}/"
        self._came: deque[Arrival] = deque(maxlen=_MOST_HEADS)
        key = f"{self._below}**" if topic is None else key_of(robot, topic)
        self._subscriber = session.declare_subscriber(key, self._on_sample)

    def dispatch(self, hear: Callable[[Arrival], None]) -> None:
        """Pass on what has come since the last call."""
        for _ in range(len(self._came)):
            hear(self._came.popleft())

    def _on_sample(self, received: zenoh.Sample) -> None:
        at, wall_ns = time.monotonic(), time.time_ns()
        payload = bytes(received.payload)
        key = str(received.key_expr).removeprefix(self._below)
        self._came.append(Arrival(key, len(payload), _head(payload), at, wall_ns))


def _head(payload: bytes) -> Header | None:
    try:
        head = _heads.decode(payload)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return None
    return head if head.instance else None

"""One node on a ROS network: `RosPort` over Zenoh, as rmw_zenoh_cpp does it."""

import time
from collections import deque
from collections.abc import Callable, Collection, Iterable
from contextlib import suppress
from itertools import count
from typing import Any, Final

import zenoh
import zenoh.ext

from giraff_core.timer import Timer
from giraff_node.network.session import close_session
from giraff_node.process.selector import Waker
from giraff_ros2.answers import Answers
from giraff_ros2.config import Ros2Config
from giraff_ros2.port import Call, Received, Refused, RosPublisher
from giraff_ros2.rmw.definitions import Definitions, TornError
from giraff_ros2.rmw.graph import Graph
from giraff_ros2.rmw.names import (
    Attachment,
    Entity,
    attachment_of,
    dds_type,
    gid_of,
    key_of,
    qos_text,
    token_space,
)
from giraff_ros2.rmw.session import RosSession, open_ros
from giraff_ros2.topics import ESTOP, NODE, SUBSCRIBED, RosTopic
from giraff_schemas.trouble import Trouble

_HEARTBEAT: Final = 0.5  # s; of a latched topic, as rmw_zenoh has it
_MOST_WAITING: Final = 256  # messages between two turns
_MOST_CALLS: Final = 16  # that wait for an answer; a further one is refused at once
_MOST_BYTES: Final = 4096  # of a message; what is subscribed to has some hundred
_MOST_ASKED: Final = 32  # processes
_ASKS_HZ: Final = 20.0  # an answer is the proof of a hand at rest: base arms by fresh ones only
_ANSWERS_WITHIN: Final = 0.5  # s; awake processes take some ms


def sample_attachment(sample: zenoh.Sample) -> Attachment:
    """Return what a sample carries beside its payload. Raises TornError."""
    if len(sample.payload) > _MOST_BYTES:
        raise TornError(f"its payload has {len(sample.payload)} bytes, and {_MOST_BYTES} are taken")
    attachment = attachment_of(bytes(sample.attachment or b""))
    if attachment is None:
        raise TornError("it has no attachment of rmw_zenoh")
    return attachment


class _Call:
    """A call of the service, waiting for its answer."""

    def __init__(self, query: zenoh.Query, asked: Attachment, encode: Callable[..., bytes]) -> None:
        self._query, self._asked, self._encode = query, asked, encode

    def answer(self, success: bool, message: str) -> None:
        reply = self._asked._replace(sent_ns=time.time_ns())
        with self._query as query, suppress(zenoh.ZError):  # who has asked may be gone
            query.reply(query.key_expr, self._encode(success=success, message=message), attachment=reply.encode())


class RosNode:
    """The robot's node. Whatever is called from Zenoh's threads only keeps what has come, and wakes the loop."""

    def __init__(self, config: Ros2Config, published: Collection[RosTopic]) -> None:
        """Open the session and declare all. `published`: topics without a `*`. Raises NoRosError."""
        self._config = config
        self._definitions = Definitions(config.distribution)
        self._ros: RosSession = open_ros(config.router)
        self._session = self._ros.session
        self._zid = str(self._session.zid())
        self._ids = count()
        self._namespace = f"/{config.namespace}"
        self._waker, self._is_woken = Waker(), False
        self._heard: deque[Received | Refused] = deque(maxlen=_MOST_WAITING)
        self._calls: deque[Call] = deque()
        self._answers: dict[str, Answers] = {}
        self._replies: deque[tuple[str, float, float]] = deque()  # process, when it was asked, when it has answered
        self._asks = Timer(_ASKS_HZ)
        self._declared: list[Any] = []
        self._declare("NN")
        rows = {topic: (self._name_of(topic), self._definitions.hash_of(topic.type)) for topic in SUBSCRIBED}
        self._graph = Graph(self._zid, rows, {self._name_of(topic) for topic in published})
        self._own = {topic: self._publisher(topic) for topic in published}
        for topic in SUBSCRIBED:
            self._subscribe(topic)
        self._serve(ESTOP)
        self._declared.append(
            self._session.liveliness().declare_subscriber(token_space(config.domain), self._on_token, history=True)
        )

    @property
    def way(self) -> RosSession:
        """The session by which ROS processes are met."""
        return self._ros

    def descriptor(self) -> int | None:
        return self._waker.descriptor()

    def publish(self, topic: RosTopic, message: Any) -> None:
        self._own[topic](self._definitions.encode(message, topic.type))

    def pop_all(self) -> Iterable[Received | Refused]:
        if self._is_woken:  # by nothing else than what wakes it here: a system call less in most turns
            self._is_woken = False
            self._waker.drain()
        for _ in range(len(self._heard)):  # what comes meanwhile waits: a flood must not hold the turn
            yield self._heard.popleft()

    def calls(self) -> Iterable[Call]:
        for _ in range(len(self._calls)):
            yield self._calls.popleft()

    def publishers(self) -> Iterable[RosPublisher]:
        self._ask(publisher.process for publisher in self._graph.publishers)
        return self._graph.publishers

    def is_wanted(self, topic: RosTopic) -> bool:
        return self._name_of(topic) in self._graph.wanted

    def answers(self, process: str) -> Answers:
        self._take_replies()
        return self._answers.get(process) or Answers()

    def wall_ns(self) -> int:
        return time.time_ns()

    def trouble(self) -> Trouble:
        if not self._ros.is_reached:
            return Trouble(
                f"no Zenoh router is heard at {self._config.router}", "start `ros2 run rmw_zenoh_cpp rmw_zenohd` there"
            )
        return self._graph.trouble

    def close(self) -> None:
        """Leave the ROS network."""
        close_session(self._session)
        self._waker.close()

    def _name_of(self, topic: RosTopic) -> str:
        namespace = self._namespace.rstrip("/")
        below, private, name = topic.name.rpartition("~/")
        return f"{namespace}/{NODE}/{name}" if private else f"{namespace}/{below}{name}"

    def _declare(self, kind: str, topic: RosTopic | None = None) -> bytes:
        """Tell of an entity by a token; its gid."""
        entity = Entity(self._zid, 0, next(self._ids), kind, self._namespace, NODE)
        if topic is not None:
            entity = entity._replace(
                name=self._name_of(topic),
                type=dds_type(topic.type),
                type_hash=self._definitions.hash_of(topic.type),
                qos=qos_text(topic.qos),
            )
        token = entity.token(self._config.domain)
        self._declared.append(self._session.liveliness().declare_token(token))
        return gid_of(token)

    def _key_of(self, topic: RosTopic) -> str:
        type_hash = self._definitions.hash_of(topic.type)
        return key_of(self._config.domain, self._name_of(topic), topic.type, type_hash)

    def _publisher(self, topic: RosTopic) -> Callable[[bytes], None]:
        reliability = zenoh.Reliability.RELIABLE if topic.qos.is_reliable else zenoh.Reliability.BEST_EFFORT
        publisher = (
            zenoh.ext.declare_advanced_publisher(
                self._session,
                self._key_of(topic),
                congestion_control=zenoh.CongestionControl.DROP,
                reliability=reliability,
                cache=zenoh.ext.CacheConfig(topic.qos.depth),
                publisher_detection=True,
                sample_miss_detection=zenoh.ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=_HEARTBEAT),
            )
            if topic.qos.is_latched
            else self._session.declare_publisher(
                self._key_of(topic), congestion_control=zenoh.CongestionControl.DROP, reliability=reliability
            )
        )
        gid, sequence = self._declare("MP", topic), count(1)

        def put(payload: bytes) -> None:
            publisher.put(payload, attachment=Attachment(next(sequence), time.time_ns(), gid).encode())

        return put

    def _subscribe(self, topic: RosTopic) -> None:
        name = self._name_of(topic)

        def on_sample(sample: zenoh.Sample) -> None:
            at = time.monotonic()
            try:
                attachment = sample_attachment(sample)
                message = self._definitions.decode(bytes(sample.payload), topic.type)
                heard: Received | Refused = Received(topic, message, attachment.gid, attachment.sent_ns, at)
            except TornError as error:
                heard = Refused(topic, Trouble(f"a message on {name} was refused: {error}", "check who publishes it"))
            self._heard.append(heard)
            self._wake()

        self._declared.append(self._session.declare_subscriber(self._key_of(topic), on_sample))
        self._declare("MS", topic)

    def _serve(self, service: RosTopic) -> None:
        key = self._key_of(service)

        def on_query(query: zenoh.Query) -> None:
            if str(query.key_expr) != key:
                with query:
                    return  # who asks everything on the network calls no service
            asked = attachment_of(bytes(query.attachment or b""))
            if asked is None:
                with query:
                    query.reply_err(f"a call of {self._name_of(service)} without an attachment of rmw_zenoh")
                return
            call = _Call(query, asked, self._definitions.trigger_response)
            if len(self._calls) >= _MOST_CALLS:
                call.answer(False, "too many calls wait for an answer")
                return
            self._calls.append(call)
            self._wake()

        self._declared.append(self._session.declare_queryable(key, on_query, complete=True))
        self._declare("SS", service)

    def _wake(self) -> None:
        self._is_woken = True
        self._waker.wake()

    def _on_token(self, sample: zenoh.Sample) -> None:
        self._graph.on_token(str(sample.key_expr), is_there=sample.kind == zenoh.SampleKind.PUT)
        self._wake()

    def _take_replies(self) -> None:
        for _ in range(len(self._replies)):
            process, asked, at = self._replies.popleft()
            if process in self._answers:
                self._answers[process].on_answer(asked, at)

    def _ask(self, processes: Iterable[str]) -> None:
        """Ask each process for its state in Zenoh's admin space. One that is frozen does not answer."""
        now = time.monotonic()
        if not self._asks.due(now):
            return
        self._take_replies()
        asked = [*dict.fromkeys(processes)][:_MOST_ASKED]
        self._answers = {process: self._answers.get(process) or Answers() for process in asked}
        for process, answers in self._answers.items():
            answers.on_question(now)

            def on_reply(reply: zenoh.Reply, process: str = process) -> None:
                if reply.ok is not None and str(reply.ok.key_expr).startswith(f"@/{process}/"):
                    self._replies.append((process, now, time.monotonic()))

            self._session.get(
                f"@/{process}/*", on_reply, timeout=_ANSWERS_WITHIN, consolidation=zenoh.ConsolidationMode.NONE
            )

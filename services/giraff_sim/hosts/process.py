"""A process in simulated time: it runs a service's own turn whenever the real loop would, on a simulated world."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from random import Random
from typing import Any, Final, Generic, Protocol, TypeVar

import msgspec

from giraff_core.io import MOST_REQUESTS, Board, Inbox, PendingQuery, Publisher, SerialPort, Service
from giraff_core.parameters.server import ParameterServer
from giraff_core.parameters.table import ConfigT, Parameters
from giraff_core.retry import RetriedRequest
from giraff_core.robot import RobotConfig
from giraff_node.boards.board_link import BoardLink
from giraff_node.boards.byte_link import ByteLink
from giraff_schemas.boards import BoardType
from giraff_schemas.codec import stamped
from giraff_schemas.frames import Transform
from giraff_schemas.messages import Sample
from giraff_schemas.topics import (
    PARAM_DESCRIBE,
    PARAM_SAVE,
    PARAM_SET,
    AnswerT,
    Query,
    RequestT,
    SampleT,
    Topic,
)
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import Frame
from giraff_sim.hosts.cable import Cable, CableEnd
from giraff_sim.hosts.disk import ProcessStore
from giraff_sim.hosts.event_queue import EventQueue
from giraff_sim.hosts.host import Host
from giraff_sim.hosts.network import Message, Network, Subscription
from giraff_sim.settings import Settings
from giraff_sim.simulation import Simulation
from giraff_sim.world.bno055 import Vector

_LONGEST_WAIT_US: Final = 100_000  # a node's loop comes round at least this often
_NEVER: Final = 1 << 62

ItemT = TypeVar("ItemT")


class Loop(Protocol):
    """What processes run in, and share: the closed loop."""

    @property
    def simulation(self) -> Simulation: ...

    @property
    def settings(self) -> Settings: ...

    @property
    def network(self) -> Network: ...

    @property
    def observer(self) -> "Observer": ...

    @property
    def agenda(self) -> EventQueue: ...

    @property
    def cables(self) -> dict[str, Cable]:
        """By the port's path."""
        ...

    @property
    def newest(self) -> dict[str, Any]:
        """The newest sample that was published, by key."""
        ...


class Process:
    """The `IO` of one service, and its loop."""

    def __init__(self, loop: Loop, host: Host, name: str, instance: str) -> None:
        """`name`: what it is called here; `instance`: of this start of it."""
        self.loop = loop
        self.host = host
        self.name = name
        self.instance = instance
        self.hostname = host.name
        self.is_open = False  # no stranger is on a simulated network
        self.store = ProcessStore(host.disk, lambda: not self.ended, self.wake)
        self.on_reconfigured: Callable[[Any], None] | None = None
        self.paused = False
        """As by SIGSTOP: nothing runs, and what arrives waits."""
        self.ended = False
        self.told: dict[str, str] = {}
        """Its faults and notices, by name."""
        self._service: Service | None = None
        self._leaves = False
        self._answer_for_params: Callable[[], None] = lambda: None
        self.lost_parameters = NO_TROUBLE
        self._random = Random(f"{loop.simulation.world.seed}/{instance}")
        self._waiting: list[tuple[Subscription, Message]] = []
        self._sequences: dict[str, int] = defaultdict(int)
        self._wake_at_us = _NEVER
        self._entry_us = _NEVER  # of the agenda's earliest entry for this process, which may be too early by now
        self._links: list[BoardLink | ByteLink] = []
        self._imitated: dict[str, Board] = {}

    # What a service has of it.

    def inbox(self, topic: Topic[SampleT], limit: int = 200, *, wakes: bool = True) -> Inbox[SampleT]:
        inbox: Inbox[SampleT] = _Inbox(limit, partial(self.loop.observer.heard, self))
        self._subscribe(topic.key, lambda message: inbox.accept(message.body), wakes)  # type: ignore[arg-type]  # its key says
        return inbox

    def publisher(self, topic: Topic[SampleT]) -> Publisher[SampleT]:
        return _Publisher(self, topic)

    def requests(self, query: Query[RequestT, AnswerT]) -> Inbox[PendingQuery[RequestT, AnswerT]]:
        observer = self.loop.observer
        inbox: Inbox[PendingQuery[RequestT, AnswerT]] = _Inbox(
            MOST_REQUESTS, lambda asked: observer.heard(self, asked.request)
        )
        self._subscribe(query.key, lambda message: inbox.accept(Request(self.loop.network, self, message)))
        return inbox

    def ask(
        self, query: Query[RequestT, AnswerT], request: RequestT, settles: Callable[[AnswerT], bool | str]
    ) -> RetriedRequest[AnswerT]:
        return _Asking(self, query.key, request, settles)

    def frame(self, child: str, where: Transform | Callable[[], Transform | None]) -> None:
        """Nobody asks for frames here."""

    def board(self, path: str, board: BoardType) -> Board:
        if path in self._imitated:
            return self._imitated[path]
        link = BoardLink(path, board, CableEnd(path, board.baud, self.loop.cables.get(path), self.wake))
        self._links.append(link)
        return _WatchedBoard(self, link)

    def serial(self, path: str, baud: int) -> SerialPort:
        def on_data() -> None:
            if self._service is not None and self._service.link is link:
                self.wake()

        end = CableEnd(path, baud, self.loop.cables.get(path), on_data)
        link = ByteLink(path, baud, self.robot_ns, end)
        self._links.append(link)
        return link

    def monotonic(self) -> float:
        return self.host.monotonic()

    def robot_ns(self) -> int:
        return self.host.boottime_ns()

    def token(self) -> int:
        return self._random.randrange(1, 1 << 32)

    def set_fault(self, name: str, trouble: Trouble) -> None:
        self.told[name] = str(trouble)

    def set_notice(self, name: str, trouble: Trouble) -> None:
        self.told[name] = str(trouble)

    def leave(self) -> None:
        self._leaves = True

    # What the simulation does with it.

    def parameters(self, service: str, filed: ConfigT, robot: RobotConfig) -> ConfigT:
        """What is in force of a table once what was saved is restored. From now on it is answered for."""
        params = Parameters(service, filed, robot)
        server = ParameterServer(service, self.instance, self.hostname, params, self.store, _tell_nobody)
        describes, sets, saves = (
            self.requests(PARAM_DESCRIBE.at(service)),
            self.requests(PARAM_SET.at(service)),
            self.requests(PARAM_SAVE.at(service)),
        )
        self.lost_parameters = server.lost
        self._answer_for_params = lambda: server.turn(describes, sets, saves, self.on_reconfigured)
        return params.config

    def imitate(self, path: str, board: Board) -> None:
        """Have another board than the simulated one at a port."""
        self._imitated[path] = board

    def run(self, service: Service) -> None:
        """Turn from now on."""
        self._service = service
        self.wake()

    @property
    def stalled(self) -> bool:
        """Whether it cannot run now."""
        return self.paused or self.host.suspended

    def receive(self, subscription: Subscription, message: Message) -> None:
        """Take a message from the network, or leave it in the kernel's buffers while nothing runs here."""
        if self.ended:
            return
        if self.stalled:
            self._waiting.append((subscription, message))
        else:
            subscription.accept(message)

    def go_on(self, spread_us: int = 0) -> None:
        """Run again after a stall: what has waited arrives as if it were new, over `spread_us`."""
        waiting, self._waiting = self._waiting, []
        now_us = self.loop.agenda.now_us
        for number, (subscription, message) in enumerate(waiting):
            at_us = now_us + spread_us * number // len(waiting)
            self.loop.agenda.at(at_us, partial(self.receive, subscription, message))
        self.wake()

    def wake(self, at_us: int | None = None) -> None:
        """Take a turn at `at_us`; None: now."""
        agenda = self.loop.agenda
        at_us = agenda.now_us if at_us is None else at_us
        if at_us < self._wake_at_us:
            self._wake_at_us = at_us
            if at_us < self._entry_us:
                self._entry_us = at_us
                agenda.at(at_us, self._awake)

    def terminate(self) -> None:
        """End as SIGTERM would: in order, with the service's last words. One that is stalled says none."""
        if self._service is not None and not self.stalled and not self.ended:
            self._service.end()
        self.end()

    def end(self) -> None:
        """End as SIGKILL would."""
        self.ended = True
        for link in self._links:
            link.close()

    def say(self, key: str, sample: Sample) -> None:
        """Stamp a sample, and publish it."""
        seq = self._sequences[key]
        self._sequences[key] = seq + 1
        whole = stamped(sample, seq, self.host.wall_ns(), self.instance)
        self.loop.newest[key] = whole
        self.loop.observer.said(self, whole)
        self.loop.network.publish(self, Message(key, whole))

    def _subscribe(self, key: str, accept: Callable[[Message], None], wakes: bool = True) -> None:
        def accept_and_wake(message: Message) -> None:
            accept(message)
            self.wake()

        self.loop.network.join(Subscription(self, key, accept_and_wake if wakes else accept))

    def _awake(self) -> None:
        now_us = self.loop.agenda.now_us
        if self._entry_us <= now_us:
            self._entry_us = _NEVER
        if self.ended or self._service is None:
            return
        if self._wake_at_us > now_us:
            if self._wake_at_us < self._entry_us:
                self._entry_us = self._wake_at_us
                self.loop.agenda.at(self._wake_at_us, self._awake)
            return
        self._wake_at_us = _NEVER
        if self.stalled:
            return
        self._answer_for_params()
        now = self.host.monotonic()
        self._service.turn(now)
        if self._leaves:
            self.terminate()
            return
        wait = 1.0
        for timer in self._service.timers:
            wait = min(wait, timer.wait(now))
        self.wake(now_us + min(_LONGEST_WAIT_US, int(wait * 1e6) + 1))


class Request:
    """A request that has arrived, as a service takes it."""

    def __init__(self, network: Network, taker: Process, message: Message) -> None:
        self.request: Any = message.body
        self._network = network
        self._taker = taker
        self._message = message

    def answer(self, answer: Any) -> None:
        self._taker.loop.observer.answered(self._taker, self.request, answer)
        self._network.answer(self._taker, self._message, answer)


def _tell_nobody(message: str, *values: object) -> None:
    """The log of a process in a simulation."""


class _Inbox(Inbox[ItemT]):
    """An inbox that tells of each item when it is handed to the service."""

    def __init__(self, limit: int, tell: Callable[[ItemT], None]) -> None:
        super().__init__(limit)
        self._tell = tell

    def pop_all(self) -> Iterator[ItemT]:
        for item in super().pop_all():
            self._tell(item)
            yield item


class _Publisher(Generic[SampleT]):
    def __init__(self, process: Process, topic: Topic[SampleT]) -> None:
        self._process = process
        self._key = topic.key

    def put(self, sample: SampleT) -> None:
        self._process.say(self._key, sample)


class _Asking(RetriedRequest[AnswerT]):
    """As `giraff_node.network.query_client.QueryClient`, over the simulated network."""

    def __init__(
        self, process: Process, key: str, request: msgspec.Struct, settles: Callable[[AnswerT], bool | str]
    ) -> None:
        super().__init__(settles)
        self._process = process
        self._message = Message(key, request, Subscription(process, key, self._on_reply))

    def _attempt(self) -> None:
        self._process.loop.network.publish(self._process, self._message)

    def _on_reply(self, message: Message) -> None:
        self.on_answer(message.body)  # type: ignore[arg-type]  # the request's key says what it is answered with
        self._process.wake()


class _WatchedBoard:
    """A board link that tells of each frame when it is handed to the service."""

    def __init__(self, process: Process, link: BoardLink) -> None:
        self._process = process
        self._observer = process.loop.observer
        self._link = link

    def descriptor(self) -> int | None:
        return self._link.descriptor()

    @property
    def fault(self) -> Trouble:
        return self._link.fault

    @property
    def opened(self) -> int:
        return self._link.opened

    def poll(self, now: float) -> Iterable[Frame]:
        before = self._link.opened
        frames = self._link.poll(now)
        if self._link.opened != before:
            self._observer.opened(self._process)
        return self._handed_out(frames) if frames else ()

    def send(self, frame: Frame) -> None:
        self._observer.wrote(self._process, frame)
        self._link.send(frame)

    def _handed_out(self, frames: list[Frame]) -> Iterator[Frame]:
        for frame in frames:
            self._observer.read(self._process, frame)
            yield frame


class Observer:
    """Is told what passes through a process; never seen by a service. This one keeps nothing."""

    def said(self, process: Process, sample: Any) -> None:
        """`process` publishes `sample`."""

    def heard(self, process: Process, sample: Any) -> None:
        """The service of `process` is handed `sample`, a request among them."""

    def answered(self, process: Process, request: Any, answer: Any) -> None:
        """The service of `process` answers a request."""

    def held(self, process: Process, acceleration: Vector) -> None:
        """The joystick of `process` is held just now so that this truly acts on it, m/s²."""

    def typed(self, process: Process, keys: bytes) -> None:
        """Somebody presses `keys` at the terminal of `process` just now."""

    def read(self, process: Process, frame: Frame) -> None:
        """The service of `process` is handed `frame` of its board."""

    def wrote(self, process: Process, frame: Frame) -> None:
        """`process` sends `frame` to its board."""

    def opened(self, process: Process) -> None:
        """`process` has opened the port of its board."""

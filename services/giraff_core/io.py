"""What a service is to whatever runs it, and what it reaches the world through. No I/O here.

A service's turn is written once. `giraff_node.Node` runs it as a process on Zenoh, serial ports and disks; the
simulation runs the same turn on networks, cables and disks of its own, in simulated time.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Final, Generic, NamedTuple, Protocol, TypeVar

import msgspec

from giraff_core.retry import RetriedRequest
from giraff_core.timer import Timer
from giraff_schemas.frames import Transform
from giraff_schemas.messages import Sample
from giraff_schemas.topics import AnswerT, Query, RequestT, SampleT, Topic
from giraff_schemas.trouble import Trouble

if TYPE_CHECKING:  # most services have no board
    from giraff_schemas.boards import BoardType
    from giraff_schemas.wire import Frame

MOST_REQUESTS: Final = 20
"""Requests that wait for their answers; the oldest goes without."""

ItemT = TypeVar("ItemT")
SampleT_contra = TypeVar("SampleT_contra", bound=Sample, contravariant=True)
RequestT_co = TypeVar("RequestT_co", bound=msgspec.Struct, covariant=True)
AnswerT_contra = TypeVar("AnswerT_contra", bound=msgspec.Struct, contravariant=True)


class Inbox(Generic[ItemT]):
    """All that has come for a service since the last `pop_all`, oldest first.

    A reader that falls behind loses the oldest.
    """

    def __init__(self, limit: int) -> None:
        self._samples: deque[ItemT] = deque(maxlen=limit)

    def accept(self, sample: ItemT) -> None:
        self._samples.append(sample)

    def __len__(self) -> int:
        """Return how many wait."""
        return len(self._samples)

    def pop_all(self) -> Iterator[ItemT]:
        for _ in range(len(self._samples)):  # what comes meanwhile waits: a flood must not hold the loop
            yield self._samples.popleft()


class Selectable(Protocol):
    """Something whose descriptor comes and goes, like a serial link."""

    def descriptor(self) -> int | None: ...


class Paced(Protocol):
    """Something that makes a turn due when its moment has come, like a timer."""

    def wait(self, now: float) -> float:
        """Seconds until then; inf: never. `now`: monotonic, s."""
        ...


class Publisher(Protocol[SampleT_contra]):
    """Of the samples of one topic."""

    def put(self, sample: SampleT_contra, /) -> None:
        """Stamp and publish. Never blocks."""
        ...


class PendingQuery(Protocol[RequestT_co, AnswerT_contra]):
    """One request of somebody, waiting for its answer."""

    @property
    def request(self) -> RequestT_co: ...

    def answer(self, answer: AnswerT_contra, /) -> None: ...


class Board(Selectable, Protocol):
    """A board at its serial port."""

    @property
    def fault(self) -> Trouble:
        """Why there are no frames; NO_TROUBLE when there may be."""
        ...

    @property
    def opened(self) -> int:
        """How often the port was opened."""
        ...

    def poll(self, now: float) -> "Iterable[Frame]":
        """Keep the port open and return the frames that have arrived. `now`: monotonic, s."""
        ...

    def send(self, frame: "Frame") -> None:
        """Send `frame`; a newer one replaces it until the kernel has begun to take it."""
        ...


class Arrival(NamedTuple):
    """The bytes that one look at a serial port has found. Moments are ns of `IO.robot_ns`."""

    data: bytes
    since_ns: int
    """Moment until which none of these bytes had arrived."""
    until_ns: int
    """Moment after they were read. None of them has waited longer than from `since_ns` to here."""
    opened: bool
    """This look has opened the port: nothing that was begun before goes on."""


class SerialPort(Selectable, Protocol):
    """The serial port of a device that sends and takes bytes of its own, and knows no ticks.

    A sense reads it through `giraff_core.fresh_bytes.FreshBytes`, which proves how old the bytes are.
    """

    @property
    def fault(self) -> Trouble:
        """Reason why the port is closed; NO_TROUBLE while it is open."""
        ...

    @property
    def is_idle(self) -> bool:
        """The port is open, and the kernel has taken all that was sent."""
        ...

    def poll(self, now: float) -> Arrival:
        """Keep the port open and return all that has arrived. `now`: monotonic, s."""
        ...

    def send(self, data: bytes) -> None:
        """Send `data`; newer data replaces it until the kernel has begun to take it, which `is_idle` tells."""
        ...


class Writer(Protocol):
    """Writes one small file, elsewhere: neither call waits for a disk."""

    def save(self, data: bytes) -> None:
        """Begin to replace the file; `outcome` tells how it went. One at a time."""
        ...

    def outcome(self) -> str | None:
        """Why it is not on disk, empty when it is; None: no news."""
        ...


class Store(Protocol):
    """Small files that are kept over restarts, each whole or not there."""

    def path(self, name: str) -> str:
        """Where a file is, for people."""
        ...

    def read(self, name: str) -> bytes:
        """What was kept. Raises OSError."""
        ...

    def writer(self, name: str) -> Writer: ...


class IO(Protocol):
    """All that reaches a service and leaves it."""

    instance: str
    """Random; of this start of this process."""
    hostname: str
    """Name of the machine."""
    is_open: bool
    """Another host of this network may speak in base's name."""
    on_reconfigured: Callable[[Any], None] | None
    """Takes the configuration between two turns whenever it has become another; None: no parameter changes live."""
    lost_parameters: Trouble
    """A saved limit that may be lost, since no parameter has its name. The robot then stands until a restart."""

    @property
    def store(self) -> Store: ...

    def inbox(self, topic: Topic[SampleT], limit: int = 200, *, wakes: bool = True) -> Inbox[SampleT]:
        """Each sample of a topic, or the newest with a `limit` of 1.

        `wakes`: its arrival makes a turn due; else it waits for the next, which the service's timers must bring.
        """
        ...

    def publisher(self, topic: Topic[SampleT]) -> Publisher[SampleT]: ...

    def requests(self, query: Query[RequestT, AnswerT]) -> Inbox[PendingQuery[RequestT, AnswerT]]:
        """What is asked of this service; its arrival makes a turn due."""
        ...

    def ask(
        self, query: Query[RequestT, AnswerT], request: RequestT, settles: Callable[[AnswerT], bool | str]
    ) -> RetriedRequest[AnswerT]:
        """Ask another service until it gives an answer that settles the matter, as `RetriedRequest` has it."""
        ...

    def frame(self, child: str, where: Transform | Callable[[], Transform | None]) -> None:
        """Tell whoever asks where the frame `child` is; of one that moves, by a call. None: it is not known now."""
        ...

    def board(self, path: str, board: "BoardType") -> Board: ...

    def serial(self, path: str, baud: int) -> SerialPort:
        """Return the port of a device without our firmware. As `Service.link`, its bytes make a turn due."""
        ...

    def monotonic(self) -> float:
        """s; what turns are given."""
        ...

    def robot_ns(self) -> int:
        """The clock that ticks are made of and judged by: it goes on while the machine is suspended.

        Only base's host may compare it with a tick.
        """
        ...

    def token(self) -> int:
        """A random number of 32 bits, not 0."""
        ...

    def set_fault(self, name: str, trouble: Trouble) -> None:
        """State what is wrong with `name` of this service itself, or with NO_TROUBLE that nothing is."""
        ...

    def set_notice(self, name: str, trouble: Trouble) -> None:
        """State what is wrong elsewhere or awaited, or with NO_TROUBLE that nothing is: this service is well all the
        same."""
        ...

    def leave(self) -> None:
        """End after this turn."""
        ...


class Service(Protocol):
    """What a process does. Made of its `IO`, its configuration and the robot's."""

    @property
    def timers(self) -> Sequence[Timer]:
        """Whose pace makes a turn due."""
        ...

    @property
    def link(self) -> Selectable | None:
        """Whose bytes make a turn due; None: there is none."""
        ...

    def turn(self, now: float) -> None:
        """Do all that is due. `now`: monotonic, s.

        It may run in a thread of Zenoh. Turns never overlap. A turn must be short: samples wait for its end.
        """
        ...

    def end(self) -> None:
        """The last words of an orderly end."""
        ...

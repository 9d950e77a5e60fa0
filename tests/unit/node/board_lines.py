"""A board's line in simulated time, and a loop that is woken by it: no descriptor, no clock."""

from dataclasses import dataclass, field
from math import ceil, inf

from giraff_node.boards.board_link import BoardLink
from giraff_node.boards.serial_link import REOPEN_PERIOD, UNPLUGGED, SerialLink
from giraff_schemas.boards import BASE_BOARD
from giraff_schemas.framing import encode
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import BASE_BAUD, PROTOCOL_HASH, BoardKind, Frame, HelloFrame

BYTE = 10 / BASE_BAUD
"""s that one takes."""
LATE = 20e-6
"""s from what wakes the loop to its turn."""
HELLO = HelloFrame(seq=0, board_us=1, board=BoardKind.BASE, protocol_hash=PROTOCOL_HASH, boot_id=1, reset_cause=1)


class FakeLine(SerialLink):
    """Bytes that arrive at moments; the port is there, but when it is pulled out."""

    def __init__(self) -> None:
        super().__init__("board", BASE_BAUD)
        self.now = 0.0
        self.coming: list[tuple[float, bytes]] = []
        """Moment (s) and bytes, in their order."""
        self.is_there = True
        self._is_open = False
        self._next = 0.0

    def descriptor(self) -> int | None:
        return 5 if self._is_open else None

    def keep_open(self, now: float) -> bool:
        if self._is_open or not self.is_there or now < self._next:
            return False
        self._next = now + REOPEN_PERIOD
        self._is_open, self.fault = True, NO_TROUBLE
        self.opened += 1
        self.coming = [(at, data) for at, data in self.coming if at > now]
        return True

    def close(self, why: Trouble) -> None:
        self._is_open, self.fault = False, why

    def read(self) -> bytes:
        if self._is_open and not self.is_there:
            self.close(UNPLUGGED)
        if not self._is_open:
            return b""
        here = b"".join(data for at, data in self.coming if at <= self.now)
        self.coming = [(at, data) for at, data in self.coming if at > self.now]
        return here

    def flush(self) -> None:
        """Nothing waits."""

    def send(self, frame: bytes) -> None:
        """Nobody listens."""


def carried(data: bytes, start: float, lump: float = 0.0) -> list[tuple[float, bytes]]:
    """`data` as a line carries it from `start` on, in lumps at the multiples of that many s; 0: byte by byte."""
    ends = [start + number * BYTE for number in range(1, len(data) + 1)]
    moments = [ceil(end / lump) * lump for end in ends] if lump else ends
    return [(at, data[number : number + 1]) for number, at in enumerate(moments)]


@dataclass
class FakeLoop:
    """Wakes as `giraff_node.process.lifecycle` does: for bytes while the descriptor is watched, and when due."""

    line: FakeLine = field(default_factory=FakeLine)
    wakes: int = 0
    turns: int = 0
    """Wakes that were followed by a turn."""
    took: list[tuple[float, Frame]] = field(default_factory=list)
    """What was handed out, and when."""

    def __post_init__(self) -> None:
        self.link = BoardLink(self.line.path, BASE_BOARD, self.line)
        self.link.poll(0.0)
        self.line.coming = [(0.0, encode(HELLO.pack()))]
        assert self.link.poll(0.0) == [HELLO]

    @property
    def frames(self) -> list[Frame]:
        return [frame for _, frame in self.took]

    def poll(self, now: float) -> list[Frame]:
        """A turn, for whatever reason."""
        self.line.now = now
        frames = self.link.poll(now)
        self.took += [(now, frame) for frame in frames]
        return frames

    def run(self, until: float, period: float = 0.1) -> None:
        """Turn whenever the loop would, and each `period` s."""
        timer = self.line.now + period
        while True:
            now = self.line.now
            arrival = min((at for at, _ in self.line.coming), default=inf)
            watched = self.link.descriptor() is not None
            at = min(now + self.link.wait(now), max(now, arrival) if watched else inf, timer)
            if at > until:
                break
            if at == timer:
                timer += period
            else:
                self.wakes += 1
                self.line.now = at + LATE
                if not self.link.ready(at + LATE):
                    continue
                self.turns += 1
            self.poll(at + LATE)
        self.line.now = until

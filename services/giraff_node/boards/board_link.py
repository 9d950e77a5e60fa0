"""A serial link to a board: frames instead of bytes, and proof that the other side is the right one."""

from math import inf
from typing import Final

from giraff_node.boards.serial_link import NO_PORT, SerialLink
from giraff_schemas.boards import ALL_BOARDS, BoardType
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import Frame, HelloFrame, HelloRequestFrame

HELLO_PERIOD = 0.25  # s between two requests while none was answered
SILENCE = 1.0  # s without a frame after which the port is opened again: a stale descriptor outlives a replug
_SILENT: Final = Trouble(f"silent for {SILENCE:g} s", "check the board's power and cable")
LATELY: Final = 0.3  # s; the ranger, which says least, reports every 0.06 s
_STRANGE: Final = 100
"""Bytes without a frame, in the time of silence, from which another device is there. A torn frame has fewer."""
_READS_AGAIN: Final = 0.02
"""s. `poll` reads the port by itself only where nobody has called `ready` for so long."""
_BITS: Final = 10  # of a byte on the line, with its start and its stop


class BoardLink:
    """Frames from and to one board. None is passed on before a matching `hello`.

    Between a frame's first bytes and the moment at which the line can have carried its last one it rests, so that a
    loop is not woken by each byte: it has no descriptor, and `wait` says for how long. A whole frame is late by that
    only behind a torn one, or out of an adapter that held up its start: by less than the longest frame takes.

    A loop that was woken by the link asks `ready` first: a part of a frame is no reason for a turn.

    Each board reports unasked, so that nothing is sent to one that has not spoken lately: a Mega that was reset, as by
    opening its port, is in its boot loader (Arduino's stk500boot.c), which does not start the program while bytes come.
    """

    def __init__(self, path: str, board: BoardType, serial: SerialLink | None = None) -> None:
        """`serial`: instead of a port of this machine."""
        self.board = board
        self.hello: HelloFrame | None = None
        self._serial = serial or SerialLink(path, board.baud)
        self._decoder = Decoder(self.board.frames)
        self._frames: list[Frame] = []  # that `ready` has found
        self._readied = -inf  # s, monotonic; when it was asked last
        self._received = 0  # bytes
        self._ends_at = 0  # of these bytes, with the last of the frame under way
        self._rests_until = inf  # s, monotonic; inf: does not rest
        self._seq = 0
        self._heard = 0.0
        self._strange = 0  # bytes since the last frame, or since the port was opened
        self._next_request = 0.0
        self._has_spoken = False  # lately
        self._spoke = -inf  # s, monotonic; when bytes came last
        self.mismatch = NO_TROUBLE
        """Why the board that answers is not the right one."""
        self._silence = NO_TROUBLE  # why the port was closed last, until a board answers
        self._reporting = False  # the board has said more than hello since the port was opened

    def descriptor(self) -> int | None:
        """None while the port is closed, and while it rests."""
        return self._serial.descriptor() if self._rests_until == inf else None

    def wait(self, now: float) -> float:
        """Seconds until the rest is over, and `poll` is due; inf when it does not rest. `now`: monotonic."""
        return max(0.0, self._rests_until - now)

    @property
    def opened(self) -> int:
        """How often the port was opened."""
        return self._serial.opened

    @property
    def fault(self) -> Trouble:
        """Why there are no frames; NO_TROUBLE when there may be."""
        if self.board.is_process and self._serial.fault == NO_PORT.of(self._serial.path):
            silent = f"the process {self.board.unit} does not run, or its controller does not answer"
            return Trouble(f"{self._serial.path} is not there: {silent}", f"journalctl -u {self.board.unit}")
        if self._reporting:
            return self._serial.fault or self.mismatch
        waits = Trouble(f"{self._serial.path}: no reports from a {self.board.name} board yet")
        return self._serial.fault or self.mismatch or self._silence or waits

    @property
    def line_errors(self) -> int:
        """Frames that arrived torn or wrong."""
        return self._decoder.crc_errors + self._decoder.shape_errors

    def ready(self, now: float) -> bool:
        """Read what has arrived. True: there are frames for `poll`, or the port was opened or closed.

        `now`: monotonic, s.
        """
        opened, self._readied = self.opened, now
        arrived = self._receive(now)
        self._frames += arrived
        return bool(self._frames) or self.opened != opened or self._serial.descriptor() is None

    def poll(self, now: float) -> list[Frame]:
        """Return the frames that have arrived, and keep the port open where `ready` does not. `now`: monotonic, s."""
        arrived = [] if now - self._readied < _READS_AGAIN else self._receive(now)
        frames, self._frames = self._frames + arrived, []
        return frames

    def _receive(self, now: float) -> list[Frame]:
        if self._serial.keep_open(now):
            self._frames = []
            self._decoder = Decoder(self.board.frames)
            self.hello = None
            self.mismatch = NO_TROUBLE  # another board may be there now
            self._reporting = False
            self._heard = now
            self._next_request = now
            self._strange = 0
            self._spoke = -inf
        self._serial.flush()
        data = self._serial.read()
        arrived = self._decoder.feed(data)
        self._rest(len(data), now)
        self._strange += len(data)
        if data:
            self._spoke = now
        self._has_spoken = now - self._spoke < LATELY
        if arrived:
            self._heard, self._strange = now, 0
            self._silence = NO_TROUBLE
        frames = [frame for frame in arrived if self._accept(frame)]
        if self._serial.descriptor() is not None:
            if now - self._heard > SILENCE:
                self._silence = self._why_silent(now - self._heard)
                self._serial.close(self._silence)
            elif self._has_spoken and self.hello is None and now >= self._next_request:
                self._next_request = now + HELLO_PERIOD
                self._seq = (self._seq + 1) & 0xFFFF
                self.send(HelloRequestFrame(seq=self._seq))
        return frames

    def _why_silent(self, lasted: float) -> Trouble:
        """Return why no frame has come for `lasted` s. Another device is told once, whatever its rate is then."""
        silent = _SILENT.of(self._serial.path)
        if self._strange < _STRANGE or (self._silence and self._silence != silent):
            return silent if self._strange < _STRANGE else self._silence
        what = f"it sends {self._strange / lasted:.0f} bytes/s that are not this board's frames"
        return Trouble(what, "see whether it is another device; correct `port`, or flash the board").of(
            self._serial.path
        )

    def send(self, frame: Frame) -> None:
        """Send `frame`; a newer one replaces it until the kernel has begun to take it.

        Nothing is kept for a board that has not spoken lately.
        """
        if self._has_spoken:
            self._serial.send(encode(frame.pack()))

    def close(self) -> None:
        """Let go of the port."""
        self._serial.close(Trouble(f"{self._serial.path}: closed"))

    def _rest(self, received: int, now: float) -> None:
        """Begin to rest once for each frame, when its kind is known; end when its last byte may be there."""
        self._received += received
        missing = self._decoder.missing
        ends_at = self._received + missing
        if ends_at != self._ends_at or not missing:  # else it is the same, and late if the rest is over
            self._ends_at = ends_at
            self._rests_until = now + missing * _BITS / self._serial.baud
        if now >= self._rests_until:
            self._rests_until = inf

    def _accept(self, frame: Frame) -> bool:
        if isinstance(frame, HelloFrame):
            self.mismatch = self._judge(frame)
            self.hello = None if self.mismatch else frame
        elif self.hello is not None:
            self._reporting = True
        return self.hello is not None

    def _judge(self, hello: HelloFrame) -> Trouble:
        path = self._serial.path
        if hello.board != self.board.number:
            there = _board_of(hello.board)
            name = f"kind {hello.board}" if there is None else there.name
            told = f"{path}: a {name} board is there, not a {self.board.name} board"
            if there is None or not there.chosen_in or there.chosen_in != self.board.chosen_in:
                return Trouble(told, "swap the ports")
            # Flashing comes first: another robot's program may be on the right board.
            chosen = f'or, if that one is right, write board = "{name}" into {there.chosen_in}'
            return Trouble(told, f"{self.board.flash_advice(path)}; {chosen}")
        ours = self.board.protocol_hash
        if hello.protocol_hash != ours:
            return Trouble(
                f"{path}: the board speaks protocol {hello.protocol_hash:08x}, this program {ours:08x}",
                f"re{self.board.flash_advice(path)}",
            )
        return NO_TROUBLE


def _board_of(number: int) -> BoardType | None:
    return next((board for board in ALL_BOARDS if board.number == number), None)

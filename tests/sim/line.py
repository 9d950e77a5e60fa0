"""The host's end of a board's UART, in simulated time."""

from collections.abc import Callable
from typing import TypeVar

import msgspec

from giraff_base.drives.wheels.config import by_levels
from giraff_schemas.boards import BOARDS
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.wire import (
    BoardKind,
    ConfigureFrame,
    DriveFrame,
    EstopFrame,
    Frame,
    HelloFrame,
    SpeedFrame,
    WheelsFrame,
    Wiring,
)
from giraff_sim.simulation import Simulation

FrameT = TypeVar("FrameT", bound=Frame)


class Line:
    """Collects a board's frames and queues the host's bytes, as the kernel does."""

    def __init__(self, simulation: Simulation, kind: BoardKind) -> None:
        self.simulation = simulation
        self.frames: list[tuple[int, Frame]] = []
        """With the simulated us at which each had arrived."""
        self.received = bytearray()
        """Every byte the board has sent."""
        self._kind = kind
        self._decoder = Decoder(BOARDS[kind].frames)
        self._queued = b""

    @property
    def damaged(self) -> int:
        return self._decoder.crc_errors + self._decoder.shape_errors

    @property
    def queued(self) -> int:
        """Bytes that still wait for room in the board's adapter."""
        return len(self._queued)

    def send(self, frame: Frame) -> None:
        self.send_bytes(encode(frame.pack()))

    def send_bytes(self, data: bytes) -> None:
        self._queued += data

    def step(self) -> None:
        """A millisecond."""
        self.push()
        self.simulation.step()
        self.pull()

    def push(self) -> None:
        """Give the board's adapter what it has room for."""
        if self._queued:
            self._queued = self._queued[self.simulation.write(self._kind, self._queued) :]

    def pull(self) -> None:
        """Take what the board has sent."""
        self.take(self.simulation.read(self._kind), self.simulation.now_us)

    def take(self, data: bytes, at_us: int) -> None:
        """Take what has been read of the board elsewhere, at a simulated us."""
        if data:
            self.received += data
            self.frames += [(at_us, frame) for frame in self._decoder.feed(data)]

    def run(self, seconds: float, each_step: Callable[[], None] | None = None) -> None:
        for _ in range(round(seconds * 1000)):
            if each_step is not None:
                each_step()
            self.step()

    def all(self, kind: type[FrameT]) -> list[FrameT]:
        return [frame for _, frame in self.frames if isinstance(frame, kind)]

    def last(self, kind: type[FrameT]) -> FrameT:
        """The newest frame of a kind; there must have been one."""
        return next(frame for _, frame in reversed(self.frames) if isinstance(frame, kind))


class BaseLine(Line):
    """A host that configures the base board and drives it."""

    def __init__(self, simulation: Simulation) -> None:
        super().__init__(simulation, BoardKind.BASE)
        self._seq = 0

    @property
    def wheels(self) -> WheelsFrame:
        """The newest telemetry."""
        return self.last(WheelsFrame)

    def boot(self) -> HelloFrame:
        """Wait for the first telemetry; the hello before it."""
        while not self.all(WheelsFrame):
            self.step()
        return self.last(HelloFrame)

    def configure(self, *, wiring: int = 0, level_max: int = 70, stall_level: int = 25, session: int = 7) -> None:
        """Open a session of levels and wait until the board knows it."""
        self.begin_session(by_levels(Wiring(wiring), level_max, stall_level), session)

    def begin_session(self, settings: ConfigureFrame, session: int = 7) -> None:
        """Open a session and wait until the board knows it."""
        self.send(
            msgspec.structs.replace(
                settings, boot_id=self.wheels.boot_id, board_ms=self.wheels.board_ms, session=session
            )
        )
        self.run(0.03)
        assert self.wheels.session == session

    def drive_frame(self, left: int, right: int) -> DriveFrame:
        """The next frame, made from the newest telemetry."""
        self._seq += 1
        wheels = self.wheels
        return DriveFrame(
            seq=self._seq & 0xFFFF,
            boot_id=wheels.boot_id,
            board_ms=wheels.board_ms,
            left_level=left,
            right_level=right,
        )

    def drive(self, left: int, right: int, seconds: float = 0.0) -> None:
        """Ask for levels every 20 ms, for a while; once without one."""
        for step in range(max(1, round(seconds * 1000))):
            if step % 20 == 0:
                self.send(self.drive_frame(left, right))
            self.step()

    def speed_frame(self, left: float, right: float) -> SpeedFrame:
        """The next frame, made from the newest telemetry; m/s."""
        self._seq += 1
        wheels = self.wheels
        return SpeedFrame(
            seq=self._seq & 0xFFFF,
            boot_id=wheels.boot_id,
            board_ms=wheels.board_ms,
            left_um_s=round(left * 1e6),
            right_um_s=round(right * 1e6),
        )

    def go(self, left: float, right: float, seconds: float = 0.0) -> None:
        """Ask for speeds, m/s, every 20 ms, for a while; once without one."""
        for step in range(max(1, round(seconds * 1000))):
            if step % 20 == 0:
                self.send(self.speed_frame(left, right))
            self.step()

    def estop(self, *, engage: bool) -> None:
        """Latch or release, by a frame made from the newest telemetry, and wait until the board has told of it."""
        wheels = self.wheels
        self.send(
            EstopFrame(
                seq=0, boot_id=wheels.boot_id, board_ms=wheels.board_ms, session=wheels.session, engage=int(engage)
            )
        )
        self.run(0.03)

    def start(self, *, wiring: int = 0, stall_level: int = 25) -> None:
        """From power-on to a session that drives."""
        self.boot()
        self.configure(wiring=wiring, stall_level=stall_level)
        self.drive(0, 0, 0.1)

"""A board on the bench: its serial line and its pins, millisecond by millisecond of simulated time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import msgspec

from giraff_schemas.framing import Decoder, encode
from giraff_schemas.wire import PROTOCOL_HASH, ConfigureFrame, DriveFrame, EstopFrame, Frame, WheelsFrame
from giraff_sim.board import Board

FrameT = TypeVar("FrameT", bound=Frame)


class Bench:
    """Runs a board and collects its frames."""

    def __init__(self, board: Board) -> None:
        self.board = board
        self.now_ms = 0
        self.frames: list[Frame] = []
        self.arrived_ms: list[int] = []
        """When each frame had arrived, whole."""
        self.before_each_ms: Callable[[], None] = lambda: None
        self._decoder = Decoder()

    @property
    def model(self) -> Any:
        """The board's struct board_model."""
        return self.board.model

    @property
    def damaged(self) -> int:
        """Frames of the board that came damaged: there is no noise, so there are none."""
        return self._decoder.crc_errors + self._decoder.shape_errors

    def run(self, milliseconds: int) -> None:
        for _ in range(milliseconds):
            self.before_each_ms()
            self.now_ms += 1
            self.board.run(self.now_ms * 1000)
            frames = self._decoder.feed(self.board.read())
            self.frames += frames
            self.arrived_ms += [self.now_ms] * len(frames)

    def send(self, frame: Frame) -> None:
        self.send_bytes(encode(frame.pack()))

    def send_bytes(self, data: bytes) -> None:
        assert self.board.write(data) == len(data)

    def all(self, kind: type[FrameT]) -> list[FrameT]:
        return [frame for frame in self.frames if isinstance(frame, kind)]

    def arrivals(self, kind: type[Frame]) -> list[int]:
        """When, in ms, each frame of a kind had arrived."""
        return [at for at, frame in zip(self.arrived_ms, self.frames, strict=True) if isinstance(frame, kind)]

    def last(self, kind: type[FrameT]) -> FrameT:
        return self.all(kind)[-1]

    def forget(self) -> None:
        """Begin to collect anew."""
        self.frames.clear()
        self.arrived_ms.clear()


class BaseBench(Bench):
    """The base board, and a host that knows how to drive it."""

    def __init__(self, board: Board) -> None:
        super().__init__(board)
        self.seq = 0
        self.run(15)

    def wheels(self) -> WheelsFrame:
        return self.last(WheelsFrame)

    def duties(self) -> tuple[float, ...]:
        """What the motors got in the last millisecond, PWM counts on average."""
        return self.model.motor[0].drive, self.model.motor[1].drive

    def configure_frame(self, **changes: int) -> ConfigureFrame:
        wheels = self.wheels()
        good = ConfigureFrame(
            seq=0,
            protocol_hash=PROTOCOL_HASH,
            boot_id=wheels.boot_id,
            board_ms=wheels.board_ms,
            session=7,
            wiring=0,
            level_max=70,
            stall_level=255,  # no test's level: wheels here only turn when a test turns them
        )
        return msgspec.structs.replace(good, **changes)

    def drive_frame(self, left: int, right: int, **changes: int) -> DriveFrame:
        """The next frame of a healthy host, made from the newest telemetry, but for `changes`."""
        self.seq = (self.seq + 1) & 0xFFFF
        wheels = self.wheels()
        good = DriveFrame(
            seq=self.seq,
            boot_id=wheels.boot_id,
            board_ms=wheels.board_ms,
            left_level=left,
            right_level=right,
        )
        return msgspec.structs.replace(good, **changes)

    def estop_frame(self, **changes: int) -> EstopFrame:
        """A healthy host's that engages, made from the newest telemetry, but for `changes`."""
        wheels = self.wheels()
        good = EstopFrame(seq=0, boot_id=wheels.boot_id, board_ms=wheels.board_ms, session=wheels.session, engage=1)
        return msgspec.structs.replace(good, **changes)

    def configure(self, **changes: int) -> None:
        """Open a session and wait until telemetry tells of it."""
        self.send(self.configure_frame(**changes))
        self.run(20)

    def drive(self, left: int, right: int, milliseconds: int = 20) -> None:
        """Ask for levels every 20 ms."""
        for _ in range(milliseconds // 20):
            self.send(self.drive_frame(left, right))
            self.run(20)

    def stopped_after_ms(self, each_ms: Callable[[], None] = lambda: None) -> int:
        """How long from now the motors still get something, while the host does `each_ms`."""
        began = self.now_ms
        while self.duties() != (0, 0):
            assert self.now_ms - began < 2000, "the motors are still driven"
            each_ms()
            self.run(1)
        return self.now_ms - began

    def start(self, left: int = 0, right: int = 0) -> None:
        """From power-on to driving."""
        self.configure()
        self.drive(0, 0)
        self.drive(left, right, 60)
        assert self.duties() == (left, right)

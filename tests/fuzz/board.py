"""Fuzzes one board's C until so many bytes have reached it.

Usage: board.py LIBRARY SEED BYTES, in a process of its own, under sanitizers. Prints what was counted, as JSON.
The base board has a sound host as well, which configures it, releases its latch and sends zero drive frames: what
is thrown at it in between meets a board that would drive.
"""

import random
import sys
from pathlib import Path
from typing import Final

import msgspec

from giraff_base.drives.wheels.config import by_levels
from giraff_schemas import boards
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.wire import (
    ECHO_MAX_AGE_MS,
    BoardKind,
    DriveFrame,
    DriveState,
    EstopFrame,
    Frame,
    TickFrame,
    WheelsFrame,
    Wiring,
)
from giraff_sim.board import Board
from tests.firmware.noise import noise
from tests.fuzz.growth import LIMIT, Growth

BOARDS: Final = ("base", "joystick", "ranger")
_HOST_MS: Final = 20  # between two frames of the sound host
_SESSION: Final = 7
_LEVEL_MAX: Final = 70
_WAITING: Final = 100  # bytes on their way: with more the sound host's frames come too late


class BoardCounted(msgspec.Struct, frozen=True, kw_only=True):
    """What became of the bytes."""

    board: str
    bytes: int
    simulated_s: float
    active_reports: int | None
    """Of the base board: reports of a board that would have driven."""
    peak_counts: int
    torn: int
    complaints: int
    growth_bytes: int


class SoundHost:
    """Keeps a base board active, and asks for nothing."""

    def __init__(self) -> None:
        self.seq = 0
        self.wheels: WheelsFrame | None = None
        self.active = 0
        """Reports of a board that would drive."""

    def on_frame(self, frame: Frame) -> None:
        if isinstance(frame, WheelsFrame):
            self.wheels = frame
            self.active += frame.drive_state == DriveState.ACTIVE

    def frame(self) -> Frame | None:
        """What it has to say now."""
        wheels = self.wheels
        if wheels is None:
            return None
        self.seq = (self.seq + 1) & 0xFFFF
        at = {"seq": self.seq, "boot_id": wheels.boot_id, "board_ms": wheels.board_ms}
        if wheels.session != _SESSION:
            return msgspec.structs.replace(by_levels(Wiring(0), _LEVEL_MAX, 255), **at, session=_SESSION)
        if wheels.latch:
            return EstopFrame(**at, session=_SESSION, engage=0)
        return DriveFrame(**at, left_level=0, right_level=0)

    def forged(self, chance: random.Random) -> bytes:
        """A drive frame that asks for motion, and is right but for one thing."""
        if self.wheels is None:
            return b""
        good = DriveFrame(
            seq=(self.seq + 1) & 0xFFFF,
            boot_id=self.wheels.boot_id,
            board_ms=self.wheels.board_ms,
            left_level=chance.randint(1, _LEVEL_MAX),
            right_level=chance.randint(-_LEVEL_MAX, -1),
        )
        wrong = chance.choice(
            (
                {"boot_id": good.boot_id + chance.choice((-1, 1, 1 << 16)) & 0xFFFFFFFF},
                {"board_ms": good.board_ms - chance.randint(ECHO_MAX_AGE_MS + 1, 1 << 20) & 0xFFFFFFFF},
                {"board_ms": good.board_ms + chance.randint(1000, 1 << 20) & 0xFFFFFFFF},
                {"seq": good.seq - chance.randint(50, 0x7000) & 0xFFFF},
                {"left_level": chance.choice((_LEVEL_MAX + 1, -_LEVEL_MAX - 1, 32767, -32768))},
            )
        )
        frame = encode(msgspec.structs.replace(good, **wrong).pack())
        if chance.random() < 0.7:
            return frame
        torn = bytearray(encode(good.pack()))
        torn[chance.randrange(len(torn) - 1)] ^= 1 << chance.randrange(8)
        return bytes(torn)


def thrown(chance: random.Random, host: SoundHost | None) -> bytes:
    """What reaches the board next."""
    if host is not None and chance.random() < 0.3:
        return b"\0" + host.forged(chance)
    if host is None and chance.random() < 0.2:
        return encode(TickFrame(chance.randrange(1 << 16), chance.randrange(1 << 32), chance.randrange(1 << 64)).pack())
    return noise(chance)


def fuzz(library: Path, seed: str, wanted: int, growth: Growth | None = None) -> BoardCounted:
    """Throw `wanted` bytes at the board of this library."""
    chance = random.Random(seed)
    kind = BoardKind[library.stem.upper()]
    board = Board(boards.BOARDS[kind], library)
    board.on_ping(lambda _sensor: chance.choice((0.0, -1.0, chance.uniform(0, 200_000))))
    board.model.twi_address = 0x28
    host = SoundHost() if kind is BoardKind.BASE else None
    decoder = Decoder()
    room = board.model.rx_free
    now_ms = 0
    while board.model.rx_total < wanted:
        now_ms += 1
        if host is not None and now_ms % _HOST_MS == 0 and (frame := host.frame()) is not None:
            board.write(b"\0" + encode(frame.pack()))  # the zero ends what the noise has begun
        while room - board.model.rx_free < _WAITING:
            board.write(thrown(chance, host))
        board.run(now_ms * 1000)
        for each in decoder.feed(board.read()):
            if host is not None:
                host.on_frame(each)
        if growth is not None:
            growth.look(board.model.rx_total / wanted)
    counted = BoardCounted(
        board=library.stem,
        bytes=board.model.rx_total,
        simulated_s=now_ms / 1000,
        active_reports=host.active if host else None,
        peak_counts=max(motor.drive_peak for motor in board.model.motor),
        torn=decoder.crc_errors + decoder.shape_errors,
        complaints=board.model.errors,
        growth_bytes=growth.bytes if growth is not None else 0,
    )
    board.close()
    return counted


def require_harmless(counted: BoardCounted) -> None:
    assert counted.peak_counts == 0, "noise drives"
    assert (counted.torn, counted.complaints) == (0, 0), counted
    assert counted.growth_bytes < LIMIT, counted
    assert counted.active_reports is None or counted.active_reports > counted.simulated_s * 20, "it would have driven"


def main() -> int:
    library, seed, wanted = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    print(msgspec.json.encode(fuzz(library, seed, wanted, Growth())).decode())
    return 0


if __name__ == "__main__":
    sys.exit(main())

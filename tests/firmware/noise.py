"""Throws noise at boards for a while; run in a process of its own, under sanitizers.

Usage: noise.py MILLISECONDS LIBRARY...
Prints how many line errors each board has counted.
"""

import random
import sys
from pathlib import Path

from giraff_schemas.boards import BALANCER_BOARD, BOARDS, ROBOCLAW_BOARD, BoardType
from giraff_schemas.framing import Decoder, encode
from giraff_schemas.wire import (
    FRAME_CLASSES,
    ConfigureFrame,
    DriveFrame,
    EstopFrame,
    Frame,
    HelloRequestFrame,
    RangeFrame,
    SpeedFrame,
    TickFrame,
    TiltFrame,
    WheelsFrame,
)
from giraff_schemas.wires import balancer as balancer_wire
from giraff_sim.board import Board

HOST_FRAMES: tuple[type[Frame], ...] = (
    HelloRequestFrame,
    ConfigureFrame,
    DriveFrame,
    SpeedFrame,
    EstopFrame,
    TickFrame,
)
FRAMES: tuple[type[Frame], ...] = (*HOST_FRAMES, *FRAME_CLASSES.values(), *balancer_wire.FRAME_CLASSES.values())
TYPES: dict[str, BoardType] = {board.name: board for board in (*BOARDS.values(), BALANCER_BOARD, ROBOCLAW_BOARD)}
SPOILT_MS, EACH_MS = 200, 1000


def noise(chance: random.Random) -> bytes:
    """Plain noise, a frame with random content, or a damaged frame."""
    if chance.random() < 0.4:
        return chance.randbytes(chance.randrange(1, 80))
    kind = chance.choice(FRAMES)
    frame = bytearray(encode(bytes([kind.type]) + chance.randbytes(kind.layout.size - 1)))
    if chance.random() < 0.5:
        frame[chance.randrange(len(frame))] = chance.randrange(256)
    return bytes(frame)


def spoil_line(board: Board, chance: random.Random, now_ms: int) -> None:
    """Let its controller hear and answer noise, for a while of each second, so that it proves itself in between."""
    is_spoilt = now_ms % EACH_MS < SPOILT_MS
    fault = chance.randrange(8) if is_spoilt else 0
    board.registers[0:17] = bytes([fault, 0, 1, *chance.randbytes(2), *bytes(12)])
    board.model.driver_line_cut = is_spoilt and chance.random() < 0.01
    if is_spoilt and chance.random() < 0.003:
        board.model.process_stalls = chance.choice([1, 2])


def line_errors(library: Path, milliseconds: int) -> int:
    """Throw noise at a board, whose name is the seed."""
    chance = random.Random(library.stem)
    board = Board(TYPES[library.stem], library)
    board.on_ping(lambda _sensor: chance.choice([0.0, -1.0, chance.uniform(0, 200_000)]))
    decoder = Decoder(board.type.frames)
    errors = 0
    for now_ms in range(1, milliseconds + 1):
        if chance.random() < 0.5:
            board.write(noise(chance))
        for motor in board.model.motor:
            motor.position += chance.uniform(-50, 50)
        board.model.sensor_volts = [chance.uniform(0, 3.3) for _ in range(4)]
        board.model.twi_address = chance.choice([0, 0x28, 0x28, 0x28])
        board.registers[0:64] = chance.randbytes(64) if chance.random() < 0.5 else bytes([0xA0, 0xFB]) + bytes(62)
        if board.type.is_process:
            spoil_line(board, chance, now_ms)
        if chance.random() < 0.001:
            board.reset()
        board.run(now_ms * 1000)
        for frame in decoder.feed(board.read()):
            if isinstance(frame, (WheelsFrame, TiltFrame, RangeFrame, balancer_wire.BalanceFrame)):
                errors = max(errors, frame.line_errors)
    assert decoder.crc_errors + decoder.shape_errors <= board.model.resets, f"more than resets tear frames of {library}"
    assert max(motor.drive_peak for motor in board.model.motor) == 0, f"noise drives {library}"
    assert board.model.errors == 0, board.message
    board.close()
    return errors


def main() -> int:
    milliseconds, *libraries = sys.argv[1:]
    print(*(line_errors(Path(library), int(milliseconds)) for library in libraries))
    return 0


if __name__ == "__main__":
    sys.exit(main())

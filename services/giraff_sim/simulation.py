"""Boards and world, stepped together in simulated time: the same calls give the same bytes on every UART.

A pacer holds that time to the wall's.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from giraff_schemas.boards import BOARDS, RANGER_BOARD, BoardType
from giraff_schemas.wire import BoardKind, ResetCause
from giraff_sim.board import BUILD, Board, Implementation, open_board
from giraff_sim.record import Record
from giraff_sim.world.bno055 import Bno055
from giraff_sim.world.world import World


class Simulation:
    """Any set of boards in one world.

    `step()` runs the world's step. Each board's UART is a pair of byte streams: `write` gives bytes to the
    board, which takes them at its baud, and `read` returns what it has sent.
    """

    def __init__(self, boards: Mapping[BoardKind, Board], world: World) -> None:
        self.boards = dict(boards)
        self.world = world
        self.record = Record(world.body.report, world.body.board.frames)
        self.now_us = 0
        """Simulated us since the power-on of all boards."""
        self._sent = {kind: bytearray() for kind in self.boards}
        self._base = self.boards.get(BoardKind.BASE)
        if self._base is not None:
            for encoder, disk in enumerate(world.body.disks):
                self._base.set_disk(encoder, disk)
        self._joystick = self.boards.get(BoardKind.JOYSTICK)
        self.bno055: Bno055 | None = None
        """The sensor on the joystick's bus, where there is a joystick."""
        if self._joystick is not None:
            self.bno055 = Bno055(
                self._joystick.registers,
                world.sim.tilt_noise,
                f"{world.seed}/bno055",
                world.truth.accelerometer_offset,
            )
        self._ranger = self.boards.get(BoardKind.RANGER)
        if self._ranger is not None:
            self._ranger.on_ping(world.echo_us)

    def step(self) -> None:
        """Advance everything by the world's step."""
        self.now_us += self.world.step_us
        self._move_world()
        for kind, board in self.boards.items():
            board.run(self.now_us)
            if board.model.tx_len:
                sent = board.read()
                self._sent[kind] += sent
                if board is self._base:
                    self.record.note_sent(self.now_us, sent)
        if self._base is not None:
            body = self.world.body
            body.update(self._base)
            self.record.note_drive(self.now_us, body.activity, self.world.step_us)

    def run(self, seconds: float) -> None:
        """Advance by simulated seconds."""
        end = self.now_us + round(seconds * 1e6)
        while self.now_us < end:
            self.step()

    def read(self, kind: BoardKind) -> bytes:
        """What a board has sent since the last call."""
        sent = self._sent[kind]
        if not sent:
            return b""
        data = bytes(sent)
        sent.clear()
        return data

    def write(self, kind: BoardKind, data: bytes) -> int:
        """Send bytes to a board; how many its adapter has taken. Offer the rest again."""
        return self.boards[kind].write(data)

    def reset(self, kind: BoardKind, cause: ResetCause) -> None:
        """Reset a board's processor."""
        self.boards[kind].reset(cause)

    def _move_world(self) -> None:
        world = self.world
        world.step(self._base)
        if self._joystick is not None and self.bno055 is not None:
            model = self._joystick.model
            model.twi_address = self.bno055.step(self.now_us, bool(model.slave_reset), world.acceleration)
            model.button = int(world.button)
        if self._ranger is not None:
            for number, bumper in world.bumpers.items():
                self._ranger.model.bumper_open[number] = int(bumper.is_open(world.plant.pose))


@contextmanager
def simulation(
    world: World,
    kinds: tuple[BoardKind, ...] = tuple(BoardKind),
    implementation: Implementation = Implementation.AVR,
    build: Path = BUILD,
    ranger: BoardType = RANGER_BOARD,
) -> Iterator[Simulation]:
    """A simulation of the boards that the build holds, ended with the block."""
    types = {**BOARDS, BoardKind.BASE: world.body.board, BoardKind.RANGER: ranger}
    boards: dict[BoardKind, Board] = {}
    try:
        for kind in kinds:
            boards[kind] = open_board(types[kind], implementation, build)
        yield Simulation(boards, world)
    finally:
        for board in boards.values():
            board.close()


class WallPacer:
    """Lets simulated time go at the pace of the wall's, without bursts: says how long to wait before the next slice.

    Clocks are the caller's: seconds and simulated us.

    A simulation that is a little late runs on without waiting. One that is very late would rush through its
    backlog and outrun whoever commands the boards; it lets the time slip instead and counts it as skew.
    """

    def __init__(self, slip_after: float = 0.05) -> None:
        """`slip_after`: s."""
        self.skew = 0.0
        """s by which simulated time has slipped behind the wall's."""
        self.slips = 0
        """How often it did."""
        self._slip_after = slip_after
        self._start: float | None = None
        self._start_us = 0

    def wait(self, wall: float, simulated_us: int) -> float:
        """Seconds to wait now that the simulation has reached `simulated_us`; 0 when it is late."""
        if self._start is None:
            self._start, self._start_us = wall, simulated_us
        due = self._start + self.skew + (simulated_us - self._start_us) * 1e-6
        late = wall - due
        if late > self._slip_after:
            self.skew += late
            self.slips += 1
            return 0.0
        return max(0.0, -late)

"""A serial cable between a device and a host: bytes both ways, and the buffers of the kernel at its end."""

import hashlib
from typing import Final, Protocol

from giraff_node.boards.serial_link import IN_USE, NO_PORT, REOPEN_PERIOD, UNPLUGGED, SerialLink
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import BoardKind
from giraff_sim.hosts.event_queue import Action
from giraff_sim.simulation import Simulation

_KERNEL_BYTES: Final = 65536
"""Held for a reader that does not come; the rest is lost."""
_READ_BYTES: Final = 4096


class Device(Protocol):
    """Something at the far end of a cable."""

    def bytes_until(self, now_us: int) -> bytes:
        """Return what it has sent since the last call, until this simulated moment."""
        ...

    def receive(self, data: bytes) -> int:
        """Give it bytes; return how many it has room for. The rest is offered again."""
        ...


class BoardUart:
    """A simulated board at the far end of a cable."""

    def __init__(self, kind: BoardKind, simulation: Simulation) -> None:
        self._kind = kind
        self._simulation = simulation

    def bytes_until(self, now_us: int) -> bytes:
        del now_us  # the simulation has run the board until now
        return self._simulation.read(self._kind)

    def receive(self, data: bytes) -> int:
        return self._simulation.write(self._kind, data)


class Cable:
    """Carries bytes at once while it is plugged and nothing holds it up."""

    def __init__(self, device: Device, simulation: Simulation, *, frames: bool = False) -> None:
        """`frames`: the reader is woken by the end of a frame, not by each byte."""
        self.is_plugged = True
        self.holds_to_board = False
        """What the host sends waits in a buffer on its way, as in a USB adapter that hangs."""
        self.holds_to_host = False
        self.on_data: Action | None = None
        """Wakes whoever has the port open; None: nobody has."""
        self._passed = hashlib.sha256()
        self._device = device
        self._simulation = simulation
        self._frames = frames
        self._to_host = bytearray()
        self._arrived = bytearray()
        self._to_board = bytearray()

    def carry(self) -> None:
        """Move what the device has sent, and what it has room for."""
        data = self._device.bytes_until(self._simulation.now_us)
        if not (data or self._to_host or self._to_board):
            return
        if data:
            self._passed.update(b"<%d:" % self._simulation.now_us + data)
        if data and self.is_plugged and self.on_data is not None:
            self._to_host += data[: _KERNEL_BYTES - len(self._to_host)]
        if self._to_host and not self.holds_to_host and self.on_data is not None:
            wakes = not self._frames or 0 in self._to_host
            self._arrived += self._to_host
            self._to_host.clear()
            if wakes:  # a part of a frame would wake the reader to no effect
                self.on_data()
        if self._to_board and not self.holds_to_board:
            del self._to_board[: self._give(bytes(self._to_board))]

    def write(self, data: bytes) -> None:
        """Send bytes to the device."""
        if self._to_board or self.holds_to_board:
            self._to_board += data[: _KERNEL_BYTES - len(self._to_board)]
        else:
            self._to_board += data[self._give(data) :]

    def digest(self) -> bytes:
        """Of all that the device has sent and been given, with its times."""
        return self._passed.digest()

    def _give(self, data: bytes) -> int:
        taken = self._device.receive(data)
        self._passed.update(b">%d:" % self._simulation.now_us + data[:taken])
        return taken

    def read(self) -> bytes:
        """What has arrived at the host, as much as one call of the kernel gives."""
        data = bytes(self._arrived[:_READ_BYTES])
        del self._arrived[:_READ_BYTES]
        if self._arrived and self.on_data is not None:
            self.on_data()
        return data

    def plug(self) -> None:
        self.is_plugged = True

    def unplug(self) -> None:
        """Pull the cable out: what is under way is lost."""
        self.is_plugged = False
        self.flush()

    def flush(self) -> None:
        """Forget what the host's kernel holds. What a buffer on the way holds is out of its reach."""
        self._arrived.clear()
        if not self.holds_to_host:
            self._to_host.clear()
        if not self.holds_to_board:
            self._to_board.clear()


class CableEnd(SerialLink):
    """The port of one process at a cable, with `SerialLink`'s behaviour. One process at a time has it open."""

    def __init__(self, path: str, baud: int, cable: Cable | None, on_data: Action) -> None:
        """`cable`: None where there is no such port."""
        super().__init__(path, baud)
        self._cable = cable
        self._on_data = on_data
        self._is_open = False
        self._retry_at = 0.0

    def descriptor(self) -> int | None:
        return 0 if self._is_open else None

    def keep_open(self, now: float) -> bool:
        if self._is_open or now < self._retry_at:
            return False
        self._retry_at = now + REOPEN_PERIOD
        if self._cable is None or not self._cable.is_plugged:
            self.fault = NO_PORT.of(self.path)
            return False
        if self._cable.on_data is not None:
            self.fault = IN_USE.of(self.path)
            return False
        self._cable.flush()
        self._cable.on_data = self._on_data
        self._is_open = True
        self.fault = NO_TROUBLE
        self.opened += 1
        return True

    def close(self, why: Trouble) -> None:
        if self._is_open and self._cable is not None:
            self._cable.on_data = None
        self._is_open = False
        self.fault = why

    def read(self) -> bytes:
        if not self._is_open or self._cable is None:
            return b""
        if not self._cable.is_plugged:
            self.close(UNPLUGGED.of(self.path))
            return b""
        return self._cable.read()

    def send(self, frame: bytes) -> None:
        if self._is_open and self._cable is not None and self._cable.is_plugged:
            self._cable.write(frame)

    @property
    def is_idle(self) -> bool:
        return self._is_open

    def flush(self) -> None:
        """Nothing waits here: the cable takes all."""

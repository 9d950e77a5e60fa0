"""A serial link to a device that speaks bytes of its own: what has arrived, and since when it can have waited."""

from collections.abc import Callable
from typing import Final

from giraff_core.io import Arrival
from giraff_node.boards.serial_link import SerialLink
from giraff_schemas.trouble import Trouble

_MOST_READS: Final = 32
"""Reads of 4 KiB in one look. The kernel holds 17 of them for a reader that does not come."""


class ByteLink:
    """As `giraff_core.io.SerialPort`, over a port of this machine or of a simulated one."""

    def __init__(self, path: str, baud: int, clock: Callable[[], int], serial: SerialLink | None = None) -> None:
        """`clock`: `IO.robot_ns`, which goes on while the machine is suspended. `serial`: instead of a port of this
        machine."""
        self._link = serial or SerialLink(path, baud)
        self._clock = clock
        self._since_ns = clock()

    def descriptor(self) -> int | None:
        return self._link.descriptor()

    @property
    def fault(self) -> Trouble:
        return self._link.fault

    @property
    def is_idle(self) -> bool:
        return self._link.is_idle

    def poll(self, now: float) -> Arrival:
        """Keep the port open and return all that has arrived. `now`: monotonic, s."""
        opened = self._link.keep_open(now)
        self._link.flush()
        begun_ns = self._clock()
        pieces: list[bytes] = []
        # A short read does not say that the kernel holds no more: only one that finds nothing does.
        while len(pieces) < _MOST_READS and (piece := self._link.read()):
            pieces.append(piece)
        # The clock is read after the bytes: this process may have stood still before it read them.
        arrival = Arrival(b"".join(pieces), self._since_ns, self._clock(), opened)
        if len(pieces) < _MOST_READS:
            self._since_ns = begun_ns
        return arrival

    def send(self, data: bytes) -> None:
        self._link.send(data)

    def close(self) -> None:
        """Let go of the port."""
        self._link.close(Trouble(f"{self._link.path}: closed"))

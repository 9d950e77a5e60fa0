"""A serial port for each board: a pseudo terminal behind a path that outlives it."""

import os
import tty
from contextlib import suppress
from pathlib import Path

from giraff_schemas.wire import BoardKind
from giraff_sim.simulation import Simulation


class SerialPort:
    """The cable between a board and whoever opens `path`.

    The simulator keeps the terminal's other end open and raw, so that a reader may come and go. Unplugged,
    the path is gone and a reader sees an error, as of a USB adapter that was pulled out.
    """

    def __init__(self, kind: BoardKind, directory: Path) -> None:
        self.kind = kind
        self.path = directory / kind.name.lower()
        self.lost = 0
        """Bytes of the board that nobody took in time, or that no cable carried."""
        self._ours: int | None = None
        self._theirs: int | None = None
        self._pending = b""

    @property
    def is_plugged(self) -> bool:
        return self._ours is not None

    @property
    def descriptor(self) -> int | None:
        """Readable when the host has sent something."""
        return self._ours

    def plug(self) -> None:
        """Make the terminal and the path; plugged already is fine."""
        if self._ours is not None:
            return
        self._ours, self._theirs = os.openpty()
        tty.setraw(self._theirs)
        os.set_blocking(self._ours, False)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        fresh = self.path.with_name(f".{self.path.name}.new")
        fresh.unlink(missing_ok=True)
        fresh.symlink_to(os.ttyname(self._theirs))
        fresh.replace(self.path)

    def unplug(self) -> None:
        """Pull the cable; unplugged already is fine."""
        if self._ours is None or self._theirs is None:
            return
        self.path.unlink(missing_ok=True)
        os.close(self._ours)
        os.close(self._theirs)
        self._ours = self._theirs = None
        self._pending = b""

    def to_host(self, simulation: Simulation) -> None:
        """Pass on what the board has sent. What does not fit is lost, as on a wire."""
        data = simulation.read(self.kind)
        if not data:
            return
        written = 0
        if self._ours is not None:
            with suppress(BlockingIOError):
                written = os.write(self._ours, data)
        self.lost += len(data) - written

    def to_board(self, simulation: Simulation) -> None:
        """Pass on what the host has sent, as far as the adapter has room; the kernel keeps the rest."""
        if self._ours is None:
            return
        room = simulation.room_for(self.kind) - len(self._pending)
        if room > 0:
            with suppress(BlockingIOError):
                self._pending += os.read(self._ours, room)
        if self._pending:
            self._pending = self._pending[simulation.write(self.kind, self._pending) :]

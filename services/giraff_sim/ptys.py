"""A serial port for each device: a pseudo terminal behind a path that outlives it."""

import os
import tty
from contextlib import suppress
from pathlib import Path
from typing import Final

from giraff_sim.hosts.cable import Device

_ADAPTER_BYTES: Final = 256  # on their way to the device


class SerialPort:
    """The cable between a device and whoever opens `path`.

    The simulator keeps the terminal's other end open and raw, so that a reader may come and go. Unplugged,
    the path is gone and a reader sees an error, as of a USB adapter that was pulled out.
    """

    def __init__(self, device: Device, path: Path) -> None:
        self.path = path
        self.lost = 0
        """Bytes of the device that nobody took in time, or that no cable carried."""
        self._device = device
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

    def carry(self, now_us: int) -> None:
        """Pass bytes on, both ways. What the host does not take is lost; what the device does not take waits."""
        data = self._device.bytes_until(now_us)
        written = 0
        if self._ours is not None:
            with suppress(BlockingIOError):
                written = os.write(self._ours, data) if data else 0
            if room := _ADAPTER_BYTES - len(self._pending):
                with suppress(BlockingIOError):
                    self._pending += os.read(self._ours, room)
            if self._pending:
                self._pending = self._pending[self._device.receive(self._pending) :]
        self.lost += len(data) - written

"""A serial port whose other end is the test's."""

import os
import tty
from pathlib import Path


class FakePort:
    """A pty behind a symlink, as udev would make one. Unplug it, plug another in."""

    def __init__(self, link: Path) -> None:
        self.link = link
        self.master = self._slave = -1
        self.plug()

    def plug(self) -> None:
        self.master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self.master, False)
        self.link.unlink(missing_ok=True)
        self.link.symlink_to(os.ttyname(self._slave))

    def unplug(self) -> None:
        self.link.unlink(missing_ok=True)
        for descriptor in (self._slave, self.master):
            os.close(descriptor)
        self.master = self._slave = -1

    def say(self, data: bytes) -> None:
        os.write(self.master, data)

    def heard(self) -> bytes:
        """All that was sent to it so far and not yet taken."""
        data = b""
        while True:
            try:
                data += os.read(self.master, 65536)
            except BlockingIOError:
                return data

    def close(self) -> None:
        if self.master >= 0:
            self.unplug()

"""A serial port that comes and goes: opened by path, reopened by path, never waited for."""

import contextlib
import errno
import os
import termios
from typing import Final

import serial

from giraff_schemas.trouble import NO_TROUBLE, Trouble

REOPEN_PERIOD = 0.1  # s between two attempts
SETTLES = 0.05
"""s after opening, in which an adapter gives what a board said before that reset it."""
NO_PORT: Final = Trouble("no such port", "plug the board in, or correct `port` in the robot file")
_CORRECT: Final = "correct `port` in the robot file"
IN_USE: Final = Trouble("in use by another process", "end that one")
UNPLUGGED: Final = Trouble("unplugged", "it is opened again when it is back")
_NOT_PERMITTED: Final = Trouble("not permitted", "add this user to the group that owns the port (dialout)")
_LIKELY: Final = {
    errno.ENOENT: NO_PORT,
    **dict.fromkeys((errno.EACCES, errno.EPERM), _NOT_PERMITTED),
    **dict.fromkeys((errno.EAGAIN, errno.EBUSY), IN_USE),
    **dict.fromkeys((errno.EIO, errno.ENXIO, errno.ENODEV, errno.EBADF), UNPLUGGED),
    errno.ENOTTY: Trouble("no serial port", _CORRECT),
    errno.EISDIR: Trouble("a folder, no serial port", _CORRECT),
    errno.ELOOP: Trouble("a link that leads to itself", _CORRECT),
}
"""What an error number of a port probably means."""


class SerialLink:
    """Bytes in, frames out. Nothing here raises: `fault` says what is wrong, and the port is opened again."""

    def __init__(self, path: str, baud: int) -> None:
        self.path = path
        self.baud = baud
        self.fault = Trouble(f"{path}: not opened yet")
        """Why the port is closed; NO_TROUBLE while it is open."""
        self.opened = 0
        """How often the port was opened: a change means that whatever was under way is lost."""
        self._port: serial.Serial | None = None
        self._next_attempt = 0.0
        self._settled_at = 0.0
        self._is_settled = False
        self._unsent = b""  # rest of a frame that the kernel took in part: it must end before another begins
        self._waiting = b""  # newest frame that has not been begun

    def descriptor(self) -> int | None:
        return None if self._port is None else self._port.fileno()

    def keep_open(self, now: float) -> bool:
        """Try to open a closed port when it is time; whether it has just been opened. `now`: monotonic, s."""
        self._is_settled = now >= self._settled_at
        if self._port is not None or now < self._next_attempt:
            return False
        self._next_attempt = now + REOPEN_PERIOD
        self._settled_at, self._is_settled = now + SETTLES, False
        try:
            self._port = serial.Serial(self.path, self.baud, timeout=0, write_timeout=0, exclusive=True)
            # What was queued before now is of another life: of an earlier session, or of a board's earlier boot.
            self._port.reset_input_buffer()
            self._port.reset_output_buffer()
            _set_line(self._port.fileno())
        except (serial.SerialException, OSError, ValueError, termios.error) as error:
            self.close(_explain(self.path, error))
            return False
        self.fault = NO_TROUBLE
        self.opened += 1
        return True

    def close(self, why: Trouble) -> None:
        """Close the port because of `why`; it is opened again when it is time."""
        if self._port is not None:
            with contextlib.suppress(serial.SerialException, OSError):  # a device that is gone is closed all the same
                self._port.close()
            self._port = None
        self._unsent = self._waiting = b""
        self.fault = why

    def read(self) -> bytes:
        """What has arrived; empty when nothing has, or the port is closed."""
        if self._port is None:
            return b""
        try:
            data = os.read(self._port.fileno(), 4096)
        except BlockingIOError:
            return b""
        except OSError as error:
            self.close(_explain(self.path, error))
            return b""
        # A dead port reads as b"". So does a live one where another program has set VMIN=0, but its status can be read.
        if not data:
            try:
                _ = self._port.in_waiting
            except OSError as error:
                self.close(_explain(self.path, error))
        return data if self._is_settled else b""

    def send(self, frame: bytes) -> None:
        """Send `frame` as soon as the kernel takes it; a newer one replaces it until then.

        While the port is closed nothing is kept: it would be sent in another life of the port.
        """
        if self._port is not None:
            self._waiting = frame
            self.flush()

    @property
    def is_idle(self) -> bool:
        """The port is open, and all that was sent is the kernel's."""
        return self._port is not None and not self._unsent and not self._waiting

    def flush(self) -> None:
        """Go on with what could not be sent at once."""
        if self._port is None:
            return
        try:
            while self._unsent or self._waiting:
                frame = self._unsent or self._waiting
                taken = os.write(self._port.fileno(), frame)
                if not self._unsent:
                    self._waiting = b""
                self._unsent = frame[taken:]
                if self._unsent:
                    return
        except BlockingIOError:
            return
        except OSError as error:
            self.close(_explain(self.path, error))


def _set_line(descriptor: int) -> None:
    """Make a read without data an error, which pyserial's VMIN=0 makes look like the end of a dead port.

    And let DTR stay when the port is closed: an Arduino is reset as it comes back, and then is in its boot loader for
    1 to 2 s. A port that is opened again and again because of that silence would never hear its program.
    """
    attributes = termios.tcgetattr(descriptor)
    attributes[2] &= ~termios.HUPCL
    attributes[6][termios.VMIN] = 1
    termios.tcsetattr(descriptor, termios.TCSANOW, attributes)


def _explain(path: str, error: Exception) -> Trouble:
    """What `error` on the port `path` probably means."""
    # pyserial hands on an error of termios as a text alone.
    number = getattr(error, "errno", None) or next(iter(getattr(error.__context__, "args", ())), None)
    return _LIKELY.get(number or 0, Trouble(str(error))).of(path)

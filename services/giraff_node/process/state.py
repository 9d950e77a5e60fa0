"""What a service keeps across restarts: small files that are whole on disk, or not there."""

import contextlib
import errno
import os
import stat
import threading
from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path
from queue import SimpleQueue

from giraff_core.estop.latch import LATCH_FILE, EStopLatch, latch_bytes


def state_directory(robot: str, environment: Mapping[str, str] = os.environ) -> Path:
    """Where this robot's state is kept: $STATE_DIRECTORY as systemd gives it, else the XDG state folder."""
    given = environment.get("STATE_DIRECTORY", "").partition(":")[0]
    if given:
        return Path(given)
    home = Path(environment.get("XDG_STATE_HOME", ""))
    if not home.is_absolute():  # as the XDG specification has it: a relative one counts for nothing
        home = Path(environment.get("HOME", "/")) / ".local" / "state"
    return home / "giraff" / robot


def write_file_durably(path: Path, data: bytes) -> None:
    """Replace a file: after a power cut there is the old one or the new one, and once this returns the new one.

    It keeps its permissions and the links to it. Raises OSError; then it may be either. What is no plain file stays as
    it is: to replace a device, such as /dev/null, is the end of it for all programs.
    """
    try:
        path = path.resolve()
    except RuntimeError as error:  # links that lead to each other
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path)) from error
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "it is no plain file", str(path))
    fresh = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with fresh.open("wb") as file:
            with contextlib.suppress(FileNotFoundError):
                os.fchmod(file.fileno(), stat.S_IMODE(path.stat().st_mode))
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        fresh.replace(path)
    except OSError as error:
        if error.filename:  # a hidden one, which tells nobody anything
            error.filename = str(path)
        raise
    finally:
        with contextlib.suppress(OSError):
            fresh.unlink()
    folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(folder)  # the new name is only then on disk, too
    finally:
        os.close(folder)


def write_latch(directory: Path, latch: EStopLatch) -> None:
    """Keep the latch. Raises OSError."""
    _keep(directory / LATCH_FILE, latch_bytes(latch))


class Folder:
    """The state directory as a `Store`."""

    def __init__(self, directory: Path, wake: Callable[[], None] = lambda: None) -> None:
        """`wake`: called from another thread when a writer has news."""
        self._directory = directory
        self._wake = wake

    def path(self, name: str) -> str:
        return str(self._directory / name)

    def read(self, name: str) -> bytes:
        return (self._directory / name).read_bytes()

    def writer(self, name: str) -> "FileWriter":
        return FileWriter(self._directory / name, self._wake)


class FileWriter:
    """Writes a file in a thread of its own: a disk may hang for seconds."""

    def __init__(self, path: Path, wake: Callable[[], None]) -> None:
        self._path = path
        self._wake = wake
        self._wanted: SimpleQueue[bytes] = SimpleQueue()
        self._outcomes: deque[str] = deque()
        threading.Thread(target=self._run, name=path.name, daemon=True).start()

    def save(self, data: bytes) -> None:
        self._wanted.put(data)

    def outcome(self) -> str | None:
        return self._outcomes.popleft() if self._outcomes else None

    def _run(self) -> None:
        while True:
            data = self._wanted.get()
            try:
                _keep(self._path, data)
            except OSError as error:
                self._outcomes.append(f"{error.filename or self._path.name}: {error.strerror or error}")
            else:
                self._outcomes.append("")
            self._wake()


def _keep(path: Path, data: bytes) -> None:
    """As `write_file_durably`, in a folder that may not be there yet."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_file_durably(path, data)

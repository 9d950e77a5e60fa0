"""What a service keeps across restarts: small files that are whole on disk, or not there.

The emergency stop's latch is one, `estop.json`. A file that is missing, damaged or cannot be read says nothing, and
then the robot stays stopped.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
import threading
from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path
from queue import SimpleQueue
from typing import Final

import msgspec

from giraff_node.estop import RESET_COMMAND, EStopLatch

LATCH_FILE: Final = "estop.json"


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

    It keeps its permissions and the links to it. Raises OSError; then it may be either.
    """
    path = path.resolve()
    fresh = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with fresh.open("wb") as file:
            with contextlib.suppress(FileNotFoundError):
                os.fchmod(file.fileno(), stat.S_IMODE(path.stat().st_mode))
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        fresh.replace(path)
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
    directory.mkdir(parents=True, exist_ok=True)
    write_file_durably(directory / LATCH_FILE, msgspec.json.encode(latch) + b"\n")


def read_latch(directory: Path) -> EStopLatch:
    """The latch that was kept; an engaged one where none can be read."""
    path = directory / LATCH_FILE
    try:
        return msgspec.json.decode(path.read_bytes(), type=EStopLatch)
    except FileNotFoundError:
        why = f"{path} is missing, as at a first start"
    except OSError as error:
        why = f"{path} cannot be read: {error.strerror}"
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        why = f"{path} is damaged: {error}"
    return EStopLatch(
        engaged=True,
        id=secrets.randbelow(1 << 31) + 1,  # of the one that was lost nothing is known: not its id again
        by="base",
        reason=f"{why}; see that the robot may move, then {RESET_COMMAND}",
    )


class LatchSaver:
    """Writes latches in a thread of its own: a disk that hangs for seconds must not hold up drive frames."""

    def __init__(self, write: Callable[[EStopLatch], None]) -> None:
        self._write = write
        self._wanted: SimpleQueue[EStopLatch] = SimpleQueue()
        self._outcomes: deque[tuple[EStopLatch, str]] = deque()
        threading.Thread(target=self._run, name="estop", daemon=True).start()

    def save(self, latch: EStopLatch) -> None:
        """Begin to write; `outcome` tells how it went. One at a time."""
        self._wanted.put(latch)

    def outcome(self) -> tuple[EStopLatch, str] | None:
        """What was written and why it failed, empty when it is on disk; None: no news."""
        return self._outcomes.popleft() if self._outcomes else None

    def _run(self) -> None:
        while True:
            latch = self._wanted.get()
            try:
                self._write(latch)
            except OSError as error:
                self._outcomes.append((latch, f"{error.filename or LATCH_FILE}: {error.strerror or error}"))
            else:
                self._outcomes.append((latch, ""))

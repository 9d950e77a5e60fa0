"""Where this machine's healthchecks ask: a Unix socket that the service's own loop answers, so a hung one is seen.

Whoever connects is sent one JSON line and let go. Nothing is read of a client and nothing is kept of it.

Beside it lies a file with the faults, which the loop touches as long as it turns. Docker's check reads that one
(giraff_health/wait.sh): it must cost next to nothing, and Python's start alone is 9 ms.
"""

import contextlib
import fcntl
import os
import socket
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

import msgspec

from giraff_health.ask import socket_path
from giraff_node.process.unix_socket import listen_at
from giraff_schemas.health import Health
from giraff_schemas.trouble import NO_TROUBLE, Trouble

RETRY: Final = 1.0  # s between two attempts to become the one who answers
TOUCHED: Final = 0.5  # s between two signs of life; wait.sh looks for one in 2 s
_MOST: Final = 8  # clients answered in one turn of the loop, whose own work must not wait for a crowd


class HealthSocket:
    """`$RUNTIME_DIRECTORY/<service>.sock`; nothing without that variable. Nothing here waits or raises."""

    def __init__(self, service: str, environment: Mapping[str, str] = os.environ) -> None:
        self.fault = NO_TROUBLE
        """Why nobody is answered there."""
        self._service = service
        self._path = Path(socket_path(service, environment)) if environment.get("RUNTIME_DIRECTORY") else None
        self._listener: socket.socket | None = None
        self._lock = -1
        self._next_attempt = 0.0
        self._told: str | None = None
        """Faults in the file; None: no file of this process is known to be there."""
        self._next_touch = 0.0

    def descriptor(self) -> int | None:
        """Readable while a client waits."""
        return None if self._listener is None else self._listener.fileno()

    def keep_open(self, now: float) -> None:
        """Become the one who answers, when it is time to try. `now`: monotonic, s."""
        if self._path is None or self._listener is not None or now < self._next_attempt:
            return
        self._next_attempt = now + RETRY
        try:
            self._listener = self._open(self._path)
        except BlockingIOError:
            another = f"another giraff_{self._service} runs on this machine ({self._path})"
            self.fault = Trouble(another, "end one of the two")
        except OSError as error:
            self.fault = Trouble(
                f"{self._path}: healthchecks cannot ask there: {error.strerror or error}",
                "let RUNTIME_DIRECTORY name a directory that this user may write to",
            )
        else:
            self.fault = NO_TROUBLE

    def answer(self, health: Callable[[], Health]) -> None:
        """Answer those who wait."""
        if self._listener is None:
            return
        for _ in range(_MOST):
            try:
                client, _address = self._listener.accept()
            except OSError:  # nobody waits, or whoever did has gone
                return
            with client, contextlib.suppress(OSError):
                client.setblocking(False)
                client.send(msgspec.json.encode(health()) + b"\n")

    def update(self, now: float, faults: str) -> None:
        """Let the file hold `faults`, a line each, and show that the loop turns. `now`: monotonic, s."""
        if self._listener is None or self._path is None or (faults == self._told and now < self._next_touch):
            return
        self._next_touch = now + TOUCHED
        path = self._path.with_suffix(".faults")
        try:
            if faults == self._told:
                os.utime(path)
            else:
                self._told = None
                fresh = path.with_suffix(".faults.new")  # nobody reads half of it
                fresh.write_text(faults, encoding="utf-8")
                fresh.replace(path)
                self._told = faults
        except OSError as error:
            self._told = None
            self.fault = Trouble(f"{path}: {error.strerror or error}", "make room, or correct the directory's rights")
            with contextlib.suppress(OSError):
                path.unlink()  # where it cannot be written, an old word must not stay
        else:
            self.fault = NO_TROUBLE

    def close(self) -> None:
        """Answer nobody any more."""
        if self._listener is not None and self._path is not None:
            self._listener.close()
            self._listener = None
            for path in (self._path, self._path.with_suffix(".faults")):
                with contextlib.suppress(OSError):
                    path.unlink()
            os.close(self._lock)  # last: from here on the path is another's

    def _open(self, path: Path) -> socket.socket:
        """Listen at `path`. Raises OSError, and BlockingIOError while a living process does."""
        path.parent.mkdir(parents=True, exist_ok=True)
        # The kernel lets go of a dead process's lock, so whoever holds it may replace whatever socket is there.
        lock = os.open(path.with_suffix(".lock"), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            listener = listen_at(path)
        except OSError:
            os.close(lock)
            raise
        self._lock = lock
        return listener

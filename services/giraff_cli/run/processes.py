"""The processes of a run: none outlives it. Services have a log each, and the driver has the run's terminal."""

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from giraff_tools.terminal.service_log import cause_of

_LAUNCH: Final = Path(__file__).with_name("launch.py")
_POLL: Final = 0.01  # s between looks at processes that are about to end
_TAIL_BYTES: Final = 262_144  # a cause with its traceback is far shorter
_MOST_BYTES: Final = 16_777_216
"""Of a log. Beyond twice as many its beginning gives way, or a service that writes a lot would fill the disk."""
_BLOCK: Final = 65_536  # bytes; file systems free whole blocks
_FREE_BLOCKS: Final = 3  # FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE
_BY_OTHERS: Final = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
"""Signals that somebody else sends: the process cannot have written why."""
_HEARS_CTRL_C: Final = 0.5  # s; one that was typed is for this child, too
_DRIVER_GRACE: Final = 3.0  # s
_DRIVER: Final = "giraff drive"


class Driver:
    """A child that reads the terminal which both share: Ctrl-C is for both."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str]) -> None:
        """Standard input must be a terminal."""
        self._before = termios.tcgetattr(sys.stdin)
        self._process = subprocess.Popen(command, env=dict(environment))

    @property
    def is_there(self) -> bool:
        return self._process.poll() is None

    def end(self) -> str:
        """End it, and leave the terminal as it was before. Bounded. What went wrong; empty: nothing."""
        status = self._ended(_HEARS_CTRL_C)
        if status is None:
            self._process.terminate()
            status = self._ended(_DRIVER_GRACE)
        if status is None:
            self._process.kill()
            self._process.wait()
        with contextlib.suppress(termios.error):  # it may be gone
            termios.tcsetattr(sys.stdin, termios.TCSANOW, self._before)
        if status is None:
            return f"{_DRIVER} did not end within {_DRIVER_GRACE:g} s and was killed"
        if status in (0, -signal.SIGINT, -signal.SIGTERM):
            return ""
        return f"{_DRIVER} ended with exit code {status}; what it said is above"

    def _ended(self, within: float) -> int | None:
        with contextlib.suppress(subprocess.TimeoutExpired):
            return self._process.wait(within)
        return None


@dataclass(frozen=True)
class Ended:
    """A process that ended before it was told to."""

    name: str
    how: str
    """Like `exit code 1` or `killed, SIGKILL`."""
    cause: str
    """Why, in its own last words where it wrote any."""
    log: Path

    def __str__(self) -> str:
        return f"{self.name} ended by itself ({self.how}): {self.cause}; its log: {self.log}"

    @property
    def headline(self) -> str:
        """Who ended, how, and where to read on, in a row of a screen."""
        return f"{self.name} ended ({self.how}), see {self.log}"


class ProcessGroup:
    """Starts, watches and ends processes. To be used from the main thread: they live as long as it does."""

    def __init__(self, directory: Path) -> None:
        """`directory` takes the logs, NAME.log, and what goes to standard output, NAME.out."""
        self._directory = directory
        self._running: dict[str, subprocess.Popen[bytes]] = {}
        self.ended: dict[str, Ended] = {}
        """By name, all so far."""

    def start(self, name: str, module: str, arguments: Iterable[str], environment: Mapping[str, str]) -> None:
        """Start `python -m module` in a session of its own: Ctrl-C in the terminal is for its parent alone."""
        command = [sys.executable, "-P", "-X", "faulthandler", "-m", module, *arguments]
        launcher = [sys.executable, "-I", "-S", str(_LAUNCH), str(os.getpid())]
        with self.log(name).open("wb") as log, self.output(name).open("wb") as output:
            self._running[name] = subprocess.Popen(
                [*launcher, *command],
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=log,
                env=dict(environment),
                start_new_session=True,
            )

    def pid(self, name: str) -> int:
        """Of a process that has not ended."""
        return self._running[name].pid

    def log(self, name: str) -> Path:
        return self._directory / f"{name}.log"

    def output(self, name: str) -> Path:
        return self._directory / f"{name}.out"

    def reap(self) -> list[Ended]:
        """Those that have ended by themselves since the last call."""
        found = []
        for name, process in list(self._running.items()):
            status = process.poll()
            if status is not None:
                del self._running[name]
                self.ended[name] = Ended(name, _how(status), self._cause(name, status), self.log(name))
                found.append(self.ended[name])
            else:
                bound(self.log(name))
        return found

    def last_words(self, name: str, lines: int = 5) -> tuple[str, ...]:
        """The last lines of a log."""
        return tuple(self._tail(name)[-lines:])

    def _tail(self, name: str) -> list[str]:
        with self.log(name).open("rb") as log:
            log.seek(max(0, log.seek(0, os.SEEK_END) - _TAIL_BYTES))
            return log.read().decode(errors="replace").removesuffix("\n").split("\n")

    def _cause(self, name: str, status: int) -> str:
        if -status in _BY_OTHERS:
            return "it was ended from outside: by hand, or by the kernel for want of memory"
        return cause_of(self._tail(name), crashed=status < 0) or "it did not say why"

    def stop(self, names: Iterable[str], grace: float) -> list[str]:
        """End these together and reap them: SIGTERM, and after `grace` seconds SIGKILL. Returns what went wrong."""
        processes = {name: self._running.pop(name) for name in names if name in self._running}
        for process in processes.values():
            process.terminate()
        deadline = time.monotonic() + grace
        while any(process.poll() is None for process in processes.values()) and time.monotonic() < deadline:
            time.sleep(_POLL)
        troubles = []
        for name, process in processes.items():
            if process.poll() is None:
                process.kill()
                troubles.append(f"{name} did not end within {grace:g} s and was killed")
            elif process.returncode > 0:
                troubles.append(f"{name} ended with {_how(process.returncode)} when it was told to end")
            process.wait()
        return troubles

    def stop_all(self, grace: float) -> list[str]:
        return self.stop(list(self._running), grace)


def bound(log: Path, most: int = _MOST_BYTES) -> None:
    """Free the disk of the beginning of a log that has grown beyond twice as many bytes. Its writer need not know.

    The file keeps its length, and begins with a hole. Nothing that is written meanwhile is lost.
    """
    with contextlib.suppress(OSError), log.open("r+b") as file:
        status = os.fstat(file.fileno())
        if status.st_blocks * 512 > 2 * most:
            free = (status.st_size - most) // _BLOCK * _BLOCK
            ctypes.CDLL(None).fallocate64(file.fileno(), _FREE_BLOCKS, ctypes.c_int64(0), ctypes.c_int64(free))


def _how(status: int) -> str:
    if status >= 0:
        return f"exit code {status}"
    word = (signal.strsignal(-status) or "signal").lower()
    return f"{word}, {signal.Signals(-status).name}" if -status in set(signal.Signals) else f"{word}, {-status}"

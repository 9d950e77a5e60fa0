"""The processes of a run: none outlives it, each has a log, and whatever ends early is named."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

_LAUNCH: Final = Path(__file__).with_name("launch.py")
_POLL: Final = 0.01  # s between looks at processes that are about to end
_TAIL_BYTES: Final = 8192


@dataclass(frozen=True)
class Ended:
    """A process that ended before it was told to."""

    name: str
    how: str
    """Like `exit code 1` or `SIGKILL`."""
    last_words: tuple[str, ...]
    """The last lines of its log."""

    def __str__(self) -> str:
        said = "".join(f"\n    {line}" for line in self.last_words)
        return f"{self.name} ended by itself ({self.how}){', its log ends:' if said else ''}{said}"


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
        command = [sys.executable, "-P", "-m", module, *arguments]
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
                self.ended[name] = Ended(name, _how(status), self.last_words(name))
                found.append(self.ended[name])
        return found

    def last_words(self, name: str, lines: int = 5) -> tuple[str, ...]:
        """The last lines of a log."""
        with self.log(name).open("rb") as log:
            log.seek(max(0, log.seek(0, os.SEEK_END) - _TAIL_BYTES))
            text = log.read().decode(errors="replace")
        return tuple(text.splitlines()[-lines:])

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


def _how(status: int) -> str:
    return f"exit code {status}" if status >= 0 else signal.Signals(-status).name

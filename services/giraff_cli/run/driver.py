"""`giraff drive` in the terminal of a run: who has started the run drives."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import termios
from collections.abc import Mapping, Sequence
from typing import Final

_HEARS_CTRL_C: Final = 0.5  # s; one that was typed is for this child, too
_GRACE: Final = 3.0  # s
_NAME: Final = "giraff drive"


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
            status = self._ended(_GRACE)
        if status is None:
            self._process.kill()
            self._process.wait()
        with contextlib.suppress(termios.error):  # it may be gone
            termios.tcsetattr(sys.stdin, termios.TCSANOW, self._before)
        if status is None:
            return f"{_NAME} did not end within {_GRACE:g} s and was killed"
        if status in (0, -signal.SIGINT, -signal.SIGTERM):
            return ""
        return f"{_NAME} ended with exit code {status}; what it said is above"

    def _ended(self, within: float) -> int | None:
        with contextlib.suppress(subprocess.TimeoutExpired):
            return self._process.wait(within)
        return None

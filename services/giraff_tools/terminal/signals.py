"""Being told to end, while waiting for anything."""

import select
import signal
import socket
import time
from types import FrameType, TracebackType
from typing import Any, Final, Self

_SIGNALS: Final = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_AT_ONCE: Final = 3600.0
"""s. Longest single wait; the system refuses one of some centuries."""


class StopSignal:
    """In its block Ctrl-C, SIGTERM and a closed terminal raise nothing: they are counted, and end every `wait`."""

    def __init__(self) -> None:
        self.asked = 0
        """How often the end was asked for."""
        self._waker, self._wake_end = socket.socketpair()
        self._before: dict[signal.Signals, Any] = {}
        self._wakeup_before = -1

    def __enter__(self) -> Self:
        for end in (self._waker, self._wake_end):
            end.setblocking(False)
        self._before = {number: signal.signal(number, self._on_signal) for number in _SIGNALS}
        # Python runs a handler only between its own instructions; the descriptor wakes a wait at once.
        self._wakeup_before = signal.set_wakeup_fd(self._wake_end.fileno(), warn_on_full_buffer=False)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        signal.set_wakeup_fd(self._wakeup_before)
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._waker.close()
        self._wake_end.close()

    def ask(self) -> None:
        """Ask for the end, as a signal does."""
        self.asked += 1

    def wait(self, seconds: float, patience: int = 1) -> bool:
        """Wait; True, at once, when the end has been asked for `patience` times."""
        deadline = time.monotonic() + seconds
        while self.asked < patience:
            left = deadline - time.monotonic()
            if left <= 0.0:
                return False
            if select.select([self._waker], [], [], min(left, _AT_ONCE))[0]:
                self._waker.recv(4096)
        return True

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        del number, frame
        self.ask()

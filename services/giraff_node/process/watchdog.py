"""The end of a process whose loop hangs: a timer of the kernel that only a turning loop sets anew."""

import contextlib
import faulthandler
import os
import signal
from collections.abc import Mapping
from typing import Final

_ARMED_ANEW: Final = 3
"""Times in a period that a turning loop arms the timer."""
_WRITING: Final = 0.1
"""Share of the time that the writing of the stacks may take."""
_PERIODS_TO_END: Final = 2


def watchdog_period(environment: Mapping[str, str] = os.environ) -> float | None:
    """Return the time (s) without a turn after which this process must end. None: it may hang."""
    if environment.get("WATCHDOG_PID", str(os.getpid())) != str(os.getpid()):
        return None
    with contextlib.suppress(ValueError):
        microseconds = int(environment.get("WATCHDOG_USEC", "0"))
        return microseconds / 1e6 if microseconds > 0 else None
    return None


class Watchdog:
    """Ends this process by SIGALRM after a period without a turn, with the stack of each thread in its log.

    The kernel and C code do it: a loop that holds Python's lock ends like one that waits for ever. The handler of the
    first SIGALRM writes the stacks and ends the process, also when the process was frozen and wakes too late. Where
    nobody reads the log, the writing waits, and a second SIGALRM ends the process.

    It does nothing where $WATCHDOG_USEC is not set, because nobody there starts the process again.
    """

    def __init__(self, environment: Mapping[str, str] = os.environ) -> None:
        self._period = watchdog_period(environment)
        self._next: float | None = None
        """Monotonic time, s, from which a turn arms the timer; None before the first turn, which may take its time."""
        self._is_armed = False
        if self._period is not None:
            faulthandler.register(signal.SIGALRM, chain=True)

    def turn(self, now: float) -> None:
        """Note that the loop turns. `now`: monotonic, s."""
        if self._period is None or (self._next is not None and now < self._next):
            return
        if self._next is None:
            self._next = now
            return
        self._next = now + self._period / _ARMED_ANEW
        self._arm(self._period)

    def stopping(self) -> None:
        """Leave some time for the end of the process, which may hang like a turn."""
        if self._period is not None and self._is_armed:
            self._arm(_PERIODS_TO_END * self._period)

    def _arm(self, seconds: float) -> None:
        self._is_armed = True
        signal.setitimer(signal.ITIMER_REAL, seconds, _WRITING * seconds)


def disarm() -> None:
    """End the watch. Another program in the same process would inherit the timer, but not the stacks."""
    signal.setitimer(signal.ITIMER_REAL, 0.0)

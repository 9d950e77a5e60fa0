"""A program that goes on until SIGTERM or SIGINT: its log, its loop, what it tells of itself, and a clean end."""

from __future__ import annotations

import os
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from types import FrameType, MappingProxyType, TracebackType
from typing import Final, NoReturn

import zenoh

from giraff_core.io import Paced, Selectable
from giraff_node.network.session import close_session
from giraff_node.process.health import HealthState
from giraff_node.process.health_socket import HealthSocket
from giraff_node.process.logs import service_logger
from giraff_node.process.selector import Waker, wait_for
from giraff_node.process.systemd import Notifier

_LONGEST_WAIT: Final = 0.1  # s; bounds how late a turn notices what has no descriptor


def restart_program(marks: Mapping[str, str] = MappingProxyType({})) -> NoReturn:
    """Become the same program from its start, in the same process: whoever watches over it need not know.

    `marks`: of its environment, what it is to know of its past.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    words = [sys.executable, *sys.orig_argv[1:]]
    os.execve(sys.executable, words, {**os.environ, **marks})  # noqa: S606  the same words as before


class Process:
    """From here on signals end the loop, not the program. `name`: in logs, in health and for systemd."""

    def __init__(self, name: str) -> None:
        self.instance = os.urandom(8).hex()
        self.log = service_logger(name)
        self.condition = HealthState(name, self.instance, self.log)
        self._health_socket = HealthSocket(name)
        self._notifier = Notifier()
        self._failure: BaseException | None = None
        self._stopping = False
        self._again: Mapping[str, str] | None = None
        self._waker = Waker()
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._on_signal)
        signal.set_wakeup_fd(self._waker.for_signals, warn_on_full_buffer=False)

    def turns(
        self, *timers: Paced, link: Selectable | None = None, look: Callable[[float], None] = lambda _: None
    ) -> Iterator[float]:
        """Yield the monotonic time (s) whenever a timer may be due, the link is readable or somebody called `wake`.

        `look` is given each turn's time before health is told. Raises what `fail` was given.
        """
        watched: tuple[Selectable, ...] = (self._waker, self._health_socket, *([link] if link is not None else []))
        readable: set[Selectable] = set()
        while not self._stopping:
            now = time.monotonic()
            look(now)
            # After a whole turn, so that nobody is told of a state that nothing has looked at yet.
            self._tell_how_it_is(now, asked=self._health_socket in readable)
            wait = min((timer.wait(now) for timer in timers), default=_LONGEST_WAIT)
            readable = wait_for(watched, min(wait, _LONGEST_WAIT))
            if self._waker in readable:
                self._waker.drain()
            if self._failure is not None:
                raise self._failure
            if not self._stopping:
                yield time.monotonic()

    def wake(self) -> None:
        """Make a turn due, from any thread."""
        self._waker.wake()

    def leave(self) -> None:
        """End the loop after this turn."""
        self._stopping = True

    def fail(self, error: BaseException) -> None:
        """End with `error`, from any thread."""
        self.log.error("%s", "".join(traceback.format_exception(error)))
        self._failure = error
        self._waker.wake()

    def start_again(self, why: str, marks: Mapping[str, str] = MappingProxyType({})) -> None:
        """End, and become the same program anew. `marks`: as of `restart_program`."""
        self.log.warning("%s: starting again", why)
        self._again, self._stopping = marks, True

    def end(
        self,
        session: zenoh.Session,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave the network, whatever it does, with an exit code that says whether this was wanted.

        Who has said why, and leaves by `sys.exit`, chooses its own.
        """
        chosen = error.code if isinstance(error, SystemExit) and isinstance(error.code, int) else None
        if kind is not None and not chosen:
            self.log.error("ended by %s: %s", kind.__name__, error, exc_info=(kind, error, trace) if error else None)
        self._notifier.stopping()
        self._health_socket.close()
        signal.set_wakeup_fd(-1)
        closed = close_session(session)
        self.log.info("ended")
        status = chosen or (1 if kind is not None or self._failure is not None else 0)
        if self._again is not None and not status:
            restart_program(self._again)
        if not closed:
            sys.stderr.flush()
            os._exit(status)
        if status:
            sys.exit(status)

    def _tell_how_it_is(self, now: float, *, asked: bool) -> None:
        """To this machine's healthchecks, if they have asked, and to systemd: from the loop, so a hung one is seen."""
        self._health_socket.keep_open(now)
        if asked:
            self._health_socket.answer(self.condition.health)
        self._notifier.turn(now, self.condition.summary)
        self.condition.set_fault("health socket", self._health_socket.fault)
        self.condition.set_notice("systemd", self._notifier.problem)

    def _on_signal(self, _number: int, _frame: FrameType | None) -> None:
        self._stopping = True  # the wake-up descriptor has already been written to
        self._again = None

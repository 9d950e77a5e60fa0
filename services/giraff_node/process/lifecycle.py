"""A program that goes on until SIGTERM or SIGINT: its log, its loop, what it tells of itself, and a clean end."""

import contextlib
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import FrameType, MappingProxyType, TracebackType
from typing import Final, NoReturn, Protocol

import zenoh

from giraff_core.io import Paced, Selectable
from giraff_node.network.session import close_session
from giraff_node.process.health import HealthState
from giraff_node.process.health_socket import HealthSocket
from giraff_node.process.logs import service_logger
from giraff_node.process.selector import Waker, wait_for
from giraff_node.process.systemd import Notifier
from giraff_node.process.watchdog import Watchdog, disarm

_LONGEST_WAIT: Final = 0.1  # s; bounds how late a turn notices what has no descriptor
_LOOK_PERIOD: Final = 0.2  # s between two looks at what is no part of a turn


class FramedLink(Selectable, Paced, Protocol):
    """A board's link, as `BoardLink` is one: its bytes wake the loop, and its frames make a turn due."""

    def ready(self, now: float) -> bool:
        """Return whether there is anything for a turn. `now`: monotonic, s."""
        ...


def restart_program(marks: Mapping[str, str] = MappingProxyType({})) -> NoReturn:
    """Become the same program from its start, in the same process: whoever watches over it need not know.

    `marks`: of its environment, what it is to know of its past.
    """
    disarm()
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
        self._watchdog = Watchdog()
        self._failure: BaseException | None = None
        self._stopping = False
        self._again: Mapping[str, str] | None = None
        self._waker = Waker()
        # Free while the loop waits, and at no other time: who holds it may make a turn.
        self._turning = threading.Lock()
        self._prompt: Callable[[float], None] | None = None
        self._timers: tuple[Paced, ...] = ()
        self._waits_until = 0.0  # s, monotonic
        self._asked = False  # for a turn that has not begun
        self._loop_is_next = False  # it waits for the lock: samples without end must not keep it out
        self._next_look = 0.0
        self._turned = 0.0  # s, monotonic; when the last turn began
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._on_signal)
        signal.set_wakeup_fd(self._waker.for_signals, warn_on_full_buffer=False)

    def turns(
        self,
        *timers: Paced,
        link: Selectable | None = None,
        boards: Sequence[FramedLink] = (),
        look: Callable[[float], None] = lambda _: None,
        prompt: Callable[[float], None] | None = None,
    ) -> Iterator[float]:
        """Yield the monotonic time (s) whenever a timer may be due, the link is readable or somebody called `wake`.

        `boards`: whose frames make a turn due, and not each of their bytes; `link` may be one of them.
        `look` is given the time five times a second, and after `wake_loop`, before health is told.
        `prompt` is given the time of a turn that `wake` makes itself, in its caller's thread: turns never overlap. It
        must be short. None: each turn is yielded.
        Raises what `fail` was given.
        """
        watched: tuple[Selectable, ...] = (self._waker, self._health_socket, *([link] if link is not None else []))
        own = frozenset(boards)
        self._timers = (*timers, *boards)
        with self._turning, self._looping(prompt):
            readable: set[Selectable] = set()
            while not self._stopping:
                now = time.monotonic()
                # After a whole turn, so that nobody is told of a state that nothing has looked at yet.
                if now >= self._next_look or self._health_socket in readable:
                    self._next_look = now + _LOOK_PERIOD
                    look(now)
                    self._tell_how_it_is(now, asked=self._health_socket in readable)
                wait = min(self._wait(now), _LONGEST_WAIT)
                readable = self._wait_for(watched, now, wait)
                now = time.monotonic()
                if self._waker in readable:
                    self._waker.drain()
                if self._failure is not None:
                    raise self._failure
                awake = [board for board in boards if board in readable or board.wait(now) <= 0.0]
                spoken = [board for board in awake if board.ready(now)]  # each is asked, and reads its port
                # A turn that was made meanwhile has put off the next one.
                timed = any(timer.wait(now) <= 0.0 for timer in timers)
                idle = now - self._turned >= _LONGEST_WAIT
                if (self._asked or spoken or readable - own or timed or idle) and not self._stopping:
                    self._asked, self._turned = False, now
                    yield now

    def wake(self) -> None:
        """Make a turn due, from any thread. Where the loop waits and turns are prompt, make it here and now.

        A turn by the loop costs a second change of threads: a quarter of a sample's time between two processes.
        """
        self._asked = True
        if self._prompt is None:
            self._waker.wake()
            return
        # Who does not get the lock leaves the turn to its holder, who looks at `_asked` once more after the release.
        while self._asked and not self._loop_is_next and self._turning.acquire(blocking=False):
            try:
                self._turn_promptly()
            finally:
                self._turning.release()

    def wake_loop(self) -> None:
        """Make the loop call its `look` at once, from any thread."""
        self._next_look = 0.0
        self._waker.wake()

    def leave(self) -> None:
        """End the loop after this turn."""
        self._stopping = True
        self._waker.wake()

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
        self._watchdog.stopping()
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

    @contextlib.contextmanager
    def _looping(self, prompt: Callable[[float], None] | None) -> Iterator[None]:
        """Let others make turns within the block, and nobody after it, however it ends."""
        self._prompt, self._turned = prompt, time.monotonic()
        try:
            yield
        finally:
            self._prompt, self._stopping = None, True
            self._watchdog.stopping()

    def _wait(self, now: float) -> float:
        """Return the seconds until a timer is due."""
        return min([timer.wait(now) for timer in self._timers], default=_LONGEST_WAIT)

    def _wait_for(self, watched: tuple[Selectable, ...], now: float, seconds: float) -> set[Selectable]:
        """Wait without the lock; return what is readable."""
        self._waits_until = now + seconds
        self._turning.release()
        try:
            return wait_for(watched, 0.0 if self._asked else seconds)
        finally:
            self._loop_is_next = True
            self._turning.acquire()
            self._loop_is_next = False

    def _turn_promptly(self) -> None:
        self._asked = False
        prompt = self._prompt
        if prompt is None or self._stopping or self._failure is not None:
            return
        self._turned = now = time.monotonic()
        try:
            prompt(now)
        except BaseException as error:  # noqa: BLE001  the loop raises it
            self.fail(error)
        for timer in self._timers:
            if now + timer.wait(now) < self._waits_until:
                self._waker.wake()
                break

    def _tell_how_it_is(self, now: float, *, asked: bool) -> None:
        """To this machine's healthchecks, if they have asked, and to systemd: from the loop, so a hung one is seen."""
        self._watchdog.turn(now)
        self._health_socket.keep_open(now)
        if asked:
            self._health_socket.answer(self.condition.health)
        self._health_socket.update(now, self.condition.faults)
        self._notifier.turn(now, self.condition.summary)
        self.condition.set_fault("health socket", self._health_socket.fault)
        self.condition.set_notice("systemd", self._notifier.problem)

    def _on_signal(self, _number: int, _frame: FrameType | None) -> None:
        self._stopping = True  # the wake-up descriptor has already been written to
        self._again = None

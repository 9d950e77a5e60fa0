"""A network and a clock of one process: nothing is sent, nobody waits, and what is said is heard at once.

`Session` stands in the place of Zenoh's as far as commands use it, `Clock` in the place of the module `time`.
"""

import heapq
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from itertools import count
from operator import itemgetter
from types import SimpleNamespace
from typing import Any

import zenoh


class Clock:
    """Stands until somebody sleeps; what is due meanwhile happens in its order."""

    def __init__(self) -> None:
        self._now_ns = 0
        self._due: list[tuple[int, int, Callable[[], object]]] = []
        self._numbers = count()

    def monotonic(self) -> float:
        return self._now_ns * 1e-9

    def monotonic_ns(self) -> int:
        return self._now_ns

    def sleep(self, seconds: float) -> None:
        until_ns = self._now_ns + max(1, round(seconds * 1e9))
        while self._due and self._due[0][0] <= until_ns:
            self._now_ns, _, act = heapq.heappop(self._due)
            act()
        self._now_ns = until_ns

    def after(self, seconds: float, act: Callable[[], object]) -> None:
        heapq.heappush(self._due, (self._now_ns + round(seconds * 1e9), next(self._numbers), act))

    def every(self, seconds: float, act: Callable[[], object]) -> Callable[[], None]:
        """From now on; what is returned ends it."""
        ended = False

        def again() -> None:
            if not ended:
                act()
                self.after(seconds, again)

        def end() -> None:
            nonlocal ended
            ended = True

        again()
        return end


@dataclass
class Sample:
    """As one that Zenoh brings."""

    key_expr: str
    payload: bytes = b""
    encoding: str = ""
    kind: zenoh.SampleKind = field(default_factory=lambda: zenoh.SampleKind.PUT)


@dataclass
class Reply:
    """As one that Zenoh brings: a sample, or an error that is none."""

    ok: Sample | None
    err: Sample | None = None


@dataclass
class Declared:
    """Of a session, for as long as it is in the list."""

    key: str
    call: Callable[[Any], Any]
    among: "list[Declared]" = field(repr=False)

    def undeclare(self) -> None:
        self.among.remove(self)


@dataclass
class Publisher:
    """Of a session, on one key."""

    session: "Session"
    key: str
    encoding: str

    def put(self, payload: bytes) -> None:
        self.session.put(self.key, payload, encoding=self.encoding)


def _meet(key: str, other: str) -> bool:
    return zenoh.KeyExpr(key).intersects(zenoh.KeyExpr(other))


class Session:
    """Of all who are there."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._subscribers: list[Declared] = []
        self._answerers: list[Declared] = []
        self._watchers: list[Declared] = []
        self._tokens: list[str] = []
        self.subscribed: list[str] = []
        """Every key that anybody ever listened to."""
        self.info = SimpleNamespace(peers_zid=list, routers_zid=list)

    def liveliness(self) -> SimpleNamespace:
        """Return the calls that have to do with tokens."""
        watch = partial(self._declare, self._watchers)
        return SimpleNamespace(get=self._get_tokens, declare_subscriber=watch, declare_token=self.declare_token)

    def put(self, key: str, payload: bytes, *, encoding: str = "") -> None:
        for one in [one for one in self._subscribers if _meet(one.key, key)]:
            one.call(Sample(key, payload, encoding))

    def declare_publisher(self, key: str, *, encoding: str, **_: Any) -> Publisher:
        """Publish samples."""
        return Publisher(self, key, encoding)

    def declare_subscriber(self, key: str, call: Callable[[Any], Any]) -> Declared:
        """Hear samples."""
        return self._declare(self._subscribers, key, call)

    def _declare(
        self, among: list[Declared], key: str, call: Callable[[Any], Any], *, history: bool = False
    ) -> Declared:
        among.append(Declared(key, call, among))
        self.subscribed.append(key)
        if history:
            for token in [token for token in self._tokens if _meet(key, token)]:
                call(Sample(token))
        return among[-1]

    @contextmanager
    def declare_token(self, key: str) -> Iterator[None]:
        self._tokens.append(key)
        self._tell(key, zenoh.SampleKind.PUT)
        yield
        self._tokens.remove(key)
        self._tell(key, zenoh.SampleKind.DELETE)

    def _tell(self, token: str, kind: zenoh.SampleKind) -> None:
        for one in [one for one in self._watchers if _meet(one.key, token)]:
            one.call(Sample(token, kind=kind))

    def answer(self, key: str, call: Callable[[bytes], tuple[float, bytes] | None]) -> Declared:
        """Answer requests with what is returned, so many s after they came; None: never."""
        self._answerers.append(Declared(key, call, self._answerers))
        return self._answerers[-1]

    def get(
        self,
        key: str,
        call: Any,
        *,
        timeout: float,
        payload: bytes = b"",
        consolidation: zenoh.ConsolidationMode = zenoh.ConsolidationMode.AUTO,
        **_: Any,
    ) -> None:
        """Bring the answers to a function as they come, and at once to a handler that is told of their end.

        As Zenoh does: all answers have the question's key. If not each is brought by itself, only the last of a key
        is, once nobody is waited for any longer. All are asked, as nobody says that it knows all answers.
        """
        answers = [one.call(payload) for one in self._answerers if _meet(one.key, key)]
        ends = max((timeout if answer is None else min(answer[0], timeout) for answer in answers), default=0.0)
        came = sorted((answer for answer in answers if answer is not None and answer[0] <= timeout), key=itemgetter(0))
        if consolidation != zenoh.ConsolidationMode.NONE:
            came = [(ends, data) for _, data in came[-1:]]
        for after, data in came:
            reply = Reply(Sample(key, data))
            if isinstance(call, zenoh.handlers.Callback):
                call.callback(reply)
            else:
                self._clock.after(after, partial(call, reply))
        _end(call)

    def _get_tokens(self, key: str, call: Any, *, timeout: float) -> None:
        del timeout
        for token in [token for token in self._tokens if _meet(key, token)]:
            call.callback(Reply(Sample(token)))
        _end(call)


def _end(call: Any) -> None:
    """Tell a handler that no more replies come."""
    if isinstance(call, zenoh.handlers.Callback) and call.drop is not None:
        call.drop()

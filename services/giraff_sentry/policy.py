"""From Zenoh's own log to what a person wants to know: who was refused what, and how often.

Zenoh has no other word for a refusal: a message that its access control drops reaches nobody. The wording is that of
Zenoh 1.10 (zenoh/src/net/routing/interceptor/access_control.rs, io/zenoh-links/zenoh-link-tls/src/unicast.rs), and a
test with real sessions holds this to it.
"""

import re
from collections.abc import Iterator
from typing import Final

from giraff_core.live import Live
from giraff_sentry.config import SentryConfig

FILTER: Final = "zenoh::net::routing::interceptor::access_control=trace,zenoh_link_tls=warn"
"""What Zenoh is to log, as in RUST_LOG."""

_COLOURS: Final = re.compile(r"\x1b\[[0-9;]*m")
_DECISION: Final = re.compile(
    r"ThreadId\((?P<thread>\d+)\).* (?P<zid>[0-9a-f]+)(?: on \S+)? is (?P<un>un)?authorized to "
    r"(?P<action>[A-Za-z/ ]+) \(ingress\) on (?P<key>\S+)"
)
_CACHED: Final = "Using cached result"
_LAST: Final = "Declare Liveliness Subscriber"
_HANDSHAKE: Final = re.compile(r"WARN .*zenoh_link_tls\S* (.*?)(?:\. Hint: .*)?$")
_MOST: Final = 50
"""Different refusals that are counted: a flood of invented keys must not grow the memory."""

Refusal = tuple[str, str, str]
"""Zenoh id of the caller, empty when there was no link; what it tried; the key, or what was wrong with the greeting."""


class Refusals:
    """Counts what was refused, and tells it when it is new and then now and then."""

    def __init__(self, live: Live[SentryConfig]) -> None:
        self._live = live
        self._counts: dict[Refusal, int] = {}
        self._told: dict[Refusal, float] = {}
        self._others = 0
        self._threads: dict[str, _Thread] = {}

    def on_line(self, line: str) -> None:
        """One line of Zenoh's log."""
        plain = _COLOURS.sub("", line)
        if handshake := _HANDSHAKE.search(plain):
            self._count(("", "greet", handshake[1]))
        elif decision := _DECISION.search(plain):
            thread = self._threads.setdefault(decision["thread"], _Thread())
            for refusal in thread.on_decision(decision, cached=_CACHED in plain):
                self._count(refusal)

    def news(self, now: float) -> Iterator[tuple[Refusal, int]]:
        """What is to be told now, with how often since it was told last. `now`: monotonic, s."""
        again = self._live.config.again
        for thread in self._threads.values():
            for refusal in thread.settled():
                self._count(refusal)
        for refusal, count in list(self._counts.items()):
            if count and now - self._told.get(refusal, -again) >= again:
                self._told[refusal], self._counts[refusal] = now, 0
                yield refusal, count
            elif not count and now - self._told[refusal] >= again:
                del self._counts[refusal], self._told[refusal]
        if self._others:
            yield ("", "more", ""), self._others
            self._others = 0

    def _count(self, refusal: Refusal) -> None:
        if refusal in self._counts or len(self._counts) < _MOST:
            self._counts[refusal] = self._counts.get(refusal, 0) + 1
        else:
            self._others += 1


class _Thread:
    """The decisions that one of Zenoh's threads logs.

    When a caller declares a key, Zenoh looks up every action on it in one go: Query, Reply, Put, Delete and so on.
    These are no attempts. A refused query is known for one when no Reply follows it.
    """

    def __init__(self) -> None:
        self._looks_up = ""  # the key, between Reply and the last action
        self._query: Refusal | None = None
        self._is_old = False

    def on_decision(self, decision: re.Match[str], *, cached: bool) -> Iterator[Refusal]:
        """What is now known to have been refused."""
        zid, action, key = decision["zid"], decision["action"], decision["key"]
        query, self._query = self._query, None
        if action == "Reply" and not cached:
            self._looks_up = key
            return
        if query is not None:
            yield query
        is_look_up = self._looks_up == key and not cached
        if action == _LAST:
            self._looks_up = ""
        if decision["un"] is None or is_look_up or action not in {"Put", "Delete", "Query"}:
            return
        refusal = zid, action.lower(), key
        if action == "Query" and not cached:
            self._query, self._is_old = refusal, False
        else:
            yield refusal

    def settled(self) -> Iterator[Refusal]:
        """A query that nothing has followed since the last call but one."""
        if self._query is not None and self._is_old:
            yield self._query
            self._query = None
        self._is_old = True


def told(refusal: Refusal, count: int, certificate: str) -> str:
    """For the log. `certificate`: name of the caller's, empty when it is gone already."""
    zid, what, key = refusal
    times = f", {count} times" if count > 1 else ""
    if what == "greet":
        return f"refused a caller that is not of this network{times}: {key}"
    if what == "more":
        return f"refused more than can be told one by one{times}"
    return f"refused {certificate or zid}{times}: {what} on {key}; [network.access] says who may"

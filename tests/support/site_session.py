"""A process with one plain Giraff session, which does what its parent says: a JSON line in, a JSON line out."""

import json
import os
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Final

import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import load
from giraff_node.network.session import session_config

_PATIENCE: Final = 60.0  # s


class SiteSession:
    """Everything the parent can ask for; each answer can be written as JSON."""

    def __init__(self, robot: str, changes: dict[str, Any]) -> None:
        self._settings = session_config(load("network", NetworkConfig), robot, "apart") | changes
        self._session = self._open()
        self._crowd: list[zenoh.Session] = []
        self._heard: list[tuple[str, str]] = []
        self._last = time.monotonic()
        self._gap = 0.0
        self._declared: list[Any] = []

    def crowd(self, count: str, key: str) -> None:
        """As many more sessions, each listening at `key`."""
        with ThreadPoolExecutor(int(count)) as pool:  # each waits a while for others that are not there
            self._crowd += pool.map(lambda _: self._open(), range(int(count)))
        self._declared += [session.declare_subscriber(key, lambda _: None) for session in self._crowd]

    def subscribe(self, *keys: str) -> None:
        # Called by the link itself, so that what came first was also heard first, on whatever keys it came.
        take = zenoh.handlers.Callback(self._on_sample, indirect=False)
        for key in keys:
            self._declared.append(self._session.declare_subscriber(key, take))

    def answer(self, *keys: str) -> None:
        for key in keys:
            self._declared.append(self._session.declare_queryable(key, self._on_query))

    def be(self, key: str) -> None:
        self._declared.append(self._session.liveliness().declare_token(key))

    def put(self, text: str, *keys: str) -> None:
        for key in keys:
            self._session.put(key, text)

    def heard(self) -> list[tuple[str, str]]:
        """(key, text) of what has come since the last time."""
        news, self._heard = self._heard, []
        return news

    def gap(self) -> float:
        """Longest time without a sample since this was last asked, s."""
        longest = max(self._gap, time.monotonic() - self._last)
        self._gap, self._last = 0.0, time.monotonic()
        return longest

    def get(self, key: str) -> list[str]:
        """What is answered. The router ends a question that it lets nobody have: none is without an end."""
        replies = list(self._session.get(key, timeout=_PATIENCE))
        failed = [reply.err.payload.to_string() for reply in replies if reply.err is not None]
        if failed:
            raise RuntimeError(f"{key}: {failed}")
        return [reply.ok.payload.to_string() for reply in replies if reply.ok is not None]

    def alive(self, key: str) -> list[str]:
        replies = self._session.liveliness().get(key, timeout=1.0)
        return sorted(str(reply.ok.key_expr) for reply in replies if reply.ok is not None)

    def links(self) -> list[str]:
        """Who is at the other end of each link, by certificate and address."""
        return sorted(f"{link.auth_identifier} {link.dst}" for link in self._session.info.links())

    def _open(self) -> zenoh.Session:
        return zenoh.open(zenoh.Config.from_json5(json.dumps(self._settings)))

    def _on_sample(self, sample: zenoh.Sample) -> None:
        now = time.monotonic()
        self._gap, self._last = max(self._gap, now - self._last), now
        self._heard.append((str(sample.key_expr), bytes(sample.payload).decode(errors="replace")))

    def _on_query(self, query: zenoh.Query) -> None:
        with query:
            query.reply(query.key_expr, "done")


def main() -> None:
    session = SiteSession(sys.argv[1], json.loads(sys.argv[2]))
    for line in sys.stdin:
        word, *arguments = json.loads(line)
        does: Callable[..., Any] = getattr(session, word)
        print(json.dumps(does(*arguments)), flush=True)
    os._exit(0)  # Zenoh's close can hang


if __name__ == "__main__":
    main()

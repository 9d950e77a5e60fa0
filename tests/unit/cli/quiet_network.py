"""A network on which robots are, and say nothing; and a clock that goes on when somebody waits."""

import gc
from collections.abc import Callable, Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import MagicMock

import pytest
import zenoh

import giraff_cli.doctor.examine
import giraff_cli.record.recorder
import giraff_keyboard.main
import giraff_node.network.session
import giraff_tools.terminal.screen
from giraff_tools.terminal.signals import StopSignal


class QuietNetwork:
    """Liveliness tokens, and nothing else."""

    def __init__(self, tokens: Iterable[str]) -> None:
        self._tokens = tuple(tokens)
        self.opened = 0

    def open(self, _config: Any) -> MagicMock:
        """A session in it: nobody answers, nothing is heard."""
        self.opened += 1
        session = MagicMock(name="session")
        session.liveliness.return_value.get.side_effect = self._alive
        session.liveliness.return_value.declare_subscriber.side_effect = self._tell
        session.declare_publisher.return_value.matching_status.matching = False
        session.get.side_effect = _no_reply
        session.info.peers_zid.side_effect = list
        session.info.routers_zid.side_effect = list
        return session

    def _alive(self, key: str, handler: Any, **_: Any) -> None:
        for token in self._those(key):
            handler.callback(SimpleNamespace(ok=SimpleNamespace(key_expr=token)))
        handler.drop()

    def _tell(self, key: str, hear: Callable[[Any], None], **_: Any) -> MagicMock:
        for token in self._those(key):
            hear(SimpleNamespace(key_expr=token, kind=zenoh.SampleKind.PUT))
        return MagicMock(name="subscriber")

    def _those(self, key: str) -> list[str]:
        wanted = zenoh.KeyExpr(key)
        return [token for token in self._tokens if wanted.intersects(zenoh.KeyExpr(token))]


def _no_reply(_key: str, handler: Any, **_: Any) -> None:
    if isinstance(handler, zenoh.handlers.Callback) and handler.drop is not None:
        handler.drop()


class SteppingClock:
    """Time that passes while somebody waits for it, and a little with each look at it."""

    def __init__(self) -> None:
        self._now_ns = 1_000_000_000_000

    def monotonic(self) -> float:
        return self.monotonic_ns() * 1e-9

    def monotonic_ns(self) -> int:
        self._now_ns += 1_000
        return self._now_ns

    def sleep(self, seconds: float) -> None:
        self._now_ns += max(0, round(seconds * 1e9))


def meet(monkeypatch: pytest.MonkeyPatch, *tokens: str) -> QuietNetwork:
    """From here on whoever opens a session finds these liveliness tokens, in a time of its own."""
    network, clock = QuietNetwork(tokens), SteppingClock()
    monkeypatch.setattr(zenoh, "open", network.open)
    for name in ("monotonic", "monotonic_ns", "sleep"):
        monkeypatch.setattr(f"time.{name}", getattr(clock, name))

    def wait(stopping: StopSignal, seconds: float, patience: int = 1) -> bool:
        clock.sleep(seconds)
        return stopping.asked >= patience

    monkeypatch.setattr(StopSignal, "wait", wait)
    monkeypatch.setattr(giraff_node.network.session, "_NEXT_WAY", 60.0)  # a thread may be slow to answer on a busy host
    return network


def alone(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    """Work in this folder, in a terminal, on a host that knows of no robot."""
    monkeypatch.chdir(folder)
    for name in ("GIRAFF_CONFIG", "GIRAFF_ROBOT_NAME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("GIRAFF_NETWORK_LOCAL", "true")
    monkeypatch.setattr(giraff_cli.record.recorder, "lower_priority", lambda: None)  # it is for the whole process
    monkeypatch.setattr(giraff_keyboard.main, "in_terminal", lambda: True)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(gc, "freeze", lambda: None)
    monkeypatch.setattr(giraff_cli.doctor.examine, "call_all", lambda *_: ())
    monkeypatch.setattr(giraff_tools.terminal.screen, "_takes_more", lambda: True)

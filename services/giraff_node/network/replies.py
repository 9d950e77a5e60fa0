"""Replies to one question, gathered without ever waiting longer than agreed."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Final

import zenoh

_MOST_REPLIES: Final = 1000  # that are kept; on an open network anybody may reply
_GRACE: Final = 0.2  # s after its own deadline in which Zenoh says that no more replies come


def gather_replies(ask: Callable[[zenoh.handlers.Callback[zenoh.Reply]], object], within: float) -> list[zenoh.Reply]:
    """Return the replies to what `ask` asks with the handler that it is given, after `within` s at most.

    Zenoh's own handler holds 256 replies. Then it blocks the thread that brings the next one. That thread is the
    caller's where Zenoh knows the replies already, as it knows liveliness tokens: the caller would never return.
    """
    replies: list[zenoh.Reply] = []
    ended = threading.Event()

    def on_reply(reply: zenoh.Reply) -> None:
        if len(replies) < _MOST_REPLIES:
            replies.append(reply)

    ask(zenoh.handlers.Callback(on_reply, ended.set))
    ended.wait(within + _GRACE)
    return replies[:]

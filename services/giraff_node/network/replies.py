"""Replies to one question, gathered without ever waiting longer than agreed."""

import threading
from collections.abc import Callable
from typing import Any, Final, TypeVar, cast

import msgspec
import zenoh

from giraff_schemas.health import Health, other_health

AnswerT = TypeVar("AnswerT")

_MOST_REPLIES: Final = 1000  # that are kept; on an open network anybody may reply
_GRACE: Final = 0.2  # s after its own deadline in which Zenoh says that no more replies come


def gather_replies(ask: "Callable[[zenoh.handlers.Callback[zenoh.Reply]], object]", within: float) -> list[zenoh.Reply]:
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


def ask_all(
    session: zenoh.Session,
    key: str,
    kind: type[AnswerT],
    on_answer: Callable[[AnswerT], object],
    within: float,
    **request: Any,
) -> None:
    """Ask everybody at `key`; call `on_answer` in a thread of Zenoh with each answer that comes, for `within` s.

    An answer that is no `kind` is left out: it is of another version, or of a stranger. `request`: payload, encoding.
    """

    def on_reply(reply: zenoh.Reply) -> None:
        if (answer := _read(reply, kind)) is not None:
            on_answer(answer)

    _ask(session, key, on_reply, within, request)


def gather_answers(
    session: zenoh.Session, key: str, kind: type[AnswerT], within: float, **request: Any
) -> list[AnswerT]:
    """Ask as `ask_all` does, and return the answers once all have come, after `within` s at most."""
    replies = gather_replies(lambda handler: _ask(session, key, handler, within, request), within)
    return [answer for reply in replies if (answer := _read(reply, kind)) is not None]


def _ask(session: zenoh.Session, key: str, handler: Any, within: float, request: dict[str, Any]) -> None:
    # All answers have the question's key. By default Zenoh keeps the last answer of a key, and waits for it.
    session.get(
        key,
        handler,
        target=zenoh.QueryTarget.ALL,
        consolidation=zenoh.ConsolidationMode.NONE,
        timeout=within,
        **request,
    )


def _read(reply: zenoh.Reply, kind: type[AnswerT]) -> AnswerT | None:
    if reply.ok is None:
        return None
    try:
        return msgspec.msgpack.decode(bytes(reply.ok.payload), type=kind)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return cast(AnswerT | None, other_health(bytes(reply.ok.payload))) if kind is Health else None

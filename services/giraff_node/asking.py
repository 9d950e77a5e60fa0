"""A query that is repeated until it is answered, without ever blocking."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, Generic

import msgspec
import zenoh

from giraff_node.estop import stops_for_good
from giraff_schemas.codec import encode, encoding_of
from giraff_schemas.messages import EStopAnswer, EStopEngage
from giraff_schemas.topics import ESTOP_ENGAGE, AnswerT, Query, RequestT, key_of

_PERIOD = 0.2  # s between two attempts


class Asking(Generic[RequestT, AnswerT]):
    """Sends one request again and again; call `poll` each turn until it is answered.

    With `settles`, an answer of which that is false is kept as `refusal`, and asking goes on.
    """

    def __init__(
        self,
        session: zenoh.Session,
        robot: str,
        query: Query[RequestT, AnswerT],
        request: RequestT,
        settles: Callable[[AnswerT], bool] = lambda _: True,
    ) -> None:
        self._session = session
        self.key = key_of(robot, query)
        self._query = query
        self._payload = encode(request)
        self._encoding = encoding_of(query.request)
        self._settles = settles
        self._answers: deque[AnswerT] = deque()
        self._next = -1.0
        self.attempts = 0
        self.fault = ""
        """What the newest attempt ran into; empty: nothing, or no answer yet."""
        self.refusal: AnswerT | None = None
        """The newest answer that does not settle it."""

    def poll(self, now: float) -> AnswerT | None:
        """The answer, once there is one; else None, and another attempt when it is time. `now`: monotonic, s."""
        while self._answers and not self._settles(self._answers[0]):
            self.refusal = self._answers.popleft()
        if self._answers:
            return self._answers[0]
        if now >= self._next:
            self._next = now + _PERIOD
            self.attempts += 1
            self._session.get(
                self.key,
                self._on_reply,
                # Whoever answers to the key is asked, and no answer waits for a slower one: by default Zenoh holds
                # them back until the last has come, and one that hangs would hide a confirmed stop for seconds.
                target=zenoh.QueryTarget.ALL,
                consolidation=zenoh.ConsolidationMode.NONE,
                payload=self._payload,
                encoding=self._encoding,
                timeout=2.0,
                priority=zenoh.Priority.REAL_TIME,
                congestion_control=zenoh.CongestionControl.DROP,
                express=True,
            )
        return None

    def _on_reply(self, reply: zenoh.Reply) -> None:
        if reply.ok is None:
            self.fault = f"{self.key}: {_text_of(reply.err)}"
            return
        try:
            self._answers.append(msgspec.msgpack.decode(bytes(reply.ok.payload), type=self._query.answer))
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
            self.fault = f"{self.key}: answered with something else than {self._query.answer.__name__}: {error}"


def ask_to_stop(session: zenoh.Session, robot: str, *, by: str, reason: str) -> Asking[EStopEngage, EStopAnswer]:
    """Asks base for an emergency stop until base confirms that the robot has stopped and will stay so."""
    return Asking(session, robot, ESTOP_ENGAGE, EStopEngage(by=by, reason=reason), stops_for_good)


def _text_of(error: Any) -> str:
    return "no reason given" if error is None else bytes(error.payload).decode(errors="replace")

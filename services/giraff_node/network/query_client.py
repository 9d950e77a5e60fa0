"""A query of Zenoh that is repeated until it is answered."""

import contextlib
import time
from collections.abc import Callable
from typing import Any, Final, Generic

import msgspec
import zenoh

from giraff_core.estop.request import StopConfirmation
from giraff_core.retry import RetriedRequest
from giraff_node.network.tokens import Token, watch_tokens
from giraff_schemas.codec import DecodeError, decode, encode, encoding_of
from giraff_schemas.requests import EStopAnswer, EStopEngage
from giraff_schemas.services import BASE
from giraff_schemas.text import plain, printable
from giraff_schemas.topics import ESTOP, ESTOP_ENGAGE, AnswerT, Query, RequestT, key_of
from giraff_schemas.trouble import Trouble

_TURN: Final = 0.01  # s


class QueryClient(RetriedRequest[AnswerT], Generic[RequestT, AnswerT]):
    """Sends one request again and again; call `poll` each turn until it is answered."""

    def __init__(
        self,
        session: zenoh.Session,
        robot: str,
        query: Query[RequestT, AnswerT],
        request: RequestT,
        settles: Callable[[AnswerT], bool | str] = lambda _: True,
    ) -> None:
        super().__init__(settles)
        self._session = session
        self.key = key_of(robot, query)
        self._query = query
        self._payload = encode(request)
        self._encoding = encoding_of(query.request)

    def wait(self, until: float) -> AnswerT | None:
        """Ask until there is an answer; None: there is none by `until`, s of the monotonic clock."""
        while (now := time.monotonic()) < until:
            if (answer := self.poll(now)) is not None:
                return answer
            time.sleep(_TURN)
        return None

    @property
    def silence(self) -> str:
        """Return why there is no answer yet."""
        return self.fault or f"nobody answered {self.key}"

    def not_confirmed(self, seconds: float, check: str) -> str:
        """Return what to tell people where there was no answer for so long. `check`: what they can do about it."""
        why = f"NOT CONFIRMED after {seconds:g} s: {self.silence}; {check}"
        return f"{why}; on a secured network [network.access] says who may ask"

    def _attempt(self) -> None:
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

    def _on_reply(self, reply: zenoh.Reply) -> None:
        if reply.ok is None:
            self.fault = f"{self.key}: {printable(_text_of(reply.err))}"
            return
        try:
            self.on_answer(msgspec.msgpack.decode(bytes(reply.ok.payload), type=self._query.answer))
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
            self.fault = f"{self.key}: answered with something else than {self._query.answer.__name__}: {plain(error)}"


class EStopClient(QueryClient[EStopEngage, EStopAnswer]):
    """Listens to base's own state as well, without which no answer counts, and to which bases are there."""

    def __init__(self, session: zenoh.Session, robot: str, request: EStopEngage) -> None:
        self._confirmation = StopConfirmation(robot)
        super().__init__(session, robot, ESTOP_ENGAGE, request, self._confirmation.judge)
        # Before the first request: base tells its state at once when it engages.
        self._subscriber = session.declare_subscriber(key_of(robot, ESTOP), self._on_sample)
        self._tokens = watch_tokens(session, robot, self._on_token)

    @property
    def unconfirmed(self) -> str:
        """Tells of bases of this name that have not all stopped, though one has; empty: there are none."""
        return self._confirmation.unconfirmed()

    @property
    def is_off(self) -> bool:
        """Return True if each base that has confirmed tells that its stop is off, and reaches its board."""
        return self._confirmation.is_off

    @property
    def note(self) -> str:
        """Return what stands behind a stop whose board is not reached; empty: each is."""
        return self._confirmation.note

    @property
    def is_answered(self) -> bool:
        """Whether anybody has answered."""
        return bool(self._answers) or self.refusal is not None

    def _on_token(self, token: Token, present: bool) -> None:
        if token.service == BASE.name:
            self._confirmation.on_base(token.instance, present=present)

    def _on_sample(self, received: zenoh.Sample) -> None:
        with contextlib.suppress(DecodeError):  # it is as if nothing had come
            key = str(received.key_expr)
            self._confirmation.on_sample(decode(ESTOP, key, bytes(received.payload), str(received.encoding)))


def engaging(by: str, reason: str, *, off: bool = False) -> EStopEngage:
    """Return a request to stop.

    A name or a reason in letters of another locale stops no stop: what cannot be sent becomes "?".
    """
    return EStopEngage(by=printable(by), reason=Trouble(printable(reason)), off=off)


def request_estop(session: zenoh.Session, robot: str, *, by: str, reason: str) -> EStopClient:
    """Asks for an emergency stop until each base of this name confirms that it has stopped and will stay so."""
    return EStopClient(session, robot, engaging(by, reason))


def _text_of(error: Any) -> str:
    return "no reason given" if error is None else bytes(error.payload).decode(errors="replace")

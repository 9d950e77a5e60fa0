"""A base made of Python, for whoever asks one to stop."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import msgspec
import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.network.session import Role, close_session, open_session
from giraff_schemas.codec import encode, stamped
from giraff_schemas.messages import EStop, RobotTime, Tick
from giraff_schemas.requests import EStopAnswer, EStopEngage, EStopReset
from giraff_schemas.topics import ESTOP, ESTOP_ENGAGE, ESTOP_RESET, TICK, key_of
from giraff_schemas.trouble import Trouble

ROBOT = "sim-estop"
EPOCH = 5
DONE = EStopAnswer(done=True, engaged=True, id=7, instance="b")
LATCHED = EStop(engaged=True, id=7, by="ann@desk", reason=Trouble("smoke"))

Answer = Callable[[Any], EStopAnswer | None]
"""What base answers to a request; None: nothing, as one that hangs."""


class Base:
    """Says its clock and its state all the time, and notes what it is asked."""

    def __init__(self, session: zenoh.Session, answer: Answer, state: EStop, instance: str) -> None:
        self._session = session
        self._answer = answer
        self._state = state
        self._instance = instance
        self._ended = threading.Event()
        self.ticks = True
        self.began_ns = time.monotonic_ns()
        self.asked: list[tuple[EStopEngage | EStopReset, RobotTime]] = []
        self._declared = [
            session.declare_queryable(key_of(ROBOT, query), self._hearer(query.request))
            for query in (ESTOP_ENGAGE, ESTOP_RESET)
        ]
        self._thread = threading.Thread(target=self._say)
        self._thread.start()

    def now(self) -> RobotTime:
        return RobotTime(epoch=EPOCH, robot_ns=time.monotonic_ns() - self.began_ns)

    def end(self) -> None:
        self._ended.set()
        self._thread.join()

    def _say(self) -> None:
        seq = 0
        while not self._ended.wait(1.0 / TICK.rate_hz):
            seq += 1
            if self.ticks:
                self._put(TICK, Tick(epoch=EPOCH, robot_ns=self.now().robot_ns), seq)
            if seq % 5 == 0:
                self._put(ESTOP, self._state, seq)

    def _put(self, topic: Any, sample: Any, seq: int) -> None:
        self._session.put(key_of(ROBOT, topic), encode(stamped(sample, seq, 0, self._instance)))

    def _hearer(self, type_: type[Any]) -> Callable[[zenoh.Query], None]:
        def on_query(query: zenoh.Query) -> None:
            request = msgspec.msgpack.decode(bytes(query.payload or b""), type=type_)
            self.asked.append((request, self.now()))
            answer = self._answer(request)
            with query:
                if answer is not None:
                    query.reply(query.key_expr, encode(answer))

        return on_query


@contextmanager
def base(
    network: NetworkConfig,
    answer: Answer = lambda _: DONE,
    state: EStop = LATCHED,
    instance: str = "b",
    role: Role = "client",
) -> Iterator[Base]:
    session = open_session(network, ROBOT, role, visits=role == "inside")
    made = Base(session, answer, state, instance)
    try:
        yield made
    finally:
        made.end()
        assert close_session(session)

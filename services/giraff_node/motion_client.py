"""Asks for a motion or a route, and holds on to it: `giraff_core.motion.requester` on the network."""

import contextlib
import secrets
import time
from collections import deque
from collections.abc import Callable
from typing import Any, Final

import zenoh

from giraff_core.motion.requester import HeldMotion, MotionRequester
from giraff_core.motion.result import MotionResult
from giraff_core.motion.wish import RouteWish, Wish
from giraff_core.timer import Timer
from giraff_node.network.query_client import QueryClient
from giraff_node.network.tcp_options import set_tcp_options
from giraff_node.node import Publisher
from giraff_schemas.codec import DecodeError, decode
from giraff_schemas.messages import Sample, Tick
from giraff_schemas.motion import MotionState
from giraff_schemas.topics import TICK, Query, Topic, key_of

TURN: Final = 0.01
"""s between two turns."""
_TUNE_HZ: Final = 2.0  # a laptop on Wi-Fi comes back with another link
_MOST_WAITING: Final = 1000  # samples, some 10 s of them; whoever stands still longer has lost the motion


class MotionClient:
    """One motion. Call `turn` every `TURN` s until it returns how the motion has ended; who calls no more lets go."""

    def __init__(self, session: zenoh.Session, robot: str, by: str, wish: Wish | RouteWish) -> None:
        """`by`: whom to name to those who ask who it was."""
        instance = secrets.token_hex(8)
        self._requester = MotionRequester(secrets.randbits(63) or 1, wish, by, instance)
        self._tuning = Timer(_TUNE_HZ)
        self._heard: deque[tuple[Sample, float]] = deque(maxlen=_MOST_WAITING)  # Zenoh's threads fill it
        self._declared: list[Any] = [
            session.declare_subscriber(key_of(robot, topic), self._hearer(topic)) for topic in (TICK, wish.asked.state)
        ]

        def ask(query: Query[Any, Any], request: Any) -> QueryClient[Any, Any]:
            return QueryClient(session, robot, query, request)

        holds = Publisher(session, robot, wish.asked.hold, instance)
        self._held = HeldMotion(self._requester, ask, holds.put)

    @property
    def state(self) -> MotionState | None:
        """The newest of this motion; None: none was heard."""
        return self._requester.state

    @property
    def has_asked(self) -> bool:
        """It has heard the robot, and has asked."""
        return self._held.has_asked

    def turn(self, now: float) -> MotionResult | None:
        """How it has ended, or why it is given up; None: it goes on. Raises ValueError for a wish of no numbers.

        `now`: s of the monotonic clock.
        """
        if self._tuning.due(now):
            set_tcp_options()
        self._drain()
        return self._held.turn(now)

    def cancel(self, now: float) -> None:
        """Let go of it, and ask for its end; `turn` tells of it."""
        self._held.cancel(now)

    def close(self) -> None:
        """Listen no more."""
        for one in self._declared:
            one.undeclare()
        self._declared.clear()

    def _drain(self) -> None:
        with contextlib.suppress(IndexError):  # emptiness cannot be asked first
            while True:
                sample, at = self._heard.popleft()
                if isinstance(sample, Tick):
                    self._requester.on_tick(sample, at)
                elif isinstance(sample, MotionState):
                    self._requester.on_state(sample, at)

    def _hearer(self, topic: Topic[Any]) -> Callable[[zenoh.Sample], None]:
        def on_sample(received: zenoh.Sample) -> None:
            key = str(received.key_expr)
            with contextlib.suppress(DecodeError):  # of another version: it is as if nothing had come
                sample = decode(topic, key, bytes(received.payload), str(received.encoding))
                self._heard.append((sample, time.monotonic()))

        return on_sample

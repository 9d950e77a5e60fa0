"""A robot that is asked in simulated time, and whoever answers there."""

from collections.abc import Callable, Iterable
from types import ModuleType
from typing import Any, cast

import msgspec
import pytest

import giraff_node.network.query_client
from giraff_core.network import NetworkConfig
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.topics import key_of
from giraff_tools.network.connection import RobotConnection
from tests.support.one_process import Clock, Session

ANSWERS_AFTER = 0.02  # s


class AskedRobot:
    """A clock, a session, and a visit of a robot there."""

    def __init__(self, robot: str, at: NetworkConfig | None = None) -> None:
        self.robot = robot
        self.clock = Clock()
        self.session = Session(self.clock)
        self.connection = RobotConnection(robot, cast(Any, self.session), network=at or NetworkConfig())

    def rule(self, patch: pytest.MonkeyPatch, *modules: ModuleType) -> None:
        """Have these, and all that ask, live in its time."""
        for module in (*modules, giraff_node.network.query_client):
            patch.setattr(module, "time", self.clock)

    def answer(self, queries: Iterable[Any], say: Callable[[Any], Any]) -> list[Any]:
        """Answer these requests so, and by nothing where that is None. Return what undeclares it."""

        def hearer(type_: Any) -> Callable[[bytes], tuple[float, bytes] | None]:
            def on_query(payload: bytes) -> tuple[float, bytes] | None:
                said = say(msgspec.msgpack.decode(payload, type=type_))
                return None if said is None else (ANSWERS_AFTER, encode(said))

            return on_query

        return [self.session.answer(key_of(self.robot, query), hearer(query.request)) for query in queries]

    def put(self, topic: Any, sample: Any, instance: str, seq: int = 0) -> None:
        """Say this on the network."""
        data = encode(stamped(sample, seq, 0, instance))
        self.session.put(key_of(self.robot, topic), data, encoding=encoding_of(topic.schema))

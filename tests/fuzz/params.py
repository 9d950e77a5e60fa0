"""The parameters of a robot that is shouted at: what may be asked of them, and that none has become looser."""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import Any

import msgspec

from giraff_node.asking import Asking
from giraff_schemas.codec import encode
from giraff_schemas.params import Param, ParamAnswer, ParamDescribe, ParamSave, ParamSet
from giraff_schemas.topics import PARAM_DESCRIBE, PARAM_QUERIES, PARAM_SAVE, PARAM_SET, Query
from tests.support.process_robot import SERVICES, ProcessRobot

PARAM_KEYS = tuple(query.at(service) for query in PARAM_QUERIES for service in SERVICES)
BY = "fuzz"
Truths = dict[str, list[bytes]]
"""By key: requests that mean something, to be mutated."""


class Parameters:
    """Those of all services of a robot."""

    def __init__(self, robot: ProcessRobot) -> None:
        self._robot = robot
        self._filed = {service: self._described(service) for service in SERVICES}

    @property
    def truths(self) -> Truths:
        return {
            key: said for service, params in self._filed.items() for key, said in truths_of(service, params).items()
        }

    def take_back(self) -> int:
        """Require that none is looser than the robot file has it, and set each as it was; how many were changed."""
        changed = 0
        for service, params in self._filed.items():
            for before, now in changes(params, self._described(service)):
                changed += 1
                require_no_looser(before, now)
                request = ParamSet(name=before.name, value=before.value, by=BY)
                answer = self._ask(PARAM_SET.at(service), request)
                assert answer.done, answer.reason
            answer = self._ask(PARAM_SAVE.at(service), ParamSave(by=BY))
            assert answer.done, answer.reason
        return changed

    def _described(self, service: str) -> tuple[Param, ...]:
        return self._ask(PARAM_DESCRIBE.at(service), ParamDescribe()).params

    def _ask(self, query: Query[Any, ParamAnswer], request: msgspec.Struct) -> ParamAnswer:
        asking = Asking(self._robot.observer.session, "sim-test", query, request)
        self._robot.wait(f"an answer on {query.key}", lambda: asking.poll(time.monotonic()) is not None, 10.0)
        answer = asking.poll(time.monotonic())
        assert answer is not None
        return answer


def truths_of(service: str, params: Iterable[Param]) -> Truths:
    """What may be asked of a service and changes nothing, as it stands."""
    return {
        PARAM_DESCRIBE.at(service).key: [msgspec.msgpack.encode({"by": BY})],  # a word too many, to be mutated
        PARAM_SET.at(service).key: [encode(ParamSet(name=param.name, value=param.value, by=BY)) for param in params],
        PARAM_SAVE.at(service).key: [encode(ParamSave(names=(param.name,), by=BY)) for param in params],
    }


def changes(filed: Iterable[Param], now: Iterable[Param]) -> list[tuple[Param, Param]]:
    """Of those that have another value now: as the robot file has it, and as it is."""
    both = list(zip(filed, now, strict=True))
    assert all(before.name == after.name for before, after in both)
    return [(before, after) for before, after in both if after.value != before.value]


def require_no_looser(before: Param, now: Param) -> None:
    """What a parameter is `now` is allowed, if it was `before`."""
    match now.live:
        case "up":
            assert now.value > before.value, now
        case "down":
            assert now.value is None or before.value is None or now.value < before.value, now
        case "fixed":
            raise AssertionError(f"{now} cannot change")
        case "free":
            pass

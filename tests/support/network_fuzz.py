"""Throws payloads at each key of a robot of real processes, over the real network layer."""

import random
import time
from typing import Any, Final

import msgspec
import zenoh

from giraff_node.network.query_client import QueryClient
from giraff_schemas.codec import encoding_of
from giraff_schemas.params import Param, ParamAnswer, ParamDescribe, ParamSave, ParamSet
from giraff_schemas.services import MOTION
from giraff_schemas.topics import PARAM_DESCRIBE, PARAM_SAVE, PARAM_SET, TOPICS, Query, Topic
from tests.fuzz.growth import Growth
from tests.fuzz.keys import KEYS, REQUESTS
from tests.fuzz.params import BY, PARAM_KEYS, Truths, changes, require_no_looser, truths_of
from tests.fuzz.payloads import payload
from tests.support.process_robot import BRIEF, FULL_TILT, PATIENCE, SERVICES, ProcessRobot
from tests.unit.schemas.samples import an_example

RATE: Final = 1000.0
"""Payloads a second: more than the robot's own, and not a flood, which would test the network alone."""
_BATCH: Final = 20
_WARM: Final = 1.0 / 3.0
"""Of the payloads: a session of Zenoh and an interpreter beside it take some minutes to come to their size."""


_PARTS: Final = (*SERVICES, MOTION.name)


class NetworkCounted(msgspec.Struct, frozen=True, kw_only=True):
    """What it did to the robot."""

    payloads: int
    driven_ms: int
    growth_bytes: dict[str, int]
    """By service."""
    tightened: int
    """Parameters that were another value at the end; none was looser."""


class Parameters:
    """Those of all services of a robot."""

    def __init__(self, robot: ProcessRobot) -> None:
        self._robot = robot
        self._filed = {service: self._described(service) for service in _PARTS}

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
        asking = QueryClient(self._robot.observer.session, "sim-test", query, request)
        self._robot.wait(f"an answer on {query.key}", lambda: asking.poll(time.monotonic()) is not None, PATIENCE)
        answer = asking.poll(time.monotonic())
        assert answer is not None
        return answer


def _truths(row: Topic[Any] | Query[Any, Any]) -> list[bytes]:
    if isinstance(row, Topic):
        return [msgspec.msgpack.encode(an_example(row.schema))]
    return [msgspec.msgpack.encode(REQUESTS[row.key])]


def fuzz_network(robot: ProcessRobot, wanted: int, seed: int) -> NetworkCounted:
    """`wanted` payloads for each key, at a robot that is armed, in a level hand; then it must turn, and drive."""
    chance = random.Random(f"{seed}/network")
    robot.start(MOTION.name)
    parameters = Parameters(robot)
    robot.drive_forward(BRIEF)
    robot.arm()
    # Base says so before its board has heard of it.
    robot.wait("motors that stand", lambda: not robot.drives(), PATIENCE)
    since_us = robot.simulator.now()
    rows = [(row, _truths(row)) for row in KEYS]
    rows += [(query, parameters.truths[query.key]) for query in PARAM_KEYS]
    growths = {service: Growth(robot.pid(service), _WARM) for service in _PARTS}
    sent = 0
    due = time.monotonic()
    while sent < wanted * len(rows):
        for _ in range(_BATCH):
            row, truths = rows[sent % len(rows)]
            _send(robot, row, payload(truths, chance), chance)
            sent += 1
        for growth in growths.values():
            growth.look(sent / (wanted * len(rows)))
        due += _BATCH / RATE
        time.sleep(max(0.0, due - time.monotonic()))
    robot.run(3.0)  # for whoever was taken for a second guard or base to count as gone
    assert robot.giraff("estop", "reset") == 0
    driven_ms = robot.simulator.record(since_us).driven_ms
    tightened = parameters.take_back()
    robot.drive(
        0.0, FULL_TILT, BRIEF
    )  # the way out that guard names, where it was told of something that touches a sensor
    robot.drive_forward(BRIEF)
    counted = NetworkCounted(
        payloads=sent,
        driven_ms=driven_ms,
        growth_bytes={name: growth.bytes for name, growth in growths.items()},
        tightened=tightened,
    )
    assert counted.driven_ms == 0, counted
    return counted


def _send(robot: ProcessRobot, row: Topic[Any] | Query[Any, Any], data: bytes, chance: random.Random) -> None:
    session = robot.observer.session
    key = robot.observer.key(row)
    if isinstance(row, Query):
        session.get(key, lambda _reply: None, payload=data, timeout=1.0)
        return
    name = chance.choice(("joystick", "front_left", "nobody", f"n{chance.randrange(1 << 30)}"))
    encoding = encoding_of(chance.choice(TOPICS).schema if chance.random() < 0.1 else row.schema)
    session.put(
        key.replace("*", name),
        data,
        encoding=encoding,
        congestion_control=zenoh.CongestionControl.DROP,
    )

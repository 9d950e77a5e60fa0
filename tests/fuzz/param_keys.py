"""Fuzzes what is asked of a service's parameters, in the whole robot in one process."""

import random
from typing import Any

import msgspec

from giraff_schemas.params import Param, ParamAnswer, ParamDescribe, ParamSet
from giraff_schemas.topics import PARAM_DESCRIBE, PARAM_SET, Query
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.hosts.network import Message, Subscription
from tests.fuzz.growth import Growth
from tests.fuzz.keys import Counted, armed_robot, deliver, drive, rest, steer, throw
from tests.fuzz.params import BY, changes, require_no_looser, truths_of
from tests.loop.loops import FULL_TILT


class FuzzedParams:
    """The parameters of one service, as somebody on the network has them."""

    def __init__(self, service: str, loop: ClosedLoop) -> None:
        self._service = service
        self._loop = loop
        self._is_changed = False
        process = loop.processes[service]
        self._reconfigure = process.on_reconfigured
        if (reconfigure := process.on_reconfigured) is not None:

            def note_and_reconfigure(config: Any) -> None:
                self._is_changed = True
                reconfigure(config)

            process.on_reconfigured = note_and_reconfigure
        self.filed = self._described()

    def look(self) -> None:
        """Nothing may have become looser than the robot file has it."""
        if self._is_changed:
            self._is_changed = False
            for before, now in self._changed():
                require_no_looser(before, now)

    def take_back(self) -> None:
        """Set each as it was, and look no more."""
        self._loop.processes[self._service].on_reconfigured = self._reconfigure
        for before, _ in self._changed():
            request = ParamSet(name=before.name, value=before.value, by=BY)
            answer = self._ask(PARAM_SET.at(self._service), request)
            assert answer.done, answer.reason
        assert not self._changed()

    def _changed(self) -> list[tuple[Param, Param]]:
        return changes(self.filed, self._described())

    def _described(self) -> tuple[Param, ...]:
        return self._ask(PARAM_DESCRIBE.at(self._service), ParamDescribe()).params

    def _ask(self, query: Query[Any, ParamAnswer], request: msgspec.Struct) -> ParamAnswer:
        answers: list[Any] = []
        asker = Subscription(self._loop.processes["odometry"], query.key, lambda message: answers.append(message.body))
        for taker in self._loop.network.takers(query.key):
            taker.deliver(Message(query.key, request, asker))
        while not answers:
            self._loop.step()
        [answer] = answers
        assert isinstance(answer, ParamAnswer)
        return answer


def fuzz_param_key(query: Query[Any, ParamAnswer], wanted: int, seed: int) -> Counted:
    """Throw `wanted` requests at a service of a robot of its own."""
    with armed_robot() as (loop, _):
        return fuzz_param_key_of(loop, query, wanted, seed, Growth())


def fuzz_param_key_of(
    loop: ClosedLoop,
    query: Query[Any, ParamAnswer],
    wanted: int,
    seed: int,
    growth: Growth | None = None,
    *,
    drives: bool = True,
) -> Counted:
    """Throw `wanted` requests at a robot that is armed, in a level hand, and leave it so.

    It must drive in between if `drives`, if they were asked of the guard, or if it is not armed any more.
    """
    _, service, *_ = query.key.split("/")
    params = FuzzedParams(service, loop)
    assert loop.newest["base"].armed, loop.newest["base"].reason

    def decode_and_deliver(data: bytes) -> bool:
        try:
            request = msgspec.msgpack.decode(data, type=query.request)
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
            return False
        deliver(loop, query.key, request)
        return True

    chance = random.Random(f"{seed}/{query.key}")
    truths = truths_of(service, params.filed)[query.key]
    counted = throw(loop, truths, decode_and_deliver, params.look, wanted, chance, growth)
    params.take_back()
    if service == "guard":
        # The way out that it names where a self-test that was tightened to nothing has doubted a sensor at rest.
        steer(loop, 2.0, y=FULL_TILT)
    if drives or service == "guard" or not loop.newest["base"].armed:
        drive(loop)
        rest(loop)
    return counted

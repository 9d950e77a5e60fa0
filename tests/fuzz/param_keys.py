"""Fuzzes what is asked of a service's parameters: decoding, its desk, its policy in the whole robot in one process."""

from __future__ import annotations

import logging
import random
from pathlib import Path
from typing import Any, Final

import msgspec

from giraff_node.inbox import Inbox
from giraff_node.param_desk import ParamDesk
from giraff_node.params import Params
from giraff_schemas.params import Param, ParamAnswer, ParamDescribe, ParamSave, ParamSet
from giraff_schemas.topics import Query
from giraff_sim.closed_loop import Policies, Settings
from tests.fuzz.keys import Counted, armed_robot, drive, steer, throw
from tests.fuzz.params import BY, changes, require_no_looser, truths_of
from tests.loop.loops import FULL_TILT
from tests.unit.node.asked import Asked

_MOST_REQUESTS: Final = 20


class FuzzedDesk:
    """Where a service of a robot in one process is asked for its parameters."""

    def __init__(self, service: str, policy: Any, settings: Settings, folder: Path) -> None:
        self._params = Params(service, getattr(settings, service), settings.robot)
        self._desk = ParamDesk(service, service, self._params, folder, logging.getLogger(service))
        self._reconfigure = getattr(policy, "reconfigure", None)
        self._inboxes: dict[type, Inbox[Any]] = {
            each: Inbox(_MOST_REQUESTS) for each in (ParamDescribe, ParamSet, ParamSave)
        }
        self.filed = self._params.describe()

    def ask(self, request: msgspec.Struct) -> Asked:
        asked = Asked(request)
        self._inboxes[type(request)].accept(asked)
        return asked

    def turn(self) -> None:
        """As in a turn of the loop; and nothing has become looser than the robot file has it."""
        was, inboxes = self._params.config, self._inboxes
        self._desk.turn(inboxes[ParamDescribe], inboxes[ParamSet], inboxes[ParamSave], self._reconfigure)
        if self._params.config is not was:
            for before, now in self._changed():
                require_no_looser(before, now)

    def take_back(self) -> None:
        """Set each as it was."""
        for before, _ in self._changed():
            asked = self.ask(ParamSet(name=before.name, value=before.value, by=BY))
            self.turn()
            assert asked.said is not None
            assert asked.said.done, asked.said.reason
        assert not self._changed()

    def _changed(self) -> list[tuple[Param, Param]]:
        return changes(self.filed, self._params.describe())


def fuzz_param_key(query: Query[Any, ParamAnswer], wanted: int, seed: int, folder: Path) -> Counted:
    """Throw `wanted` requests at a service of a robot that is armed, in a level hand; then it must drive."""
    _, service, *_ = query.key.split("/")
    policies: dict[str, Any] = {}
    with armed_robot(_remembered(policies)) as (loop, _):
        desk = FuzzedDesk(service, policies[service], loop.settings, folder)

        def deliver(data: bytes) -> bool:
            try:
                desk.ask(msgspec.msgpack.decode(data, type=query.request))
            except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
                return False
            return True

        chance = random.Random(f"{seed}/{query.key}")
        counted = throw(loop, truths_of(service, desk.filed)[query.key], deliver, desk.turn, wanted, chance)
        desk.take_back()
        # The way out that guard names where a self-test that was tightened to nothing has doubted a sensor at rest.
        steer(loop, 2.0, y=FULL_TILT)
        drive(loop)
    return counted


def _remembered(made: dict[str, Any]) -> Policies:
    """Policies that are in `made`, by service, once they are made."""

    def remembered(service: str, policy: type[Any]) -> Any:
        def make(*args: Any, **kwargs: Any) -> Any:
            made[service] = policy(*args, **kwargs)
            return made[service]

        return make

    return Policies(**{service: remembered(service, policy) for service, policy in Policies()._asdict().items()})

"""How often services turn, in simulated time: as often as something is to be done, and no more."""

from collections import Counter
from functools import partial
from typing import Any

import pytest

from giraff_base.policy import BasePolicy
from giraff_base.service import Base
from giraff_schemas.messages import BaseState
from giraff_schemas.topics import CMD_VEL, LEASE, OPERATOR_CMD_VEL, TICK, TILT, WHEELS
from giraff_schemas.wire import RANGE_SLOT_MS
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.settings import Services
from tests.loop.loops import FULL_TILT, arm, closed_loop, hold
from tests.sim.robots import proving_room

SECONDS = 4
FEW = 1.05
"""Times as often: for the queries, leases and states of an eventful moment."""
_PINGS = 1000 / RANGE_SLOT_MS
MOST = {
    "base": TICK.rate_hz + WHEELS.rate_hz + CMD_VEL.rate_hz,
    "guard": CMD_VEL.rate_hz + OPERATOR_CMD_VEL.rate_hz + _PINGS,
    "joystick": TILT.rate_hz + TICK.rate_hz + LEASE.rate_hz + OPERATOR_CMD_VEL.rate_hz,
    "ranger": TICK.rate_hz + _PINGS,
    "odometry": WHEELS.rate_hz,
}
"""Turns a second: for what a service hears, and by its own pace."""


def count_turns(loop: ClosedLoop, patch: pytest.MonkeyPatch) -> Counter[str]:
    """Of each process, from now on."""
    turns: Counter[str] = Counter()

    def turn(name: str, taken: partial[None], now: float) -> None:
        turns[name] += 1
        taken(now)

    for name, process in loop.processes.items():
        assert process._service is not None
        patch.setattr(process._service, "turn", partial(turn, name, partial(process._service.turn)))
    return turns


def test_a_robot_that_drives_turns_for_what_comes_and_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    with closed_loop(proving_room()) as loop:
        arm(loop)
        hold(loop, x=FULL_TILT)
        turns = count_turns(loop, monkeypatch)
        loop.run(SECONDS)
        assert loop.newest["base"].armed
    rates = {name: turns[name] / SECONDS for name in MOST}
    print("turns a second:", rates)
    assert {name: rate for name, rate in rates.items() if rate > MOST[name] * FEW} == {}
    assert min(rates.values()) > 50


def test_base_makes_its_state_when_it_tells_it_and_tells_a_new_reason_at_once() -> None:
    made: list[BaseState] = []

    class Counting(BasePolicy):
        def state(self) -> BaseState:
            made.append(super().state())
            return made[-1]

    with closed_loop(proving_room(), services=Services(base=partial(Base, policy=Counting))) as loop:
        base: Any = loop.processes["base"]._service
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(1.0)
        loop.kill("guard")
        reasons = set()
        until = loop.simulation.now_us + 1_000_000
        while loop.simulation.now_us < until:
            loop.step()
            assert loop.newest["base"].reason == base._policy.reason
            reasons.add(base._policy.reason)
        assert len(reasons) >= 2
        assert loop.newest["base"].seq + 1 == len(made)

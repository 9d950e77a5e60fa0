"""What the robot's services do for a second of driving, counted in simulated time: no clock judges, so no machine does.

Each limit is about a tenth above the count when it was set.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from cProfile import Profile
from functools import partial
from typing import Any

import pytest

from giraff_guard.policy import GuardPolicy
from giraff_guard.service import Guard
from giraff_schemas import checks, messages
from giraff_schemas.messages import GuardedCommand, GuardState, Lease, Odometry, Wheels
from giraff_schemas.topics import GUARD, LEASE
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.settings import Services
from tests.loop.loops import FULL_TILT, arm, closed_loop, hold
from tests.sim.robots import proving_room

SECONDS = 2
MOST_CALLS = {"base": 54_000, "guard": 52_000, "odometry": 18_500, "ranger": 6_000}
"""Calls a second of functions in Python and in C, by each service's turns: 200, 62, 100 and 67 of them.

A part of a turn that runs for each report of the wheels, and calls ten functions, is 1000 of base's: it has 3000 that
compare each wheel with the other one by five slopes, so that a slipping encoder is found soon. Odometry's has
2600 that keep where the robot was, so that an echo has a place: 0.03 % of a core.
"""


@contextmanager
def driving(services: Services | None = None) -> Iterator[ClosedLoop]:
    with closed_loop(proving_room(), services=services) as loop:
        arm(loop)
        hold(loop, x=FULL_TILT / 2.0)
        loop.run(0.5)
        yield loop
        assert loop.newest["base"].driving


def profiled(profile: Profile, turn: Callable[[float], None], now: float) -> None:
    profile.runcall(turn, now)


def test_a_second_of_driving_takes_so_many_calls(monkeypatch: pytest.MonkeyPatch) -> None:
    with driving() as loop:
        profiles = {name: Profile() for name in MOST_CALLS}
        for name, profile in profiles.items():
            service: Any = loop.processes[name]._service
            monkeypatch.setattr(service, "turn", partial(profiled, profile, service.turn))
        loop.run(SECONDS)
    calls = {name: sum(row.callcount for row in profile.getstats()) / SECONDS for name, profile in profiles.items()}
    print("calls a second:", calls, "of", MOST_CALLS)
    too_many = {name: count for name, count in calls.items() if count > MOST_CALLS[name]}
    assert too_many == {}, "see whether each turn needs what was added, or raise the limit and say why"
    assert min(calls.values()) > 1000


def test_what_is_made_is_told_and_checked_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A state or a lease is made for those who are told it, and a sample's numbers are checked where it is made."""
    made: Counter[str] = Counter()
    checked: Counter[type] = Counter()

    class Counting(GuardPolicy):
        def state(self) -> GuardState:
            made["guard"] += 1
            return super().state()

        def lease(self) -> Lease:
            made["lease"] += 1
            return super().lease()

    def checking(message: Any, *values: float) -> None:
        checked[type(message)] += 1
        checks.require_finite(message, *values)

    with driving(Services(guard=partial(Guard, policy=Counting))) as loop:
        keys = {Wheels: "wheels", GuardedCommand: "cmd_vel", Odometry: "odom"}
        said = {key: loop.newest[key].seq for key in (*keys.values(), "guard", "lease")}
        made.clear()
        monkeypatch.setattr(messages, "require_finite", checking)
        loop.run(SECONDS)
        told = {key: loop.newest[key].seq - seq for key, seq in said.items()}
    assert made == {"guard": told["guard"], "lease": told["lease"]}
    assert made["guard"] <= 2 * GUARD.rate_hz * SECONDS
    assert made["lease"] <= 2 * LEASE.rate_hz * SECONDS
    assert {kind: checked[kind] for kind in keys} == {kind: told[key] for kind, key in keys.items()}

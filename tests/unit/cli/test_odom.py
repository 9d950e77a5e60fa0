"""`giraff odom` against an odometry that is there by itself.

With real processes: tests/functional/desk/test_client.py.
"""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from giraff_cli.odom import client
from giraff_cli.odom.client import Result, reset, set_pose
from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_schemas.requests import OdomAnswer, OdomReset, OdomSetPose
from giraff_schemas.topics import ODOM, ODOM_RESET, ODOM_SET_POSE, alive_key
from tests.unit.cli.asked import AskedRobot
from tests.unit.odometry.robots import PERIOD_US, ROBOT, wheels

NAME = "sim-odom"
PATIENCE = 3.0
TURNED = Pose(-1.0, 0.5, math.radians(-90.0))

Wish = OdomReset | OdomSetPose
Answer = Callable[[OdometryPolicy, Wish], OdomAnswer | None]


def obey(policy: OdometryPolicy, wish: Wish) -> OdomAnswer | None:
    return policy.on_reset(wish) if isinstance(wish, OdomReset) else policy.on_set_pose(wish)


class Network(AskedRobot):
    """One that has an odometry."""

    @contextmanager
    def odometry(self, answer: Answer = obey, *, speaks: bool = True) -> Iterator[list[Wish]]:
        """One at rest after half a metre; what it is asked."""
        policy, asked, turns = OdometryPolicy(Live(OdometryConfig()), ROBOT), list[Wish](), iter(range(1, 10_000))
        policy.on_wheels(wheels())
        policy.on_wheels(wheels(1000, 1000, 400_000))

        def say(request: Wish) -> OdomAnswer | None:
            asked.append(request)
            return answer(policy, request)

        def speak() -> None:
            said = policy.on_wheels(wheels(1000, 1000, 400_000 + next(turns) * PERIOD_US))
            assert said is not None
            self.put(ODOM, said, "o")

        declared = self.answer((ODOM_RESET, ODOM_SET_POSE), say)
        end = self.clock.every(1.0 / ODOM.rate_hz, speak) if speaks else None
        yield asked
        for one in declared:
            one.undeclare()
        if end:
            end()


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> Network:
    made = Network(NAME)
    made.rule(monkeypatch, client)
    return made


def test_it_tells_what_was_and_what_is(network: Network) -> None:
    with network.odometry() as asked:
        first = set_pose(network.connection, TURNED, 0.1, 0.2, PATIENCE)
        second = reset(network.connection, PATIENCE)
    was = "at x 0.500 m, y 0.000 m, yaw 0.000 rad (0.0°)"
    there = "at x -1.000 m, y 0.500 m, yaw -1.571 rad (-90.0°)"
    here = "at x 0.000 m, y 0.000 m, yaw 0.000 rad (0.0°)"
    assert first[:2] == (0, f"{NAME}: odometry was {was}, is {there}; jump 1")
    told = f"{NAME}: odometry was {there}, is {here}; jump 2"
    assert second == (0, told, NAME, True, None, 2, 0.0, 0.0, 0.0)
    wish = asked[0]
    assert isinstance(wish, OdomSetPose)
    assert (wish.position_sd, wish.yaw_sd) == (0.1, 0.2)
    assert "@" in wish.by
    assert asked[0].id != asked[1].id
    assert network.clock.monotonic() < 0.2


def test_a_wish_whose_answer_is_lost_is_asked_again_and_done_once(network: Network) -> None:
    lost: list[OdomAnswer | None] = []

    def lose_two(policy: OdometryPolicy, wish: Wish) -> OdomAnswer | None:
        lost.append(obey(policy, wish))
        return lost[-1] if len(lost) > 2 else None

    with network.odometry(lose_two) as asked:
        code, text, *_ = reset(network.connection, PATIENCE)
    assert (code, text.rpartition("; ")[2]) == (0, "jump 1")
    assert (len(asked), len({wish.id for wish in asked})) == (3, 1)


def test_a_refusal_is_told_with_its_reason(network: Network) -> None:
    with network.odometry():
        done = set_pose(network.connection, TURNED._replace(x=5e6), 0.1, 0.2, PATIENCE)
    reason = "x is 5000000: it must be within -1e+06..1e+06 m; are these millimetres?"
    assert done == (1, f"odometry of {NAME} refuses: {reason}", NAME, False, reason, 0, None, None, None)


@pytest.mark.parametrize("hangs", [True, False])
def test_without_an_answer_the_likely_cause_is_named(network: Network, hangs: bool) -> None:
    def ask() -> Result:
        with network.session.declare_token(alive_key("anna", "base", "1")):
            return reset(network.connection, PATIENCE)

    if hangs:
        with network.odometry(lambda *_: None):
            code, text, *_ = ask()
    else:
        code, text, *_ = ask()
    assert code == 2
    assert text.startswith(f"NOT CONFIRMED after 3 s: nobody answered giraff/{NAME}/odom/reset; check that giraff_odom")
    assert text.endswith("; on the network: --robot anna")
    assert network.clock.monotonic() == pytest.approx(PATIENCE, abs=0.02)


def test_an_odometry_that_hears_no_wheels_is_set_all_the_same(network: Network) -> None:
    with network.odometry(speaks=False):
        code, text, *_ = set_pose(network.connection, TURNED, 0.1, 0.2, PATIENCE)
    unheard = "not heard: it speaks once base tells it of the wheels"
    assert (code, text) == (0, f"{NAME}: odometry was {unheard}, is {unheard}; jump 1")

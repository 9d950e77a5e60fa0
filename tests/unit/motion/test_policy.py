"""Whom motion obeys, when it moves, and why it ends."""

from collections.abc import Callable
from typing import Any

import msgspec
import pytest

from giraff_core.lease import ASK
from giraff_schemas.messages import RobotTime
from giraff_schemas.motion import (
    MotionArc,
    MotionGo,
    MotionHold,
    MotionMove,
    MotionRequest,
    MotionState,
    MotionTurn,
    Move,
    Stage,
    Turn,
)
from giraff_schemas.requests import OdomReset
from giraff_schemas.trouble import Trouble
from tests.unit.motion.bench import BLOCKED, FREE, PERIOD, REQUESTER, Bench


def moving(bench: Bench, seconds: float = 1.0) -> None:
    """A long way, under way for a while."""
    bench.begin(MotionMove, distance=5.0)
    bench.run(seconds)
    assert bench.floor.pose.x > 0.05
    bench.said.clear()


def ended(bench: Bench) -> MotionState:
    """It ends within a period, says so neutrally as a fault, lets go and is silent."""
    bench.step()
    last = bench.said[-1]
    assert (last.source, last.neutral) == ("fault", True)
    state = bench.finish(within=3.0)
    bench.run(0.5)
    count = len(bench.said)
    bench.run(2.0)
    assert len(bench.said) == count
    assert not any(command.lease_counter == ASK for command in bench.said)
    return state


def test_it_holds_still_until_the_robot_is_armed_and_then_moves(bench: Bench) -> None:
    assert bench.ask(MotionMove, distance=0.5).accepted
    state = bench.finish()
    first = next(index for index, command in enumerate(bench.said) if not command.neutral)
    assert first * PERIOD >= 0.3
    assert all(command.source == "hand" for command in bench.said[: first + 1])
    assert (state.outcome, str(state.reason), state.step, state.steps) == ("arrived", "", 1, 1)
    assert state.achieved.x == pytest.approx(bench.floor.pose.x, abs=0.002)


def test_no_command_carries_a_newer_tick_than_the_requester_has_sent(bench: Bench) -> None:
    """Holds arrive late here. Base judges the age of a command by its tick, which must keep that delay."""
    bench.hold_delay = 0.3
    assert bench.ask(MotionMove, distance=0.5).accepted
    count = 0
    while bench.state().stage != "ended":
        bench.step()
        for command in bench.said[count:]:
            assert command.tick == bench.held[-1]
        count = len(bench.said)
    assert count > 50


def test_nothing_is_said_before_the_requester_was_heard_and_it_ends_without(bench: Bench) -> None:
    bench.requester_is_there = False
    assert bench.ask(MotionMove, distance=0.5).accepted
    state = bench.finish(within=3.0)
    assert (state.outcome, bench.said) == ("lost_requester", [])


def test_a_requester_that_is_gone_renews_nothing_and_ends_it(bench: Bench) -> None:
    moving(bench)
    bench.requester_is_there = False
    gone = bench.tick
    bench.run(0.3)
    assert bench.state().stage == "moving"
    assert all(command.tick is not None and command.tick.robot_ns <= gone.robot_ns for command in bench.said)
    bench.run(0.12)
    state = ended(bench)
    assert state.outcome == "lost_requester"
    bench.requester_is_there = True
    bench.run(2.0)
    assert bench.state().stage == "ended"
    assert bench.said[-1].source == "fault"


@pytest.mark.parametrize(
    ("id_by", "tick_by", "epoch_by", "instance"),
    [(1, 0.0, 0, REQUESTER), (0, -0.5, 0, REQUESTER), (0, 0.5, 0, REQUESTER), (0, 0.0, 1, REQUESTER), (0, 0.0, 0, "x")],
    ids=str,
)
def test_a_hold_of_another_one_or_moment_counts_for_nothing(
    bench: Bench, id_by: int, tick_by: float, epoch_by: int, instance: str
) -> None:
    moving(bench)
    bench.requester_is_there = False
    for _ in range(25):
        tick = RobotTime(epoch=bench.epoch + epoch_by, robot_ns=round((bench.now + tick_by) * 1e9))
        bench.policy.on_hold(MotionHold(id=bench.asked + id_by, tick=tick, instance=instance))
        bench.step()
    assert bench.state().outcome == "lost_requester"


@pytest.mark.parametrize("requester_is_there", [True, False])
def test_a_strangers_hold_binds_no_motion_even_if_it_is_the_first(bench: Bench, requester_is_there: bool) -> None:
    bench.requester_is_there = False
    assert bench.ask(MotionMove, distance=0.3).accepted
    for turn in range(100):
        bench.policy.on_hold(MotionHold(id=bench.asked, tick=bench.tick, instance="stranger"))
        bench.requester_is_there = requester_is_there and turn > 10
        bench.step()
    state = bench.finish()
    assert state.outcome == ("arrived" if requester_is_there else "lost_requester")
    assert bool(bench.said) == requester_is_there


@pytest.mark.parametrize(
    ("broken", "words"),
    [
        ("odometry_is_there", "odometry is not heard; check that giraff_odometry runs"),
        ("guard_is_there", "the guard is not heard; check that giraff_guard runs"),
        ("base_is_there", "base is not heard; check that giraff_base runs"),
    ],
)
def test_a_part_of_the_robot_that_is_not_heard_is_named_before_and_meanwhile(broken: str, words: str) -> None:
    before = Bench()
    setattr(before, broken, False)
    before.run(1.2)
    assert words in before.refused(MotionMove, distance=1.0)
    bench = Bench()
    moving(bench)
    setattr(bench, broken, False)
    bench.run(1.06)
    state = bench.finish(within=2.0)
    assert words in str(state.reason)
    assert state.outcome == ("lost_odometry" if broken == "odometry_is_there" else "disarmed")
    assert bench.said[-1].source == "fault"


def test_odometry_that_falls_silent_ends_it_within_a_third_of_a_second(bench: Bench) -> None:
    moving(bench)
    bench.odometry_is_there = False
    bench.run(0.34)
    assert ended(bench).outcome == "lost_odometry"


def test_it_never_asks_while_somebody_has_the_robot(bench: Bench) -> None:
    bench.holder = "keyboard-1"
    bench.run(0.1)
    assert bench.refused(MotionMove, distance=1.0) == "keyboard drives; wait until it rests, or end it; then ask again"
    bench.run(1.0)
    assert bench.said == []


def test_somebody_who_takes_the_robot_before_it_is_armed_ends_it(bench: Bench) -> None:
    bench.base_arms = False
    assert bench.ask(MotionMove, distance=1.0).accepted
    bench.run(0.1)
    bench.said.clear()
    bench.holder = "keyboard-1"
    assert ended(bench).outcome == "lost_lease"


def test_a_person_who_takes_the_robot_ends_it(bench: Bench) -> None:
    moving(bench)
    bench.holder = "joystick-1"
    state = ended(bench)
    before = state.achieved.x
    bench.floor.drive(-0.3, 0.0, 0.5)  # the person drives
    bench.step()
    assert state.outcome == "lost_lease"
    assert bench.state().achieved.x == before


def test_a_lease_that_has_ended_is_not_asked_for_again(bench: Bench) -> None:
    moving(bench)
    bench.holder = ""
    state = ended(bench)
    assert (state.outcome, bench.holder) == ("lost_lease", "")


def test_a_robot_that_is_disarmed_ends_it_and_says_why(bench: Bench) -> None:
    moving(bench)
    bench.disarmed = "emergency stop by a cat"
    state = ended(bench)
    assert (state.outcome, str(state.reason)) == ("disarmed", "emergency stop by a cat")
    bench.disarmed = ""
    bench.run(2.0)
    assert bench.state().stage == "ended"


@pytest.mark.parametrize(("name", "held"), [("stopped", True), ("board_is_there", False)])
def test_a_motion_that_was_asked_for_before_a_release_does_not_begin_with_it(name: str, held: bool) -> None:
    bench = Bench()
    setattr(bench, name, held)
    bench.run(0.1)
    before = bench.ask(MotionMove, distance=0.3)
    setattr(bench, name, not held)
    bench.run(1.0)
    assert (before.accepted, bench.said) == (False, [])
    assert bench.ask(MotionMove, distance=0.3).accepted
    bench.run(0.1)
    setattr(bench, name, held)
    bench.run(0.1)
    setattr(bench, name, not held)
    assert bench.finish().outcome == "disarmed"
    bench.run(2.0)
    assert all(command.neutral for command in bench.said)


def test_odometry_is_waited_for_until_it_moves(bench: Bench) -> None:
    """A machine that stands still for a moment may lose nothing by it."""
    assert bench.ask(MotionMove, distance=0.3).accepted
    bench.odometry_is_there = False
    bench.run(1.0)
    assert bench.state().stage == "arming"
    bench.odometry_is_there = True
    assert bench.finish().outcome == "arrived"
    bench.run(0.1)
    assert bench.ask(MotionMove, distance=0.3).accepted
    bench.odometry_is_there = False
    assert bench.finish().outcome == "lost_odometry"
    assert all(command.neutral for command in bench.said[-50:])


def test_a_robot_that_is_not_armed_in_time_ends_it(bench: Bench) -> None:
    bench.base_arms = False
    state = bench.do(MotionMove, distance=1.0)
    assert (state.outcome, str(state.reason)) == ("disarmed", "hold level to arm")
    assert all(command.neutral for command in bench.said)


def test_a_blocked_way_is_waited_for_and_ends_it_with_the_sensor(bench: Bench) -> None:
    moving(bench)
    bench.ways["forward"] = BLOCKED
    bench.run(0.6)
    assert all(command.neutral for command in bench.said)
    state = bench.state()
    assert (state.stage, state.sensor, state.outcome) == ("moving", "front_left", "")
    bench.run(0.44)
    state = ended(bench)
    assert (state.outcome, state.sensor) == ("blocked", "front_left")
    assert state.reason == Trouble("wall at 0.20 m", "back away")
    assert state.achieved.x == pytest.approx(bench.floor.pose.x, abs=0.01)


def test_a_way_that_is_free_again_is_gone_on(bench: Bench) -> None:
    bench.begin(MotionMove, distance=1.0)
    bench.run(1.0)
    bench.ways["forward"] = BLOCKED
    bench.run(0.6)
    bench.ways.update(Bench().ways)
    state = bench.finish()
    assert (state.outcome, state.sensor) == ("arrived", "")
    assert bench.floor.pose.x == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize(
    ("kind", "values", "way"),
    [
        (MotionMove, {"distance": -1.0}, "backward"),
        (MotionTurn, {"angle": 3.0}, "turn_left"),
        (MotionTurn, {"angle": -3.0}, "turn_right"),
        (MotionArc, {"radius": 0.5, "angle": -3.0}, "forward"),
    ],
)
def test_each_motion_heeds_the_way_it_goes(kind: type[MotionRequest], values: dict[str, float], way: str) -> None:
    bench = Bench()
    bench.ways = dict.fromkeys(bench.ways, BLOCKED) | {way: bench.ways[way]}
    bench.begin(kind, **values)
    bench.run(0.5)
    assert any(not command.neutral for command in bench.said)
    bench.ways[way] = BLOCKED
    assert bench.finish().outcome == "blocked"


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        (MotionMove, {"distance": -3.0}),
        (MotionTurn, {"angle": 6.0}),
        (MotionArc, {"radius": 0.5, "angle": 3.0}),
        (MotionGo, {"steps": (Move(distance=2.0), Turn(angle=1.0))}),
    ],
)
def test_a_cancel_stops_it_at_once(bench: Bench, kind: type[MotionRequest], values: dict[str, Any]) -> None:
    bench.begin(kind, **values)
    bench.run(1.0)
    assert not bench.cancel(bench.asked + 1).accepted
    bench.said.clear()
    assert bench.cancel(bench.asked).accepted
    state = ended(bench)
    assert (state.outcome, str(state.reason)) == ("cancelled", "cancelled by somebody")
    assert all(command.neutral for command in bench.said)
    assert state.achieved.yaw == pytest.approx(bench.floor.pose.yaw, abs=0.01)  # also what it rolled after that
    assert not bench.cancel().accepted


def rolls_on(bench: Bench) -> None:
    bench.pushed = 0.08


def is_slowed(bench: Bench) -> None:
    bench.ways["forward"] = msgspec.structs.replace(FREE, clearance="slow")


def sticks(bench: Bench) -> None:
    bench.stiction = 1.0


@pytest.mark.parametrize(
    ("breaks", "distance", "why"),
    [
        (lambda _: None, 2.0, "not there after 3.0 s: it was still on its way; give it a longer time limit"),
        (is_slowed, 2.0, "not there after 3.0 s: the guard slowed it where its sensors see little; give it a longer"),
        (rolls_on, 0.1, "not there after 3.0 s: the robot does not come to rest; see what moves it, and check the enc"),
        (sticks, 2.0, "not there after 3.0 s: the robot stands although it is asked to move; check its motors and"),
    ],
)
def test_a_motion_that_takes_too_long_ends(breaks: Callable[[Bench], None], distance: float, why: str) -> None:
    bench = Bench()
    breaks(bench)
    state = bench.do(MotionMove, distance=distance, time_limit=3.0)
    assert state.outcome == "time_limit"
    assert state.time_limit == 3.0
    assert state.elapsed == pytest.approx(3.0, abs=2 * PERIOD)
    assert str(state.reason).startswith(why)
    assert (bench.floor.pose.x > 0.1) == (breaks is not sticks)
    assert bench.floor.pose.x < 1.5


def test_a_pose_that_is_set_meanwhile_ends_it(bench: Bench) -> None:
    moving(bench)
    bench.odometry.on_reset(OdomReset(by="somebody", id=1))
    bench.step()
    assert ended(bench).outcome == "lost_odometry"


def test_it_says_nothing_before_the_first_request(bench: Bench) -> None:
    bench.run(1.0)
    assert (bench.said, bench.state().stage, bench.policy.has_news()) == ([], "idle", False)


def test_each_stage_is_news_once(bench: Bench) -> None:
    assert bench.ask(MotionMove, distance=0.2).accepted
    stages: list[Stage] = []
    while not stages or stages[-1] != "ended":
        bench.step()
        if bench.policy.has_news():
            stages.append(bench.state().stage)
            assert not bench.policy.has_news()
    assert list(dict.fromkeys(stages)) == ["arming", "moving", "ended"]

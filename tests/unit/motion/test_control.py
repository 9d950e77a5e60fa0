"""Where a motion ends, by the truth of a robot that is as its file says."""

import math
from typing import Any

import msgspec
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_motion.config import MotionConfig
from giraff_schemas.motion import Arc, GoTo, MotionArc, MotionGo, MotionMove, MotionRequest, MotionTurn, Move, Turn
from tests.unit.motion.bench import BLOCKED, FREE, Bench

THERE_AND_BACK = (Move(distance=2.0), Turn(angle=math.pi), Move(distance=2.0), Turn(angle=-math.pi))
SQUARE = (Move(distance=1.0), Turn(angle=math.pi / 2.0)) * 4
_NEAR = 0.01
"""m"""
_ALIKE = math.radians(0.5)


@pytest.mark.parametrize(
    ("kind", "values", "end"),
    [
        (MotionMove, {"distance": 1.0}, Pose(1.0, 0.0, 0.0)),
        (MotionMove, {"distance": -0.7}, Pose(-0.7, 0.0, 0.0)),
        (MotionMove, {"distance": 0.02}, Pose(0.02, 0.0, 0.0)),
        (MotionMove, {"distance": 2.0, "speed": 0.6}, Pose(2.0, 0.0, 0.0)),
        (MotionTurn, {"angle": 0.05}, Pose(0.0, 0.0, 0.05)),
        (MotionTurn, {"angle": 3.0 * math.pi}, Pose(0.0, 0.0, 3.0 * math.pi)),
        (MotionTurn, {"angle": math.radians(-540.0)}, Pose(0.0, 0.0, -3.0 * math.pi)),
        (MotionTurn, {"angle": math.pi, "turn_speed": 1.5}, Pose(0.0, 0.0, math.pi)),
        (MotionArc, {"radius": 0.5, "angle": math.pi / 2.0}, Pose(0.5, 0.5, math.pi / 2.0)),
        (MotionArc, {"radius": 1.0, "angle": -math.pi}, Pose(0.0, -2.0, -math.pi)),
        (MotionArc, {"radius": 0.3, "angle": 3.0 * math.pi}, Pose(0.0, 0.6, 3.0 * math.pi)),
        (MotionGo, {"steps": THERE_AND_BACK}, Pose(0.0, 0.0, 0.0)),
        (MotionGo, {"steps": SQUARE}, Pose(0.0, 0.0, 2.0 * math.pi)),
        (MotionGo, {"steps": (GoTo(x=1.0, y=1.0), GoTo(x=0.0, y=1.0))}, Pose(0.0, 1.0, math.pi)),
        (MotionGo, {"steps": (GoTo(x=0.0, y=0.001), Move(distance=0.1))}, Pose(0.1, 0.0, 0.0)),
        (MotionGo, {"steps": (Arc(radius=0.5, angle=1.0), Arc(radius=0.5, angle=-1.0))}, Pose(0.84147, 0.4597, 0.0)),
    ],
    ids=str,
)
def test_it_ends_where_it_was_to_end(kind: type[MotionRequest], values: dict[str, Any], end: Pose) -> None:
    bench = Bench()
    state = bench.do(kind, **values)
    assert state.outcome == "arrived"
    assert state.elapsed < state.time_limit / 1.2
    for pose in (bench.floor.pose, state.achieved, state.asked):
        assert math.dist((pose.x, pose.y), end[:2]) <= _NEAR
        assert abs(math.remainder(pose.yaw - end.yaw, math.tau)) <= _ALIKE
    for shift in (state.achieved, state.asked):
        assert shift.yaw == pytest.approx(end.yaw, abs=_ALIKE)  # whole turns counted


def test_asked_and_achieved_are_seen_from_where_it_began(bench: Bench) -> None:
    bench.do(MotionGo, steps=(Move(distance=0.5), Turn(angle=2.0)))
    state = bench.do(MotionMove, distance=-0.5)
    assert (state.asked.path, state.asked.x, state.asked.y) == pytest.approx((-0.5, -0.5, 0.0))
    assert (state.achieved.path, state.achieved.x, state.achieved.y) == pytest.approx((-0.5, -0.5, 0.0), abs=_NEAR)


@pytest.mark.parametrize("speed", [0.1, 0.3, 0.5])
def test_it_never_asks_for_more_than_it_may_and_slows_down_before_its_end(speed: float) -> None:
    bench, config = Bench(), MotionConfig()
    bench.begin(MotionMove, distance=1.0, speed=speed)
    fastest = 0.0
    while bench.state().stage == "moving":
        before = 1.0 - bench.floor.pose.x
        bench.step()
        asked = bench.said[-1].linear_x
        fastest = max(fastest, asked)
        braking = math.sqrt(2.0 * config.deceleration * max(0.0, before))
        assert asked <= max(config.least_speed, braking) + 1e-9
    assert fastest == speed


def test_it_learns_how_far_the_robot_rolls(bench: Bench) -> None:
    """So that it stops once for a way, and need not try again."""
    for distance in (0.5, -0.5, 0.5, -0.5):
        bench.do(MotionMove, distance=distance)
    bench.said.clear()
    bench.do(MotionMove, distance=0.5)
    starts = [one for one, other in zip(bench.said, bench.said[1:], strict=False) if one.neutral and not other.neutral]
    assert len(starts) == 1


def test_a_robot_that_is_pushed_aside_comes_back_to_its_line(bench: Bench) -> None:
    bench.begin(MotionMove, distance=3.0)
    bench.run(1.0)
    bench.floor.drive(0.2, 0.6, 0.6)
    pushed = abs(bench.floor.pose.yaw)
    assert pushed > 0.2
    state = bench.finish()
    assert abs(bench.floor.pose.y) < 0.02
    assert abs(bench.floor.pose.yaw) < math.radians(1.0)
    assert state.achieved.x == pytest.approx(3.0, abs=_NEAR)


def test_a_robot_that_is_too_weak_for_the_least_speed_is_asked_for_more() -> None:
    bench = Bench(config=MotionConfig(least_speed=0.01))
    bench.stiction = 0.05
    state = bench.do(MotionMove, distance=0.03)
    assert state.outcome == "arrived"
    assert bench.floor.pose.x == pytest.approx(0.03, abs=0.005)


def test_a_way_that_flickers_before_it_rolls_changes_nothing_of_its_end(bench: Bench) -> None:
    bench.begin(MotionMove, distance=1.0)
    for _ in range(4):
        bench.ways["forward"] = BLOCKED
        bench.run(0.9)
        bench.ways["forward"] = FREE
        bench.run(0.02)
    bench.said.clear()
    assert bench.finish().outcome == "arrived"
    assert [command.linear_x for command in bench.said if not command.neutral][-1] < 0.1
    assert bench.floor.pose.x == pytest.approx(1.0, abs=_NEAR)
    assert not any(command.linear_x < 0.0 for command in bench.said)


@pytest.mark.parametrize(("kind", "values"), [(MotionMove, {"distance": 0.004}), (MotionTurn, {"angle": -0.004})])
def test_what_is_less_than_the_tolerance_moves_nothing(kind: type[MotionRequest], values: dict[str, float]) -> None:
    bench = Bench()
    state = bench.do(kind, **values)
    assert (state.outcome, state.achieved.path, state.achieved.yaw) == ("arrived", 0.0, 0.0)
    assert all(command.neutral for command in bench.said)


@pytest.mark.parametrize(
    ("base", "guard", "why"),
    [((0.5, 1.9), (), "a wheel"), ((0.5, 1.9), (1.9, 2.1), "a wheel"), ((2.9, 3.1), (), "it was still on its way")],
)
def test_a_late_motion_tells_what_slowed_it_for_long(
    bench: Bench, base: tuple[float, ...], guard: tuple[float, ...], why: str
) -> None:
    """Seconds from and to which base and the guard slow it."""
    bench.begin(MotionMove, distance=2.0, time_limit=3.0)
    while not (state := bench.state()).outcome:
        bench.slowed = "a wheel is doubted" if base[0] < state.elapsed < base[1] else ""
        slows = guard and guard[0] < state.elapsed < guard[1]
        bench.ways["forward"] = msgspec.structs.replace(FREE, clearance="slow") if slows else FREE
        bench.step()
    assert str(state.reason).startswith(f"not there after 3.0 s: {why}")

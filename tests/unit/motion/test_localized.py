"""A go to a point of the map: when it begins, where it ends, and what ends it before."""

import math
from collections.abc import Callable
from typing import Final

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from giraff_core.kinematics.pose import Pose
from giraff_localization.free_space import FreeSpace
from giraff_maps.floor_plan import FloorPlan
from giraff_motion.localized import Localized, Placed
from giraff_schemas.localization import LocalizationState, MapWalls
from giraff_schemas.messages import RobotTime
from giraff_schemas.motion import GoTo, MotionGo, MotionState, Move, Step, Turn
from giraff_schemas.requests import OdomReset
from tests.support.map_poses import LOST, map_pose
from tests.unit.motion.bench import Bench

ODOM: Final = Pose(4.0, 1.0, math.pi / 2.0)
"""In `map`: the robot begins at (4, 1) and looks along y."""
SILENT: Final = "no pose on the map is heard any more"
WALLS: Final = (
    (0.0, 0.0, 5.0, 0.0),
    (5.0, 0.0, 5.0, 5.0),
    (5.0, 5.0, 0.0, 5.0),
    (0.0, 5.0, 0.0, 0.0),
    (2.0, 1.0, 2.0, 3.0),
)
"""A room of 5 m by 5 m, and a wall in it."""
PLAN: Final = MapWalls(
    map="room", walls=WALLS, free=FreeSpace(FloorPlan("room", WALLS), 0.2).free, instance="localization-1"
)
POSES: Final = st.builds(Pose, st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), st.floats(-3.0, 3.0))


def localized(state: LocalizationState = "localized") -> Bench:
    """A robot of which that is known."""
    bench = Bench()
    bench.localization, bench.odom_in_map = state, ODOM
    bench.run(0.2)
    return bench


def in_map(x: float, y: float) -> GoTo:
    return GoTo(x=x, y=y, frame="map")


def under_way(bench: Bench) -> None:
    """To a point 3 m ahead, for a second."""
    bench.begin(MotionGo, steps=(in_map(4.0, 4.0),))
    bench.run(1.0)
    assert bench.floor.pose.x > 0.05


def ended(bench: Bench) -> MotionState:
    """It ends within a period of what was heard, stands, and does not go on when all is well again."""
    bench.said.clear()
    bench.run(0.14)
    state = bench.state()
    assert state.stage in ("stopping", "ended"), state
    assert bench.said[-1].neutral
    assert bench.said[-1].source == "fault"
    bench.localization, bench.odom_in_map, bench.map_tick = "localized", ODOM, None
    state = bench.finish(within=3.0)
    where = bench.floor.pose
    bench.run(2.0)
    assert bench.floor.pose == where
    return state


def where(bench: Bench) -> tuple[float, float]:
    """The robot in `map`, by the truth."""
    here = bench.floor.pose
    return Pose(here.x, here.y, here.yaw).placed_in(bench.odom_in_map)[:2]


@pytest.fixture
def bench() -> Bench:
    return localized()


def test_it_goes_to_a_point_of_the_map(bench: Bench) -> None:
    state = bench.do(MotionGo, steps=(in_map(3.0, 2.0), Move(distance=0.2), in_map(4.0, 1.5)))
    assert (state.outcome, state.step, state.steps) == ("arrived", 3, 3)
    assert where(bench) == pytest.approx((4.0, 1.5), abs=0.015)


def silence(bench: Bench) -> None:
    """Of localization, for long enough."""
    bench.localization = None
    bench.run(1.1)


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda it: setattr(it, "localization", "lost"), LOST),
        (lambda it: setattr(it, "localization", "ambiguous"), LOST),
        (lambda it: setattr(it, "localization", "no_map"), LOST),
        (silence, SILENT),
        (lambda it: setattr(it, "map_tick", RobotTime(epoch=it.epoch, robot_ns=it.tick.robot_ns - 10**9)), "or old"),
        (lambda it: setattr(it, "map_tick", RobotTime(epoch=it.epoch, robot_ns=it.tick.robot_ns + 10**9)), "or old"),
        (lambda it: setattr(it, "map_tick", RobotTime(epoch=it.epoch + 1, robot_ns=it.tick.robot_ns)), "of base"),
    ],
    ids=["lost", "ambiguous", "no map", "silent", "old", "of a time to come", "of another start of base"],
)
def test_it_begins_only_while_it_is_known_where_the_robot_is(spoil: Callable[[Bench], object], words: str) -> None:
    bench = localized()
    spoil(bench)
    bench.run(0.2)
    assert words in bench.refused(MotionGo, steps=(Move(distance=0.3), in_map(4.0, 4.0)))
    bench.run(1.0)
    assert bench.said == []
    assert bench.ask(MotionGo, steps=(Move(distance=0.3),)).accepted, "which needs no map"


@pytest.mark.parametrize(("x", "y"), [(9.0, 9.0), (-1e300, 2.0), (0.0, 2.0), (2.05, 2.0)])
@pytest.mark.parametrize("before", [(), (Move(distance=0.3),)])
def test_a_goal_where_nobody_can_stand_is_refused_before_the_robot_turns(
    bench: Bench, before: tuple[Step, ...], x: float, y: float
) -> None:
    """Off the plan, beyond all numbers, in its outer wall, and nearer to a wall within than its body is wide."""
    bench.policy.on_map(PLAN)
    start = bench.floor.pose
    answer = bench.ask(MotionGo, steps=(*before, in_map(x, y)))
    assert not answer.accepted
    assert str(answer.reason).startswith(f"({x:g}, {y:g}) is in a wall, too near one, or off ")
    assert "from (0.0, 0.0) to (5.0, 5.0) m; give a place where the robot can stand" in str(answer.reason)
    bench.run(1.0)
    assert (bench.said, bench.floor.pose) == ([], start)
    assert bench.do(MotionGo, steps=(in_map(4.0, 2.0), in_map(4.0, 1.5))).outcome == "arrived"


@pytest.mark.parametrize("plan", [replace(PLAN, instance="another"), replace(PLAN, free=None)])
def test_no_goal_is_judged_by_a_plan_that_is_not_known_to_be_that_of_the_pose(bench: Bench, plan: MapWalls) -> None:
    bench.policy.on_map(plan)
    assert bench.ask(MotionGo, steps=(in_map(9.0, 9.0),)).accepted


def test_it_goes_by_a_place_that_was_told_and_ends_where_that_does_not_hold() -> None:
    bench = localized("told")
    under_way(bench)
    bench.localization = "lost"
    assert ended(bench).outcome == "lost_localization"


def test_it_goes_by_no_pose_that_two_processes_say(bench: Bench) -> None:
    """A forged one looks as good as the true one: nobody can tell which to believe."""
    bench.localizer = "another"
    bench.run(0.2)
    assert "two processes" in bench.refused(MotionGo, steps=(in_map(4.0, 4.0),))
    bench.run(1.2)
    assert bench.ask(MotionGo, steps=(in_map(4.0, 4.0),)).accepted, "for the other one has long been silent"


def test_a_second_process_that_speaks_ends_it(bench: Bench) -> None:
    under_way(bench)
    bench.localizer = "another"
    assert ended(bench).outcome == "lost_localization"


def test_without_localization_it_says_what_to_start() -> None:
    assert "start giraff_localization" in Bench().refused(MotionGo, steps=(in_map(1.0, 0.0),))


def test_it_does_not_go_by_a_pose_from_before_odometry_began_anew(bench: Bench) -> None:
    """Until localization has heard of it: what it said of the old origin would send the robot elsewhere."""
    bench.do(MotionGo, steps=(Move(distance=0.3),))
    bench.localization = None
    bench.odometry.on_reset(OdomReset(by="somebody", id=1))
    bench.run(0.1)
    assert "from before" in bench.refused(MotionGo, steps=(in_map(4.0, 4.0),))
    bench.localization = "localized"
    bench.run(0.1)
    assert bench.ask(MotionGo, steps=(in_map(4.0, 4.0),)).accepted


@pytest.mark.parametrize("state", ["lost", "ambiguous", "no_map"])
def test_it_ends_at_once_when_that_is_not_known_any_more(bench: Bench, state: LocalizationState) -> None:
    under_way(bench)
    bench.localization = state
    end = ended(bench)
    assert (end.outcome, str(end.reason)) == ("lost_localization", LOST)


def test_it_ends_when_no_pose_is_heard(bench: Bench) -> None:
    under_way(bench)
    bench.localization = None
    bench.run(0.9)
    assert bench.state().stage == "moving"
    end = ended(bench)
    assert (end.outcome, SILENT in str(end.reason)) == ("lost_localization", True)


def test_it_ends_when_what_is_said_is_of_odometry_long_past(bench: Bench) -> None:
    """A localization that repeats itself is heard, and says nothing of now."""
    under_way(bench)
    bench.map_tick = bench.tick
    bench.run(0.95)
    assert bench.state().stage == "moving"
    end = ended(bench)
    assert (end.outcome, "or old" in str(end.reason)) == ("lost_localization", True)


@pytest.mark.parametrize(
    "odom",
    [ODOM._replace(x=4.25), ODOM._replace(y=0.75), Pose(4.0, 1.0, math.pi / 2.0 + 0.08), Pose(4.0, 1.0, -math.pi / 2)],
    ids=["aside", "back", "the goal alone", "it looks elsewhere"],
)
def test_it_ends_when_the_goal_or_the_robot_turns_out_to_be_elsewhere(bench: Bench, odom: Pose) -> None:
    under_way(bench)
    bench.odom_in_map = odom
    end = ended(bench)
    assert (end.outcome, "at once; see that it is right" in str(end.reason)) == ("lost_localization", True)


@pytest.mark.parametrize("back", [False, True])
def test_many_small_corrections_place_the_goal_anew(bench: Bench, back: bool) -> None:
    """Also those of a turn: from one of its words to the next it may err by a degree or two."""
    under_way(bench)
    for part in range(1, 12):
        turned = ODOM.yaw - (0.02 * part if back else 0.0)
        bench.odom_in_map = Pose(4.0 + 0.045 * part, 1.0 + 0.02 * part, turned)
        bench.run(0.2)
    assert bench.state().stage == "moving"
    state = bench.finish()
    assert (state.outcome, state.step, state.steps) == ("arrived", 1, 1)
    assert math.dist(where(bench), (4.0, 4.0)) <= 0.2
    assert math.dist(where(bench), (4.5, 4.2)) > 0.3, "where it was at first"


def test_a_jump_back_is_one_as_well(bench: Bench) -> None:
    """Half of it to either side of where the goal was placed."""
    under_way(bench)
    bench.odom_in_map = ODOM._replace(x=4.12)
    bench.run(0.12)
    assert bench.state().stage == "moving"
    bench.odom_in_map = ODOM._replace(x=3.88)
    assert ended(bench).outcome == "lost_localization"


def test_a_small_correction_moves_no_goal_that_is_under_way_and_counts_for_the_next(bench: Bench) -> None:
    under_way(bench)
    bench.odom_in_map = ODOM._replace(x=4.1)
    assert bench.finish().outcome == "arrived"
    assert where(bench) == pytest.approx((4.1, 4.0), abs=0.015)
    bench.do(MotionGo, steps=(in_map(4.0, 4.0),))
    assert where(bench) == pytest.approx((4.0, 4.0), abs=0.015)


def test_each_step_is_placed_when_it_begins(bench: Bench) -> None:
    """So that a long round goes by what is known of the place by then."""
    bench.begin(MotionGo, steps=(in_map(4.0, 2.0), in_map(5.0, 2.0), Move(distance=0.3), in_map(5.0, 1.0)))
    for step in (1, 2, 3):
        while bench.state().step == step:
            bench.step()
        bench.odom_in_map = bench.odom_in_map._replace(y=bench.odom_in_map.y + 0.1)
        bench.run(0.12)
    state = bench.finish()
    assert (state.outcome, state.step) == ("arrived", 4)
    assert where(bench) == pytest.approx((5.0, 1.1), abs=0.02)  # by what was known when that step began


def test_what_follows_the_last_step_in_map_needs_no_map(bench: Bench) -> None:
    bench.begin(MotionGo, steps=(in_map(4.0, 1.5), Turn(angle=1.0), Move(distance=0.3)))
    while bench.state().step == 1:
        bench.step()
    bench.localization = "lost"
    assert bench.finish().outcome == "arrived"


def test_a_step_whose_goal_has_come_to_the_robot_is_over(bench: Bench) -> None:
    assert bench.ask(MotionGo, steps=(in_map(4.0, 2.0),)).accepted
    bench.odom_in_map = ODOM._replace(y=2.0)
    state = bench.finish()
    assert (state.outcome, state.step, state.achieved.path) == ("arrived", 1, 0.0)


@given(POSES, POSES, st.floats(-9.0, 9.0), st.floats(-9.0, 9.0))
def test_a_goal_is_placed_where_it_is(odom: Pose, robot: Pose, x: float, y: float) -> None:
    known = Localized()
    known.on_pose(map_pose(odom, robot, None), 0.0)
    placed = known.placed(in_map(x, y))
    assert Pose(placed.goal.x, placed.goal.y, 0.0).placed_in(odom)[:2] == pytest.approx((x, y), abs=1e-9)
    assert not placed.correction(odom, robot).is_large


@given(POSES, POSES, POSES, st.floats(0.0, 0.4), st.floats(-3.0, 3.0))
def test_a_goal_counts_as_moved_by_how_far_it_moves_in_map(
    odom: Pose, robot: Pose, goal: Pose, shift: float, way: float
) -> None:
    placed = Placed(odom, GoTo(x=goal.x, y=goal.y))
    moved = odom._replace(x=odom.x + shift * math.cos(way), y=odom.y + shift * math.sin(way))
    if abs(shift - 0.2) > 1e-6:
        assert placed.correction(moved, robot).is_large == (shift > 0.2)


def about(point: Pose, turn: float) -> Pose:
    """Where `odom` comes to be in `map`, which it was, when all turns about a point."""
    moved = Pose(0.0, 0.0, turn)
    away = point.placed_in(moved)
    return moved._replace(x=point.x - away.x, y=point.y - away.y)


@pytest.mark.parametrize(
    ("centre", "turn", "holds"),
    [
        ("goal", 0.09, True),
        ("goal", 0.11, False),
        ("robot", 0.09, True),
        ("robot", -0.11, False),
        ("both", 0.17, True),
        ("both", -0.18, False),
    ],
)
def test_the_farther_one_of_goal_and_robot_counts_and_the_turn(centre: str, turn: float, holds: bool) -> None:
    robot, goal = Pose(1.0, 0.0, 0.0), Pose(1.0 if centre == "both" else 3.0, 0.0, 0.0)
    placed = Placed(Pose(0.0, 0.0, 0.0), GoTo(x=goal.x, y=goal.y))
    assert placed.correction(about(goal if centre == "goal" else robot, turn), robot).is_large is not holds

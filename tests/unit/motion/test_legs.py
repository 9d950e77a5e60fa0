"""A plan of motion ends where a walk along it ends, which this module calculates by chords."""

import math

import msgspec
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from giraff_core.kinematics.pose import Pose
from giraff_motion.legs import Limits, plan
from giraff_schemas.motion import Arc, GoTo, Move, Step, Turn

FLOOR, SPOT = Limits(0.3, 0.06, 0.4, 0.005), Limits(0.6, 0.2, 1.0, 0.005)

ANGLES = st.floats(-12.0, 12.0).filter(lambda angle: abs(angle) > 0.01)
STRAIGHTS = st.builds(Move, distance=st.floats(-3.0, 3.0).filter(lambda distance: abs(distance) > 0.01))
TURNS = st.builds(Turn, angle=ANGLES)
ARCS = st.builds(Arc, radius=st.floats(0.1, 2.0), angle=ANGLES)
STEPS: st.SearchStrategy[Step] = st.one_of(
    STRAIGHTS, TURNS, ARCS, st.builds(GoTo, x=st.floats(-3.0, 3.0), y=st.floats(-3.0, 3.0))
)
POSES = st.builds(Pose, st.floats(-5.0, 5.0), st.floats(-5.0, 5.0), st.floats(-7.0, 7.0))


def walked(step: Step, pose: Pose) -> Pose:
    """Return the pose after one step. The plan takes an arc about its middle, this function along its chord."""
    match step:
        case Move(distance=distance):
            return pose.moved(distance, 0.0)
        case Turn(angle=angle):
            return pose.moved(0.0, angle)
        case Arc(radius=radius, angle=angle):
            return pose.moved(2.0 * radius * math.sin(abs(angle) / 2.0), angle)
        case GoTo(x=x, y=y):
            ahead, left = pose.sees(x, y)
            distance = math.hypot(x - pose.x, y - pose.y)  # turned first, 5 mm would be a little less
            return pose.moved(0.0, math.atan2(left, ahead)).moved(distance, 0.0) if distance >= 0.005 else pose


@example([Turn(angle=2.083984375), GoTo(x=0.0, y=0.005)], Pose(0.0, 0.0, 0.0))
@example([Move(distance=1.0), Arc(radius=2.0, angle=-11.0), GoTo(x=-1.0, y=-1.0)], Pose(0.0, 1.0, 0.0))
@given(st.lists(STEPS, min_size=1, max_size=5), POSES)
def test_what_is_asked_is_where_a_walk_ends(steps: list[Step], start: Pose) -> None:
    end = start
    for step in steps:
        end = walked(step, end)
    if end == start:  # all points were where the robot is
        return
    asked = plan(steps, start, FLOOR, SPOT).asked
    assert (asked.x, asked.y) == pytest.approx(start.sees(end.x, end.y), abs=1e-6)
    off = asked.yaw - end.yaw + start.yaw
    if any(isinstance(step, GoTo) for step in steps):  # half a turn to a point may be to either side
        off = math.remainder(off, math.tau)
    assert off == pytest.approx(0.0, abs=1e-6)


@given(STRAIGHTS | TURNS | ARCS, POSES, st.floats(0.01, 1.0))
def test_what_is_missing_is_what_was_not_gone_yet(step: Move | Turn | Arc, start: Pose, share: float) -> None:
    leg = plan([step], start, FLOOR, SPOT).legs[0].leg
    way = leg.error(start)
    assert abs(way) == pytest.approx(leg.length, abs=1e-6)
    part = "distance" if isinstance(step, Move) else "angle"
    gone = msgspec.structs.replace(step, **{part: getattr(step, part) * share})
    assert leg.error(walked(gone, start)) == pytest.approx(way * (1.0 - share), abs=1e-6)


@given(st.floats(0.1, 2.0), ANGLES, st.floats(-0.05, 0.05), st.floats(-0.2, 0.2))
def test_beside_a_circle_it_turns_back_to_it(radius: float, angle: float, outside: float, off: float) -> None:
    """And tells whole turns by the heading, from any place near it."""
    leg = plan([Arc(radius=radius, angle=angle)], Pose(0.0, 0.0, 0.0), FLOOR, SPOT).legs[0].leg
    side = math.copysign(1.0, angle)
    gone = abs(angle) / 2.0
    along = radius + outside
    pose = Pose(along * math.sin(gone), side * (radius - along * math.cos(gone)), side * gone + off)
    assert leg.error(pose) == pytest.approx(leg.length / 2.0, abs=1e-6)
    _, angular = leg.twist(pose, 0.2)
    towards = side * 0.2 / radius
    if abs(outside) > 0.01 and leg.length / 2.0 > 0.25:
        straight = leg.twist(pose._replace(yaw=side * gone), 0.2)[1]
        assert (straight - towards) * side * outside > 0.0
    if abs(off) > 0.1:
        assert (angular - leg.twist(pose._replace(yaw=side * gone), 0.2)[1]) * off <= 0.0

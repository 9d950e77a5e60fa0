"""What echoed lately and lies where no sensor looks now: the footprint does not sweep it."""

import math

import msgspec
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from giraff_core.kinematics.calibration import Calibration
from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_guard.config import GuardConfig
from giraff_guard.geometry import until_touch
from giraff_guard.judge.direction import Direction
from giraff_guard.judge.memory import Echoes, Obstruction
from giraff_guard.motion import RecentTravel
from giraff_schemas.messages import RobotTime
from tests.unit.guard.senses import CONFIG, CYCLE, EPOCH, FAR, ROBOT, Senses, beam, echoes_of, limits, opened
from tests.unit.odometry.robots import wheels

POST = 0.5  # m before the left sensor, so at (0.75, 0.15)
MEMORY = msgspec.structs.replace(CONFIG, silent_range=0.1)
"""Nothing but the memory holds on to what was heard."""


def passed_by(forward: float = 0.45, seconds: float = 2.0, config: GuardConfig = MEMORY) -> Senses:
    """A post was heard by the left sensor; the robot then came nearer, and it is between the cones."""
    senses = opened(config=config)
    senses.cycle({"front_left": POST}, cycles=3)
    senses.linear = forward / seconds
    senses.cycle(None, cycles=round(seconds / CYCLE))
    senses.linear = 0.0
    senses.cycle(None, cycles=3)
    return senses


def first(echoes: Echoes, place: Pose, sign: float = 1.0, curvature: float = 0.0) -> Obstruction | None:
    """What is met first."""
    return min(
        echoes.in_the_way(place, "forward" if sign > 0.0 else "backward", 0, curvature),
        key=lambda each: each.distance,
        default=None,
    )


def test_it_blocks_the_way_it_lies_in() -> None:
    senses = passed_by()
    judged = senses.verdict()
    assert (judged.clearance, judged.sensor) == ("blocked", "front_left")
    assert judged.reason.what == "front_left has seen something to the left, where no sensor looks now"
    assert "back up" in judged.reason.remedy
    assert senses.allowed("backward") == 0.6


def test_the_speed_towards_it_is_what_stops_before_it() -> None:
    senses = passed_by(0.2)
    allowed = senses.allowed()
    place = senses.obstacles._motion.place
    radius = senses.robot.footprint_radius + CONFIG.memory_margin
    way = 0.25 + POST - place.x - math.sqrt(radius**2 - 0.15**2) - (CONFIG.margin - CONFIG.memory_margin)
    assert allowed * 0.1 + allowed**2 / 3.0 == pytest.approx(way, abs=0.005)
    assert senses.verdict().clearance == "slow"


def test_turning_in_place_sweeps_nothing_but_what_touches_is_turned_past_slowly() -> None:
    senses = passed_by(0.3)
    assert senses.passes(0.0, 1.0) == (0.0, 1.0)
    senses = passed_by()
    for way in ("turn_left", "turn_right"):
        judged = senses.verdict(way)
        assert (judged.allowed, judged.clearance, judged.sensor) == (CONFIG.creep_angular, "creep", "front_left")
        assert "touches" in judged.reason.what
    assert senses.passes(0.0, 1.0) == (0.0, CONFIG.creep_angular)
    assert "turning slowed" in str(senses.limit(0.0, -1.0).reason)
    assert senses.passes(0.0, -0.2) == (0.0, -0.2)


def beside() -> Senses:
    """The post is now to the left of the robot, out of a straight path's way: it has turned away from it."""
    senses = opened(config=MEMORY)
    senses.cycle({"front_left": POST}, cycles=3)
    senses.angular = -0.5
    senses.cycle(None, cycles=round(1.0 / 0.5 / CYCLE))
    senses.angular = 0.0
    senses.cycle(None, cycles=3)
    assert senses.verdict().clearance == "free"
    return senses


def test_a_curve_sweeps_what_straight_ahead_does_not() -> None:
    senses = beside()
    assert senses.passes(0.5, 0.0) == (0.5, 0.0)
    senses.linear, senses.angular = 0.5, 1.5
    senses.cycle(None, cycles=3)
    linear, angular = senses.passes(0.5, 1.5)
    assert 0.0 < linear < 0.5
    assert angular / linear == pytest.approx(3.0)
    assert "this curve sweeps what front_left has seen to the left" in str(senses.limit(0.5, 1.5).reason)
    assert senses.passes(0.5, -1.5)[0] > linear


def test_a_curve_that_would_touch_is_a_turn_in_place() -> None:
    senses = beside()
    senses.linear, senses.angular = 0.3, 0.9
    while senses.passes(0.3, 0.9)[0] > 0.0:
        senses.wait(0.02)
        senses.hear(None)
        assert senses.robot_ns < 1_100_000_000_000
    senses.linear = senses.angular = 0.0
    senses.report()
    assert senses.passes(0.3, 0.9) == (0.0, CONFIG.creep_angular)
    assert str(senses.limit(0.3, 0.9).reason).startswith("forward blocked: ")


def test_it_is_forgotten_when_nothing_answers_from_there_any_more() -> None:
    """From the same place, so that the sensor would hear it wherever in its cone it was."""
    senses = opened(config=MEMORY)
    senses.cycle({"front_left": POST}, cycles=3)
    assert first(echoes_of(senses), senses.obstacles._motion.place) is not None
    senses.cycle(None)
    assert first(echoes_of(senses), senses.obstacles._motion.place) is not None
    senses.cycle(None)
    assert first(echoes_of(senses), senses.obstacles._motion.place) is None


def test_it_blocks_for_its_time_then_slows_and_then_is_forgotten() -> None:
    senses = passed_by()
    senses.cycle(None, cycles=round((CONFIG.memory_block - 3.5) / CYCLE))
    assert senses.allowed() == 0.0
    assert senses.passes(0.5, 0.0) == (0.0, 0.0)
    senses.cycle({"front_right": FAR}, cycles=round(3.5 / CYCLE))
    assert senses.allowed() == pytest.approx(CONFIG.untrusted_speed)
    assert str(senses.verdict().reason).endswith("to the left, where no sensor looks now")
    assert senses.passes(0.5, 0.0)[0] == pytest.approx(CONFIG.untrusted_speed)
    senses.cycle(FAR, cycles=round((CONFIG.memory_time - CONFIG.memory_block) / CYCLE))
    assert senses.verdict().clearance == "free"


def test_what_is_old_does_not_hide_what_is_new() -> None:
    echoes = Echoes(limits())
    hear(echoes, 0.8)
    motion = RecentTravel(Live(CONFIG), ROBOT)
    motion.place = Pose(0.4, 0.0, 0.0)
    now = RobotTime(epoch=EPOCH, robot_ns=round((CONFIG.memory_block + 1.0) * 1e9))
    forward = Direction("forward", limits(), [], {})
    assert forward.judge(forward, echoes, motion, now).allowed == CONFIG.creep_linear  # no sensor of its own
    for _ in range(3):
        echoes.on_beam(beam("other", 0.85, Pose(0.0, 0.05, 0.0), now.robot_ns), 0.4)
    judged = forward.judge(forward, echoes, motion, now)
    assert (judged.clearance, judged.sensor) == ("blocked", "other")


def test_it_is_forgotten_after_its_way() -> None:
    senses = passed_by()
    senses.linear = -0.5
    senses.wait(1.5)
    senses.linear = 0.5
    senses.wait(1.5)
    senses.linear = 0.0
    senses.cycle(None, cycles=3)
    assert senses.verdict().sensor == "front_left"
    for velocity in (-0.5, 0.5):
        senses.linear = velocity
        senses.wait(0.8)
    senses.linear = 0.0
    senses.cycle(None, cycles=8)
    assert first(echoes_of(senses), senses.obstacles._motion.place) is None
    assert "has not proved lately" in str(senses.verdict().reason)


def test_a_new_boot_of_the_wheels_board_forgets_it() -> None:
    senses = passed_by()
    senses.robot_ns += 10_000_000
    senses.report(boot_id=2)
    senses.cycle(None, cycles=3)
    assert senses.allowed() > 0.0


def test_what_moves_is_not_remembered() -> None:
    senses = opened(config=MEMORY)
    for step in range(6):
        senses.cycle({"front_left": 1.1 - 0.15 * step})
    senses.cycle(None, cycles=10)
    assert senses.verdict().clearance == "free"


def test_two_wild_echoes_are_not_remembered() -> None:
    senses = opened(config=MEMORY)
    senses.cycle({"front_left": 0.12}, cycles=2)
    senses.linear = 0.2
    senses.cycle(None, cycles=3)
    senses.linear = 0.0
    senses.cycle(None, cycles=6)
    assert senses.verdict().clearance == "free"


def stepped(x: float, y: float, curvature: float, radius: float) -> float | None:
    """The same in small steps of a path of 3 m, and at most once round."""
    if math.hypot(x, y) < radius:
        return 0.0 if x > 0.0 else None
    step = 0.001
    most = min(3.0, math.tau / abs(curvature)) if abs(curvature) >= 1e-3 else 3.0
    at_x = at_y = yaw = 0.0
    for number in range(round(most / step)):
        if math.hypot(x - at_x, y - at_y) < radius:
            return number * step
        at_x += step * math.cos(yaw + curvature * step / 2.0)
        at_y += step * math.sin(yaw + curvature * step / 2.0)
        yaw += curvature * step
    return None


@settings(max_examples=100, deadline=None)
@given(
    x=st.floats(-1.5, 1.5),
    y=st.floats(-1.5, 1.5),
    curvature=st.one_of(st.just(0.0), st.floats(-8.0, 8.0).filter(lambda c: abs(c) > 0.05)),
)
def test_the_way_until_a_touch_is_the_one_of_small_steps(x: float, y: float, curvature: float) -> None:
    radius = 0.35
    assume(abs(math.hypot(x, y) - radius) > 0.006)  # on the rim either answer is right
    expected = stepped(x, y, curvature, radius)
    found = until_touch(x, y, curvature, radius)
    if expected is None:
        # A path that only grazes may be told either way.
        nearer = stepped(x, y, curvature, radius + 0.005)
        assert found is None or nearer is not None or found > 2.9
    elif found is None:
        assert stepped(x, y, curvature, radius - 0.005) is None
    else:
        assert found == pytest.approx(expected, abs=0.05)


def test_backwards_it_is_the_rear_sensors() -> None:
    senses = opened(config=MEMORY)
    senses.cycle({"rear": 0.5}, cycles=3)
    senses.linear = -0.225
    senses.cycle(None, cycles=round(2.0 / CYCLE))
    senses.linear = 0.0
    senses.cycle(None, cycles=3)
    judged = senses.verdict("backward")
    assert (judged.clearance, judged.sensor) == ("blocked", "rear")
    assert senses.allowed() > 0.0
    assert FAR


def test_a_curve_backward_sweeps_the_side_it_turns_to() -> None:
    """The post is behind the robot to its right; backward with the nose to the left goes there."""
    senses = opened(config=MEMORY)
    senses.cycle({"rear": POST}, cycles=3)
    senses.linear = -0.25
    senses.cycle(None, cycles=7)
    senses.linear, senses.angular = 0.0, -0.5
    senses.cycle(None, cycles=13)
    senses.angular = 0.0
    senses.cycle(None, cycles=3)
    assert senses.passes(-0.6, 0.0) == (-0.6, 0.0)
    linear, angular = senses.passes(-0.6, 1.2)
    assert -0.6 < linear < 0.0
    assert angular / linear == pytest.approx(-2.0)
    assert "this curve sweeps what rear has seen to the right" in str(senses.limit(-0.6, 1.2).reason)
    assert senses.passes(-0.6, -1.2) == (-0.6, -1.2)


PLACES = st.builds(Pose, x=st.floats(-0.5, 0.5), y=st.floats(-0.5, 0.5), yaw=st.floats(-3.1, 3.1))


@settings(max_examples=100, deadline=None)
@given(
    mount=st.builds(Pose, x=st.floats(-0.3, 0.3), y=st.floats(-0.3, 0.3), yaw=st.floats(-3.1, 3.1)),
    distance=st.floats(0.1, 1.2),
    heard_from=PLACES,
    place=PLACES,
    sign=st.sampled_from([1.0, -1.0]),
    curvature=st.floats(-6.0, 6.0).filter(lambda c: abs(c) > 0.05),
    radius=st.sampled_from([0.2, 0.3, 0.45]),
)
def test_what_a_robot_would_touch_on_its_way_is_in_the_way(
    mount: Pose,
    distance: float,
    heard_from: Pose,
    place: Pose,
    sign: float,
    curvature: float,
    radius: float,
) -> None:
    """Driven in small steps, forward or backward, as odometry reckons."""
    echoes = Echoes(limits(radius))
    for robot_ns in range(3):
        echoes.on_beam(beam("only", distance, heard_from, robot_ns, mount=mount), 0.0)
    sits = heard_from.moved(mount.x, 0.0)._replace(yaw=heard_from.yaw + math.pi / 2.0).moved(mount.y, 0.0)
    x, y, _ = sits._replace(yaw=heard_from.yaw + mount.yaw).moved(distance, 0.0)

    def touched_after(reach: float) -> float | None:
        at, step = place, 0.005
        for number in range(round(min(1.5, math.tau / abs(curvature)) / step)):
            if math.hypot(x - at.x, y - at.y) < reach:
                return number * step
            at = at.moved(sign * step, sign * step * curvature)
        return None

    reach = radius + CONFIG.memory_margin
    assume(math.hypot(x - place.x, y - place.y) > reach + 0.01)  # what touches already may lie behind
    surely, perhaps = touched_after(reach - 0.01), touched_after(reach + 0.01)
    found = first(echoes, place, sign, curvature)
    if surely is not None:
        assert found is not None
        assert found.distance <= surely
    if perhaps is None:
        assert found is None or found.distance > 1.4
    elif found is not None:
        assert found.distance >= perhaps - 0.01


def hear(echoes: Echoes, distance: float, *, name: str = "only", y: float = 0.0) -> None:
    """Three times the same, ahead of the robot's middle, from `y` m beside the beginning."""
    for robot_ns in range(3):
        echoes.on_beam(beam(name, distance, Pose(0.0, y, 0.0), robot_ns), 0.0)


@pytest.mark.parametrize("distances", [(0.6, 1.0), (1.0, 0.6)])
def test_of_two_echoes_the_nearer_is_met_first(distances: tuple[float, float]) -> None:
    echoes = Echoes(limits(0.3))
    for name, distance, y in zip(("one", "other"), distances, (0.0, 0.2), strict=True):
        hear(echoes, distance, name=name, y=y)
    found = first(echoes, Pose(0.0, 0.0, 0.0))
    assert found is not None
    assert found.sensor == ("one" if distances[0] < distances[1] else "other")
    assert found.distance < 0.35


def test_echoes_of_two_sensors_do_not_make_one_sure() -> None:
    echoes = Echoes(limits(0.3))
    for number in range(4):
        echoes.on_beam(beam(f"sensor {number % 2}", 0.6, robot_ns=number), 0.0)
    assert first(echoes, Pose(0.0, 0.0, 0.0)) is None


def test_what_is_far_from_the_sensor_is_not_remembered() -> None:
    echoes = Echoes(limits(0.3))
    hear(echoes, CONFIG.memory_range + 0.01)
    assert first(echoes, Pose(0.0, 0.0, 0.0)) is None


def test_of_too_many_echoes_the_newest_are_kept() -> None:
    echoes = Echoes(limits(0.3))
    for number in range(100):
        hear(echoes, 1.0, y=float(number))
    assert first(echoes, Pose(0.0, 99.0, 0.0)) is not None
    assert first(echoes, Pose(0.0, 0.0, 0.0)) is None


def test_the_way_is_that_of_wheels_as_they_were_calibrated() -> None:
    found = Calibration(left_wheel_scale=1.02, right_wheel_scale=1.01, track_scale=1.1)
    motion = RecentTravel(Live(CONFIG), msgspec.structs.replace(ROBOT, calibration=found))
    motion.on_wheels(wheels())
    motion.on_wheels(wheels(20, 20, board_us=20_000))
    assert motion.travel == pytest.approx(1.015 * 20 / ROBOT.ticks_per_metre)
    assert motion.place.yaw == pytest.approx(-0.01 * 20 / ROBOT.ticks_per_metre / (1.1 * ROBOT.track_width))

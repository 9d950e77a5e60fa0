"""Frames in frames: composed as matrices are, between two samples, and never over a jump."""

import math
from random import Random

import msgspec
import numpy as np
import numpy.typing as npt
import pytest

from giraff_core.kinematics.frames import FrameTree
from giraff_core.kinematics.pose_history import (
    LONGEST_GAP,
    REMEMBERED,
    FutureError,
    GapError,
    PastError,
    Segment,
    UnconnectedError,
    UnknownFrameError,
)
from giraff_core.kinematics.rigid import rigid
from giraff_schemas.frames import Transform
from giraff_schemas.messages import Odometry, RobotTime
from tests.unit.cli import samples

Matrix = npt.NDArray[np.float64]
S = 1_000_000_000
PLACES = ("x", "y", "z", "roll", "pitch", "yaw")


def transform(parent: str, child: str, *place: float, fixed: bool = True) -> Transform:
    """`place`: as `PLACES`."""
    x, y, z, roll, pitch, yaw = (*place, *(0.0,) * 6)[:6]
    return Transform(parent=parent, child=child, x=x, y=y, z=z, roll=roll, pitch=pitch, yaw=yaw, fixed=fixed)


def turned(axis: int, angle: float) -> Matrix:
    """About x, y or z, as the textbook has it."""
    matrix: Matrix = np.eye(4)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrix[a, a] = matrix[b, b] = math.cos(angle)
    matrix[b, a] = math.sin(angle)
    matrix[a, b] = -math.sin(angle)
    return matrix


def matrix_of(told: Transform) -> Matrix:
    moved: Matrix = np.eye(4)
    moved[:3, 3] = told.x, told.y, told.z
    return moved @ turned(2, told.yaw) @ turned(1, told.pitch) @ turned(0, told.roll)


def test_a_thousand_trees_are_composed_as_matrices_are() -> None:
    chance = Random(37)
    for _ in range(1000):
        tree, at_root = FrameTree(), {"f0": np.eye(4)}
        steep = chance.choice([None, math.pi / 2, -math.pi / 2])  # where roll and yaw are one
        for number in range(1, chance.randint(2, 8)):
            parent = f"f{chance.randrange(number)}"
            place = [chance.uniform(-3.0, 3.0) for _ in range(6)]
            place[4] = place[4] if steep is None else steep
            told = transform(parent, f"f{number}", *place)
            tree.on_transform(told)
            at_root[told.child] = at_root[parent] @ matrix_of(told)
        target, source = chance.choices(tree.frames, k=2)
        found = tree.lookup(target, source)
        assert (found.parent, found.child, found.fixed, found.tick) == (target, source, True, None)
        expected = np.linalg.inv(at_root[target]) @ at_root[source]
        np.testing.assert_allclose(matrix_of(found), expected, atol=1e-9)


@pytest.mark.parametrize(
    ("place", "angles"),
    [
        ((0.1, -2.0, 0.3, 0.5, -1.0, 3.0), (0.5, -1.0, 3.0)),
        ((0.0, 0.0, 0.0, 0.0, math.pi / 2, 0.7), (0.0, math.pi / 2, 0.7)),
        ((0.0, 0.0, 0.0, math.pi, 0.0, 0.0), (math.pi, 0.0, 0.0)),
    ],
)
def test_angles_come_back_as_they_were_given(place: tuple[float, ...], angles: tuple[float, ...]) -> None:
    made = rigid(*place)
    assert made.angles == pytest.approx(angles)
    there_and_back = made.then(made.inverse)
    assert there_and_back.angles == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert there_and_back.translation == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2, math.pi / 2 - 1e-9])
def test_what_looks_straight_up_or_down_is_turned_as_it_is(pitch: float) -> None:
    """There roll and yaw are one."""
    chance = Random(5)
    for _ in range(50):
        steep = transform("a", "b", 0.0, 0.0, 0.0, chance.uniform(-3, 3), pitch, chance.uniform(-3, 3))
        rolled = transform("b", "c", 0.0, 0.0, 0.0, chance.uniform(-3, 3))
        found = FrameTree([steep, rolled]).lookup("a", "c")
        np.testing.assert_allclose(matrix_of(found), matrix_of(steep) @ matrix_of(rolled), atol=1e-12)


def test_what_looks_ahead_and_is_pitched_looks_down() -> None:
    tree = FrameTree([transform("base_link", "camera", 0.0, 0.0, 1.0, 0.0, 0.5), transform("camera", "spot", 2.0)])
    spot = tree.lookup("base_link", "spot")
    assert (spot.x, spot.z) == pytest.approx((2.0 * math.cos(0.5), 1.0 - 2.0 * math.sin(0.5)))


def heard(*told: Odometry) -> FrameTree:
    tree = FrameTree([transform("base_link", "range_rear_link", -0.25, 0.0, 0.1, 0.0, 0.0, math.pi)])
    for odometry in told:
        tree.on_odometry(odometry)
    return tree


def odometry(seconds: float, x: float, yaw: float = 0.0, *, epoch: int = samples.EPOCH, **changes: object) -> Odometry:
    sample = samples.odometry(round(seconds * S), x, 0.0, yaw)
    return msgspec.structs.replace(sample, tick=moment(seconds, epoch), instance="one", **changes)


def moment(seconds: float, epoch: int = samples.EPOCH) -> RobotTime:
    return RobotTime(epoch=epoch, robot_ns=round(seconds * S))


def test_the_newest_is_where_the_robot_is_now() -> None:
    found = heard(odometry(1.0, 0.0), odometry(1.2, 1.0, math.pi / 2)).lookup("odom", "range_rear_link")
    assert [getattr(found, name) for name in PLACES] == pytest.approx([1.0, -0.25, 0.1, 0.0, 0.0, -math.pi / 2])
    assert (found.fixed, found.tick) == (False, moment(1.2))


def test_between_two_samples_it_is_between_them_and_turns_the_shortest_way() -> None:
    tree = heard(odometry(1.0, 0.0, 3.0), odometry(1.2, 1.0, -3.0))
    quarter = tree.lookup("odom", "base_link", moment(1.05))
    short = math.tau - 6.0
    assert (quarter.x, quarter.yaw) == pytest.approx((0.25, 3.0 + short / 4.0))
    assert quarter.tick == moment(1.05)
    assert tree.lookup("odom", "base_link", moment(1.15)).yaw == pytest.approx(-3.0 - short / 4.0)
    assert [tree.lookup("odom", "base_link", moment(at)).x for at in (1.0, 1.2)] == [0.0, 1.0]
    back = tree.lookup("base_link", "odom", moment(1.2))
    assert (back.x, back.y) == pytest.approx((-math.cos(3.0), -math.sin(3.0)))


def test_of_two_samples_of_one_tick_the_later_counts_and_an_overtaken_one_does_not() -> None:
    tree = heard(odometry(1.0, 0.0), odometry(1.1, 1.0), odometry(1.1, 2.0), odometry(1.05, 9.0))
    assert tree.lookup("odom", "base_link", moment(1.05)).x == pytest.approx(1.0)
    assert tree.lookup("odom", "base_link").x == 2.0


@pytest.mark.parametrize("changes", [{"jumps": 1}, {"instance": "two"}])
def test_nothing_lies_between_two_samples_that_no_motion_joins(changes: dict[str, object]) -> None:
    jumped = msgspec.structs.replace(odometry(1.1, 5.0), **changes)
    tree = heard(odometry(1.0, 0.0), jumped, msgspec.structs.replace(jumped, tick=moment(1.2)))
    with pytest.raises(GapError, match="odometry was set, or began anew, at that moment"):
        tree.lookup("odom", "base_link", moment(1.05))
    assert [tree.lookup("odom", "base_link", moment(at)).x for at in (1.0, 1.1, 1.15)] == [0.0, 5.0, 5.0]


def test_nothing_is_made_up_over_a_silence() -> None:
    tree = heard(odometry(1.0, 0.0), odometry(1.0 + LONGEST_GAP, 1.0), odometry(1.1 + 2 * LONGEST_GAP, 2.0))
    assert tree.lookup("odom", "base_link", moment(1.0 + LONGEST_GAP / 2)).x == pytest.approx(0.5)
    with pytest.raises(GapError, match=r"was not heard for 0\.60 s about that moment"):
        tree.lookup("odom", "base_link", moment(1.0 + 1.5 * LONGEST_GAP))


def test_moments_that_are_not_heard_say_how_far_off_they_are() -> None:
    tree = FrameTree()
    for hundredth in range(1200):
        tree.on_odometry(odometry(100.0 + hundredth / 100, hundredth / 100))
    assert tree.lookup("odom", "base_link", moment(111.99 - REMEMBERED)).x == pytest.approx(11.99 - REMEMBERED)
    with pytest.raises(PastError, match=r"0\.490 s before the first that is remembered; the last 10 s are"):
        tree.lookup("odom", "base_link", moment(101.5))
    with pytest.raises(FutureError, match=r"0\.130 s ahead of the newest of odometry"):
        tree.lookup("odom", "base_link", moment(112.12))


def test_a_moment_of_another_start_of_base_is_not_compared() -> None:
    tree = heard(odometry(500.0, 1.0), odometry(1.0, 2.0, epoch=8), odometry(500.1, 3.0))
    assert tree.lookup("odom", "base_link").x == 2.0, "what was late is of a clock that is over"
    with pytest.raises(PastError, match="an earlier start of base"):
        tree.lookup("odom", "base_link", moment(500.0))
    with pytest.raises(FutureError, match="since the start of base that moment is of"):
        tree.lookup("odom", "base_link", moment(1.0, epoch=9))


def test_what_is_fixed_on_the_robot_needs_no_odometry_and_no_moment() -> None:
    found = heard().lookup("range_rear_link", "base_link", moment(1.0))
    assert (found.x, found.z) == pytest.approx((-0.25, -0.1))
    assert (found.fixed, found.tick) == (True, None)
    same = heard().lookup("base_link", "base_link")
    assert [getattr(same, name) for name in PLACES] == [0.0] * 6


def test_a_frame_that_is_not_known_is_told_with_those_that_are() -> None:
    with pytest.raises(
        UnknownFrameError, match=r"called 'rear', those that are known: base_link, range_rear_link; ran"
    ):
        heard().lookup("base_link", "rear")
    with pytest.raises(UnknownFrameError, match=r"that are known: none; .* check the name, and that they run"):
        FrameTree().lookup("odom", "base_link")


def test_frames_that_do_not_hang_together_are_told_with_what_they_are_in() -> None:
    tree = FrameTree([transform("odom", "base_link"), transform("map", "door")])
    with pytest.raises(UnconnectedError, match=r"door and base_link do not hang together: the one is in map, .* odom"):
        tree.lookup("door", "base_link")


def test_a_circle_ends() -> None:
    tree = FrameTree([transform("a", "b", 1.0), transform("b", "a", 1.0), transform("a", "c", 1.0)])
    assert tree.lookup("a", "c").x == 1.0
    with pytest.raises(UnknownFrameError):
        tree.lookup("a", "d")


def test_one_that_moves_and_was_told_once_is_known_of_its_moment_only() -> None:
    told = msgspec.structs.replace(transform("odom", "base_link", 1.0, fixed=False), tick=moment(1.0))
    tree = FrameTree([told])
    assert tree.lookup("odom", "base_link").x == tree.lookup("odom", "base_link", moment(1.0)).x == 1.0
    with pytest.raises(GapError, match="known of one moment only"):
        tree.lookup("odom", "base_link", moment(1.1))


def test_where_odom_is_in_the_map_is_a_correction_and_the_newest_word_counts_for_any_moment() -> None:
    tree = FrameTree([transform("base_link", "lens", 0.1)])
    for tenth in range(11):
        tree.on_odometry(odometry(100.0 + tenth / 10.0, tenth / 10.0))
    tree.on_transform(msgspec.structs.replace(transform("map", "odom", 5.0, fixed=False), tick=moment(100.4)))
    tree.on_transform(msgspec.structs.replace(transform("map", "odom", 7.0, fixed=False), tick=moment(100.9)))
    for at, x in ((None, 8.0), (moment(100.25), 7.25)):
        found = tree.lookup("map", "base_link", at)
        assert found.x == pytest.approx(x)
        assert (found.fixed, found.tick) == (False, at or moment(101.0))
        assert tree.lookup("lens", "map", at).x == pytest.approx(-x - 0.1)
    with pytest.raises(PastError):
        tree.lookup("map", "base_link", moment(99.0))
    tree.forget("odom")
    assert tree.lookup("odom", "base_link").x == pytest.approx(1.0)
    with pytest.raises(UnknownFrameError, match=r"no frame is called 'map', .*check that giraff_localization runs"):
        tree.lookup("map", "base_link")


def test_what_was_found_before_odometry_began_anew_is_not_of_its_origin() -> None:
    origin = Segment()
    assert not origin.holds(moment(1.0))
    origin.on_odometry(samples.odometry(S, 0.0))
    assert not origin.holds(None)
    assert [origin.holds(moment(at)) for at in (0.9, 1.0, 1.1)] == [False, False, True]
    for again in (
        msgspec.structs.replace(samples.odometry(2 * S, 0.0), jumps=1),
        msgspec.structs.replace(samples.odometry(2 * S, 0.0), boot_id=2),
        msgspec.structs.replace(samples.odometry(2 * S, 0.0), instance="another"),
    ):
        origin.on_odometry(samples.odometry(S, 0.0))
        origin.on_odometry(again)
        assert [origin.holds(moment(at)) for at in (1.1, 2.0, 2.1)] == [False, False, True]
    anew = RobotTime(epoch=samples.EPOCH + 1, robot_ns=1)
    assert not origin.holds(anew)
    origin.on_odometry(msgspec.structs.replace(again, tick=anew))
    assert origin.holds(anew)
    assert not origin.holds(moment(3.0))

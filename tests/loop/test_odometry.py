"""Odometry against the world's truth over a long mixed path, in simulated time, with true geometry."""

import math
import statistics

import msgspec
import pytest

from giraff_schemas.wire import BoardKind, ResetCause
from giraff_sim.settings import Settings
from giraff_sim.truth import TrueWheel, Truth
from giraff_sim.world.world import STEP_US
from tests.loop.loops import BY_LEVELS, FULL_TILT, SETTINGS, arm, closed_loop, hold
from tests.sim.robots import EXACT, proving_room
from tests.support.robots import ROBOT

LEGS = (
    (2.6, 0.0, 2.0),  # tilt x, tilt y (m/s²), s
    (0.0, 2.4, 1.0),
    (-2.8, 0.0, 1.5),
    (4.2, -1.9, 3.0),
    (0.0, -3.0, 1.3),
    (-3.2, 1.8, 2.0),
    (6.0, 0.0, 4.6),
    (4.0, 2.2, 4.2),
)
"""Straight, turning in place, curves of both hands, forward and backward."""

SLOW_WALK = 2.2
"""m/s² of tilt for 0.1 m/s."""
_MEAN = 50
"""ms of the true speed, whose mean is compared: it is not even itself."""
_LATEST = 150
"""ms"""

TRUSTING = msgspec.structs.replace(
    SETTINGS, guard=msgspec.structs.replace(SETTINGS.guard, untrusted_speed=0.5, silent_range=0.1)
)
"""A guard that lets the robot drive in the open for as far as it goes."""


def test_five_metres_are_within_one_percent() -> None:
    with closed_loop(proving_room(), TRUSTING, sim=EXACT) as loop:
        arm(loop)
        loop.simulation.world.room.remove("walls")
        plant = loop.simulation.world.plant
        start = loop.newest["odom"]
        assert (start.x, start.y, start.yaw) == (0.0, 0.0, 0.0)
        for x, y, seconds in LEGS:
            hold(loop, x, y)
            loop.run(seconds)
        hold(loop)
        loop.run(1.0)
        odom, truth = loop.newest["odom"], plant.pose
        error = math.hypot(odom.x - truth.x, odom.y - truth.y)
        yaw_error = abs(math.remainder(odom.yaw - truth.yaw, math.tau))
        print(
            f"path {plant.path_length:.2f} m: position off by {error * 1000:.1f} mm "
            f"({error / plant.path_length:.3%}), yaw by {math.degrees(yaw_error):.2f} deg"
        )
        assert plant.path_length > 5.0
        assert error <= 0.01 * plant.path_length
        assert math.isclose(odom.path, plant.path_length, rel_tol=0.01)


def test_a_reset_board_is_a_new_boot_and_no_jump() -> None:
    with closed_loop(proving_room()) as loop:
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(1.5)
        before, boot_id = loop.newest["odom"], loop.newest["wheels"].boot_id
        loop.simulation.reset(BoardKind.BASE, ResetCause.EXTERNAL)
        farthest = before
        until_us = loop.simulation.now_us + 1_200_000
        while loop.simulation.now_us < until_us:
            loop.step()
            odom = loop.newest["odom"]
            step = math.hypot(odom.x - farthest.x, odom.y - farthest.y)
            assert step < 0.02, f"odometry jumped by {step:.3f} m"
            farthest = odom
        assert loop.newest["wheels"].boot_id == boot_id + 1
        truth = loop.simulation.world.plant.pose
        assert math.hypot(farthest.x - truth.x, farthest.y - truth.y) < 0.3, "more was lost than the reset itself"


@pytest.mark.parametrize(
    ("truth", "hand"),
    [
        (Truth(left=TrueWheel(scale=0.995), right=TrueWheel(scale=1.005)), (FULL_TILT, 0.0)),
        (Truth(turn_slip=0.02), (0.0, FULL_TILT)),
    ],
    ids=["wheels apart", "slip"],
)
def test_odometry_is_wrong_by_what_the_robot_file_does_not_know(truth: Truth, hand: tuple[float, float]) -> None:
    """And its covariance has room for that: it is of a robot that nobody has calibrated."""
    with closed_loop(proving_room(), TRUSTING, truth=truth) as loop:
        arm(loop)
        loop.simulation.world.room.remove("walls")
        hold(loop, *hand)
        loop.run(7.0)
        hold(loop)
        loop.run(1.0)
        odom, pose = loop.newest["odom"], loop.simulation.world.plant.pose
    way, wheels = odom.path, loop.newest["wheels"]
    off = math.remainder(pose.yaw - odom.yaw, math.tau)
    if hand[0]:
        assert way > 2.0
        assert off == pytest.approx(0.01 * way / ROBOT.track_width, rel=0.1)
        assert math.dist((odom.x, odom.y), pose[:2]) == pytest.approx(off / 2.0 * way, rel=0.1)
    else:
        turned = (wheels.right_ticks - wheels.left_ticks) / ROBOT.ticks_per_metre / ROBOT.track_width
        assert turned > 5.0
        assert off == pytest.approx(-0.02 * turned, rel=0.1)
    assert 0.3 < abs(off) / math.sqrt(odom.covariance[5]) < 3.0


@pytest.mark.parametrize("settings", [SETTINGS, BY_LEVELS], ids=["by speed", "by level"])
def test_its_speed_is_the_robots_at_a_slow_walk_and_little_later(settings: Settings) -> None:
    """In both modes the board tells the time between edges. What is counted over 50 ms errs by a tenth here."""
    with closed_loop(proving_room(), settings, sim=EXACT, step_us=STEP_US) as loop:
        arm(loop)
        true: list[float] = [0.0] * _LATEST
        told: list[float] = []
        for tilt, seconds in ((SLOW_WALK, 2.5), (0.0, 1.0)):
            hold(loop, tilt)
            for _ in range(round(seconds * 1000)):
                loop.run(0.001)
                true.append(loop.simulation.world.plant.speed)
                told.append(loop.newest["odom"].linear_x)
    even = range(1500, 2500)
    off = [abs(told[ms] / statistics.fmean(true[ms + _LATEST - _MEAN : ms + _LATEST]) - 1.0) for ms in even]
    assert 0.09 < statistics.fmean(told[ms] for ms in even) < 0.11

    def missed(late: int) -> float:
        return sum((one - other) ** 2 for one, other in zip(told, true[_LATEST - late :], strict=False))

    lag = min(range(_LATEST), key=missed)
    print(f"off by {max(off):.1%} at most, {lag} ms late")
    assert max(off) <= 0.05
    assert lag <= 50

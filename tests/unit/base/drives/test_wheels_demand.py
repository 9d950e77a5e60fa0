"""From a twist to what the wheels are asked for."""

import math

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_base.drives.wheels.commands import WheelsCommands
from giraff_base.drives.wheels.config import WheelsConfig
from giraff_base.drives.wheels.drive import WheelDemand
from giraff_base.policy import Ramp, ramped
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from tests.support.robots import BASE, BY_SPEED, DRIVE
from tests.unit.base.rig import ROBOT

LINEAR = st.floats(-3.0, 3.0)
ANGULAR = st.floats(-10.0, 10.0)
HALF_TRACK = ROBOT.track_width / 2


def demand(linear_x: float, angular_z: float, drive: WheelsConfig, robot: RobotConfig = ROBOT) -> tuple[int, int]:
    return WheelDemand(robot, drive, WheelsCommands()).of(linear_x, angular_z)


@pytest.mark.parametrize(
    ("linear_x", "angular_z", "levels"),
    [
        (0.0, 0.0, (0, 0)),
        (0.3, 0.0, (35, 35)),
        (0.6, 0.0, (70, 70)),
        (-0.3, 0.0, (-35, -35)),
        (1.2, 0.0, (70, 70)),
        (0.0, 0.3 / HALF_TRACK, (-35, 35)),
        (0.0, -0.3 / HALF_TRACK, (35, -35)),
        (0.3, 0.3 / HALF_TRACK, (0, 70)),
        (0.6, 0.6 / HALF_TRACK, (0, 70)),
        (0.6, 0.3 / HALF_TRACK, (23, 70)),
        (-0.6, 0.3 / HALF_TRACK, (-70, -23)),
    ],
)
def test_table_of_twists(linear_x: float, angular_z: float, levels: tuple[int, int]) -> None:
    assert demand(linear_x, angular_z, DRIVE) == levels


@pytest.mark.parametrize(
    ("linear_x", "angular_z", "um_s"),
    [
        (0.0, 0.0, (0, 0)),
        (0.1234567, 0.0, (123_457, 123_457)),
        (-0.6, 0.0, (-600_000, -600_000)),
        (1.2, 0.0, (600_000, 600_000)),
        (0.0, 1.0, (-235_000, 235_000)),
        (0.3, -1.0, (535_000, 65_000)),
        (0.6, 0.3 / HALF_TRACK, (200_000, 600_000)),
    ],
)
def test_table_of_twists_by_speed(linear_x: float, angular_z: float, um_s: tuple[int, int]) -> None:
    assert demand(linear_x, angular_z, BY_SPEED) == um_s


@given(linear_x=LINEAR, angular_z=ANGULAR, max_wheel_speed=st.floats(0.02, 5.0))
def test_no_wheel_is_asked_for_more_than_the_board_grants(
    linear_x: float, angular_z: float, max_wheel_speed: float
) -> None:
    robot = msgspec.structs.replace(ROBOT, max_wheel_speed=max_wheel_speed)
    most = BY_SPEED.board_settings(robot, 0.0).speed_max_um_s
    assert max(map(abs, demand(linear_x, angular_z, BY_SPEED, robot))) <= most


@given(linear_x=LINEAR, angular_z=ANGULAR, max_level=st.integers(1, 255))
def test_no_wheel_gets_more_than_the_largest_level(linear_x: float, angular_z: float, max_level: int) -> None:
    drive = msgspec.structs.replace(DRIVE, max_level=max_level, stall_level=1)
    assert max(map(abs, demand(linear_x, angular_z, drive))) <= max_level


@given(linear_x=LINEAR, angular_z=ANGULAR)
def test_scaling_keeps_the_curvature(linear_x: float, angular_z: float) -> None:
    left, right = demand(linear_x, angular_z, msgspec.structs.replace(DRIVE, max_level=255))
    wanted = (linear_x - angular_z * HALF_TRACK, linear_x + angular_z * HALF_TRACK)
    share = min(1.0, ROBOT.max_wheel_speed / max(*map(abs, wanted), ROBOT.max_wheel_speed))
    for level, speed in zip((left, right), wanted, strict=True):
        assert abs(level - speed * share * 255 / ROBOT.max_wheel_speed) <= 0.5 + 1e-9


@given(linear_x=LINEAR, angular_z=ANGULAR)
def test_the_mirrored_twist_gives_the_mirrored_levels(linear_x: float, angular_z: float) -> None:
    left, right = demand(linear_x, angular_z, DRIVE)
    assert demand(linear_x, -angular_z, DRIVE) == (right, left)
    assert demand(-linear_x, -angular_z, DRIVE) == (-left, -right)


@pytest.mark.parametrize(
    ("now_at", "target", "step", "expected"),
    [
        (0.6, 0.0, 0.01, 0.0),
        (0.6, 0.2, 0.01, 0.2),
        (-0.6, -0.2, 0.01, -0.2),
        (0.0, 0.6, 0.01, 0.01),
        (0.3, 0.6, 0.01, 0.31),
        (-0.3, -0.6, 0.01, -0.31),
        (0.595, 0.6, 0.01, 0.6),
        (0.6, -0.6, 0.01, -0.01),
        (-0.6, 0.6, 0.01, 0.01),
        (-0.6, 0.0, 0.01, 0.0),
        (0.3, 0.6, 0.0, 0.3),
        (0.0, -0.005, 0.01, -0.005),
    ],
)
def test_table_of_ramps(now_at: float, target: float, step: float, expected: float) -> None:
    assert ramped(now_at, target, step) == pytest.approx(expected)


@given(now_at=st.floats(-1, 1), target=st.floats(-1, 1), step=st.floats(0, 1))
def test_a_ramp_never_exceeds_what_is_asked_and_only_starts_take_time(
    now_at: float, target: float, step: float
) -> None:
    value = ramped(now_at, target, step)
    assert abs(value) <= abs(target)
    assert value == 0.0 or math.copysign(1, value) == math.copysign(1, target)
    start = abs(now_at) if math.copysign(1, now_at) == math.copysign(1, target) else 0.0
    assert abs(value) <= start + step
    if abs(target) <= start + step:
        assert value == target


def test_after_a_stop_driving_and_turning_begin_from_rest() -> None:
    ramp = Ramp(Live(BASE))
    step = 20_000_000
    for n in range(100):
        ramp.follow(0.6, 1.5, n * step)
    assert (ramp.linear, ramp.angular) == (0.6, 1.5)
    ramp.stop()
    assert (ramp.linear, ramp.angular) == (0.0, 0.0)
    ramp.follow(0.6, 1.5, 100 * step)
    assert (ramp.linear, ramp.angular) == pytest.approx((0.012, 0.05))

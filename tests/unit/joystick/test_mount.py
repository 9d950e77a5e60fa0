"""How the sensor sits in the joystick: nothing changes where it is not turned, and else readings are turned."""

import itertools
import math

import msgspec
import pytest

from giraff_core.live import Live
from giraff_core.tilt.mount import Mount, angles_of, dot, rows_of
from giraff_joystick.policy import JoystickPolicy, reading
from giraff_schemas.messages import RobotTime, Tilt
from tests.support.operators import said
from tests.unit.joystick.frames import ANGLE, EPOCH, ROBOT, tilt_frame

STEPS = [math.radians(degrees) for degrees in range(-180, 181, 45)]


def test_a_sensor_that_is_not_turned_gives_exactly_what_it_reads() -> None:
    joystick = JoystickPolicy(Live(ANGLE), ROBOT, "me")
    for x, y, z in itertools.product((-32768, -327, 0, 1, 981, 32767), repeat=3):
        frame = tilt_frame(x / 100, y / 100, z / 100)
        plain = Tilt(
            x=x / 100,
            y=y / 100,
            z=z / 100,
            status="running" if any((x, y, z)) else "bus_fault",
            tick=RobotTime(epoch=EPOCH, robot_ns=1_000),
        )
        assert msgspec.msgpack.encode(joystick.on_frame(frame, 10.0)) == msgspec.msgpack.encode(plain)
        assert reading(frame) == plain


def test_angles_and_rotations_are_each_other_also_where_roll_and_yaw_turn_about_one_axis() -> None:
    for angles in itertools.product(STEPS, repeat=3):
        rows = rows_of(*angles)
        again = rows_of(*angles_of(rows))
        assert all(math.dist(one, other) < 1e-9 for one, other in zip(rows, again, strict=True))
        assert dot(rows[0], rows[1]) == pytest.approx(0.0, abs=1e-12)
        assert math.hypot(*Mount(*angles).in_joystick((0.1, -0.2, 0.3))) == pytest.approx(math.hypot(0.1, 0.2, 0.3))


def test_a_sensor_turned_to_the_left_asks_forward_by_its_right_side() -> None:
    """Of a sensor turned 90° to the left, y points to where x was: what it reads there is forward's opposite."""
    turned = msgspec.structs.replace(ANGLE, mount_yaw=math.pi / 2)
    joystick = JoystickPolicy(Live(turned), ROBOT, "me")
    tilt = joystick.on_frame(tilt_frame(0.0, -4.9, 8.5), 10.0)
    assert (tilt.x, tilt.y, tilt.z) == pytest.approx((4.9, 0.0, 8.5))
    command = said(joystick, 10.0)
    assert command.linear_x > 0.1
    assert command.angular_z == 0.0


def test_what_is_no_hand_is_told_alike_however_the_sensor_sits() -> None:
    """The hand detector goes by what the sensor itself reads."""
    upright, askew = (
        JoystickPolicy(Live(msgspec.structs.replace(ANGLE, mount_yaw=yaw)), ROBOT, "me")
        for yaw in (0.0, 3 * math.pi / 4)
    )
    told = set()
    for number in range(80):
        frame = tilt_frame(4.9 + 0.01 * (number % 2 if number < 65 else 0), 0.0, 8.5)
        for joystick in (upright, askew):
            joystick.on_frame(frame, 10.0 + number * 0.02)
        one, other = (said(joystick, 10.0 + number * 0.02).reason for joystick in (upright, askew))
        assert one == other
        told.add(str(one).partition(";")[0])
    assert {"the tilt sensor repeats one reading", "the joystick lies tilted and nobody holds it"} < told

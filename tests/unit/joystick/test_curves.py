"""What a tilt asks for: the published curve exactly, the gentler one, and the wheels' limit on both."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.live import Live
from giraff_core.tilt import curves
from giraff_core.tilt.curves import Curve
from giraff_joystick.policy import JoystickPolicy, reading
from giraff_schemas.messages import DriveCommand
from tests.support.operators import said
from tests.support.robots import DRIVE
from tests.unit.joystick.frames import ANGLE, ROBOT, SOURCE, tilt_frame

GRAVITY = 9.80665  # m/s²
TABLE = [(0.0, 0.0), (4.49, 0.0), (4.5, 0.0), (5.0, 7.0), (7.0, 35.0), (9.5, 70.0), (12.0, 70.0)]

CONFIGS = {"source": SOURCE, "angle": ANGLE}
axis = st.integers(-(2**15), 2**15 - 1)


def asked(x: float, y: float, z: float, curve: Curve) -> DriveCommand:
    """What the curve makes of a reading; everything else about the command is left out."""
    tilt = reading(tilt_frame(x, y, z))
    linear, angular = curves.asked((tilt.x, tilt.y, tilt.z), CONFIGS[curve], ROBOT)
    return DriveCommand(operator="", lease_counter=0, linear_x=linear, angular_z=angular, source="hand", tick=None)


def levels(command: DriveCommand) -> tuple[float, float]:
    """What the two motors would get, in PWM counts."""
    turn = command.angular_z * ROBOT.track_width / 2.0
    scale = DRIVE.max_level / ROBOT.max_wheel_speed
    return (command.linear_x - turn) * scale, (command.linear_x + turn) * scale


def tilted(forward_deg: float, left_deg: float) -> tuple[float, float, float]:
    """Gravity in a sensor at rest whose x and y axes point that far above the horizontal."""
    x, y = (GRAVITY * math.sin(math.radians(angle)) for angle in (forward_deg, left_deg))
    return x, y, math.sqrt(max(0.0, GRAVITY**2 - x * x - y * y))


@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["forward", "backward"])
@pytest.mark.parametrize(("acceleration", "level"), TABLE)
def test_the_source_curve_forward_and_backward(acceleration: float, level: float, sign: float) -> None:
    left, right = levels(asked(sign * acceleration, 0.0, 1.0, "source"))
    assert left == right == pytest.approx(sign * level, abs=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["left", "right"])
@pytest.mark.parametrize(("acceleration", "level"), TABLE)
def test_the_source_curve_turns_in_place_with_opposite_wheels(acceleration: float, level: float, sign: float) -> None:
    left, right = levels(asked(0.0, sign * acceleration, 1.0, "source"))
    assert -left == right == pytest.approx(sign * level, abs=1e-9)


@given(st.integers(-450, 450), st.integers(-450, 450), axis)
def test_within_4_5_on_both_axes_the_source_curve_asks_for_nothing(x: int, y: int, z: int) -> None:
    assert asked(x / 100, y / 100, z / 100, "source").neutral


@given(st.integers(450, 950), st.integers(450, 950))
def test_combined_tilt_keeps_the_published_proportion_and_the_wheels_level(x: int, y: int) -> None:
    forward, left = 14 * x / 100 - 63, 14 * y / 100 - 63
    scale = 70.0 / max(70.0, forward + left)
    expected = ((forward - left) * scale, (forward + left) * scale)
    assert levels(asked(x / 100, y / 100, 0.0, "source")) == pytest.approx(expected, abs=1e-9)


def test_full_tilt_of_the_source_curve_is_full_speed_of_the_wheels() -> None:
    assert asked(9.5, 0.0, 1.0, "source").linear_x == pytest.approx(0.6)
    assert asked(0.0, 9.5, 1.0, "source").angular_z == pytest.approx(2 * 0.6 / 0.47)  # capped by guard, and not here


@pytest.mark.parametrize(
    ("degrees", "share"), [(0.0, 0.0), (7.9, 0.0), (8.1, 0.1 / 27), (21.5, 0.5), (35.0, 1.0), (60.0, 1.0), (90.0, 1.0)]
)
def test_the_angle_curve(degrees: float, share: float) -> None:
    for sign in (1.0, -1.0):
        forward, left = asked(*tilted(sign * degrees, 0.0), "angle"), asked(*tilted(0.0, sign * degrees), "angle")
        assert forward.linear_x == pytest.approx(sign * share * 0.6, abs=1e-3)
        assert left.angular_z == pytest.approx(sign * share * 1.57, abs=2e-3)
        assert forward.angular_z == left.linear_x == 0.0


@given(st.floats(0.0, 90.0), st.floats(0.0, 90.0))
def test_the_angle_curve_is_monotone(one: float, other: float) -> None:
    less, more = (asked(*tilted(degrees, 0.0), "angle").linear_x for degrees in sorted((one, other)))
    assert less <= more


@given(st.floats(0.0, 90.0))
def test_the_angle_curve_needs_less_tilt_than_the_source_curve(degrees: float) -> None:
    gentle, source = (asked(*tilted(degrees, 0.0), curve).linear_x for curve in ("angle", "source"))
    assert gentle >= source - 1e-9


@given(st.floats(0.5, 4.0), st.floats(-80.0, 80.0))
def test_the_angle_curve_does_not_mind_how_hard_gravity_pulls(factor: float, degrees: float) -> None:
    x, y, z = tilted(degrees, 0.0)
    one, other = asked(x, y, z, "angle"), asked(factor * x, y, factor * z, "angle")
    assert one.linear_x == pytest.approx(other.linear_x, abs=2e-3)  # the sensor counts in 0.01 m/s²


@pytest.mark.parametrize("curve", ["angle", "source"])
@given(x=axis, y=axis, z=axis)
def test_no_reading_asks_for_more_than_the_wheels_can(curve: Curve, x: int, y: int, z: int) -> None:
    command = asked(x / 100, y / 100, z / 100, curve)
    assert max(map(abs, levels(command))) <= 70.0 + 1e-9
    if curve == "angle":
        assert abs(command.angular_z) <= 1.57


@pytest.mark.parametrize("curve", ["angle", "source"])
@given(x=axis, y=axis, z=axis)
def test_the_opposite_tilt_asks_for_the_opposite(curve: Curve, x: int, y: int, z: int) -> None:
    one, other = (asked(sign * x / 100, sign * y / 100, z / 100, curve) for sign in (1, -1))
    assert (one.linear_x, one.angular_z) == (-other.linear_x, -other.angular_z)


@pytest.mark.parametrize("curve", ["angle", "source"])
@given(x=st.integers(-900, 900), y=st.integers(-900, 900), z=st.integers(100, 981))
def test_face_down_asks_for_what_the_same_tilt_asks_for_face_up(curve: Curve, x: int, y: int, z: int) -> None:
    """Whatever is level asks for nothing, and never for full speed."""
    assert asked(x / 100, y / 100, -z / 100, curve) == asked(x / 100, y / 100, z / 100, curve)


@pytest.mark.parametrize("curve", ["angle", "source"])
def test_nothing_asked_is_a_plain_zero(curve: Curve) -> None:
    command = asked(-0.01, -0.01, GRAVITY, curve)
    assert (str(command.linear_x), str(command.angular_z)) == ("0.0", "0.0")


@pytest.mark.parametrize("curve", ["angle", "source"])
@given(x=st.integers(-1500, 1500), y=st.integers(-1500, 1500), z=st.integers(400, 1500))
def test_the_policy_asks_exactly_what_the_curve_does(curve: Curve, x: int, y: int, z: int) -> None:
    """With the zero flat, to the last bit, dead bands included."""
    joystick = JoystickPolicy(Live(CONFIGS[curve]), ROBOT, "me")
    joystick.on_frame(tilt_frame(x / 100, y / 100, z / 100), 0.0)
    command, expected = said(joystick, 0.0), asked(x / 100, y / 100, z / 100, curve)
    assert (command.linear_x, command.angular_z) == (expected.linear_x, expected.angular_z)

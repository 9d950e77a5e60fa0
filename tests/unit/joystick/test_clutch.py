"""The button: neutral while pressed, and a new zero from the attitude in which it is let go."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.live import Live
from giraff_core.tilt.clutch import FLAT, Clutch, Vector, Words
from giraff_joystick.config import JoystickConfig
from giraff_joystick.policy import JoystickPolicy
from giraff_schemas.messages import DriveCommand, Lease
from giraff_schemas.trouble import Trouble
from tests.support.operators import said
from tests.unit.joystick.frames import ANGLE, ROBOT, SOURCE, tilt_frame
from tests.unit.joystick.hands import MODAL_TREMOR, readings, tilted


class Held:
    """A joystick's policy, and the hand that holds it for some time."""

    def __init__(self, config: JoystickConfig = ANGLE) -> None:
        self.policy = JoystickPolicy(Live(config), ROBOT, "me")
        self.now = 0.0

    def hold(self, seconds: float, degrees: float, *, button: bool = False) -> list[DriveCommand]:
        """Hold it tilted forward; what is asked after each reading."""
        commands = []
        for x, y, z in readings(lambda _: tilted(degrees), seconds, tremor=MODAL_TREMOR, seed=round(self.now * 50)):
            self.now += 0.02
            frame = tilt_frame(x / 100, y / 100, z / 100, button=int(button), robot_ns=round(self.now * 1e9))
            self.policy.on_frame(frame, self.now)
            commands.append(said(self.policy, self.now))
        return commands


def drives(commands: list[DriveCommand]) -> set[bool]:
    return {not command.neutral for command in commands}


@pytest.fixture
def hand() -> Held:
    return Held()


@pytest.mark.parametrize("config", [ANGLE, SOURCE], ids=["angle", "source"])
def test_pressed_is_a_hands_neutral_at_once(config: JoystickConfig) -> None:
    hand = Held(config)
    assert drives(hand.hold(0.5, 32.0)) == {True}
    pressed = hand.hold(2.0, 32.0, button=True)
    assert drives(pressed) == {False}
    assert {command.source for command in pressed} == {"hand"}


@pytest.mark.parametrize("config", [ANGLE, SOURCE], ids=["angle", "source"])
@pytest.mark.parametrize("zero", [-40.0, -20.0, 25.0, 44.0])
def test_let_go_the_attitude_is_the_new_zero(config: JoystickConfig, zero: float) -> None:
    hand = Held(config)
    hand.hold(0.5, zero, button=True)
    assert drives(hand.hold(1.0, zero)) == {False}
    tilt = 32.0  # beyond both curves' dead bands
    forward, backward = hand.hold(0.3, zero + tilt)[-1], hand.hold(0.3, zero - tilt)[-1]
    expected = Held(config).hold(0.5, tilt)[-1].linear_x
    assert forward.linear_x == pytest.approx(expected, abs=0.03)
    assert backward.linear_x == pytest.approx(-expected, abs=0.03)
    assert (forward.angular_z, backward.angular_z) == (0.0, 0.0)


def test_nothing_moves_while_it_is_let_go_beside_the_zero(hand: Held) -> None:
    hand.hold(0.5, 0.0)
    assert drives(hand.hold(1.0, 30.0, button=True) + hand.hold(1.0, 30.0)) == {False}


def assert_refused(commands: list[DriveCommand], word: str) -> None:
    after = commands[2:]  # the button does not count as let go before
    assert {command.source for command in after} == {"fault"}
    assert drives(after) == {False}
    assert word in str(after[-1].reason)
    assert "old zero" in str(after[-1].reason)


def test_beyond_45_degrees_the_old_zero_stays_and_is_waited_for(hand: Held) -> None:
    hand.hold(0.5, 47.0, button=True)
    assert_refused(hand.hold(1.0, 47.0), "45 degrees")
    assert_refused(hand.hold(0.5, 30.0), "45 degrees")  # which the old zero would drive at
    assert {command.source for command in hand.hold(0.2, 0.0)} == {"hand"}
    assert drives(hand.hold(0.5, 30.0)) == {True}


def test_a_hand_that_moves_sets_no_zero(hand: Held) -> None:
    hand.hold(0.3, 10.0, button=True)
    hand.hold(0.1, 30.0, button=True)
    assert_refused(hand.hold(0.5, 30.0), "moved")
    hand.hold(0.5, 30.0, button=True)
    assert drives(hand.hold(1.0, 30.0)) == {False}
    assert {str(command.reason) for command in hand.hold(0.5, 30.0)} == {""}


def test_one_that_was_hardly_read_sets_no_zero(hand: Held) -> None:
    hand.hold(0.06, 30.0, button=True)
    assert_refused(hand.hold(0.5, 30.0), "0.2 s")


@pytest.mark.parametrize("equal", [4, 30])
def test_a_frozen_sensor_sets_no_zero(hand: Held, equal: int) -> None:
    """Of the last equal readings three tell that the button is let go."""
    hand.hold(0.5, 30.0, button=True)
    for count in range(equal):
        hand.now += 0.02
        button = int(count < equal - 3)
        hand.policy.on_frame(tilt_frame(5.0, 0.0, 8.4, button=button, robot_ns=round(hand.now * 1e9)), hand.now)
    assert said(hand.policy, hand.now).source == "fault"
    assert_refused(hand.hold(1.0, 30.0)[25:], "0.2 s")


def test_a_bouncing_button_is_neutral_and_sets_no_zero(hand: Held) -> None:
    hand.hold(0.5, 30.0)
    bounce = hand.hold(0.02, 30.0, button=True) + hand.hold(0.04, 30.0)
    assert drives(bounce) == {False}
    assert drives(hand.hold(0.5, 30.0)) == {True}
    assert hand.hold(0.1, 0.0)[-1].neutral  # the zero is where it was


def test_a_contact_that_opens_for_a_reading_is_still_pressed(hand: Held) -> None:
    hand.hold(0.5, 30.0, button=True)
    assert drives(hand.hold(0.04, 30.0)) == {False}
    hand.hold(0.3, 0.0, button=True)
    hand.hold(0.1, 0.0)
    assert drives(hand.hold(0.5, 30.0)) == {True}


def test_a_contact_that_opens_twice_for_two_readings_is_still_pressed(hand: Held) -> None:
    hand.hold(0.5, 0.0, button=True)
    for _ in range(3):
        assert drives(hand.hold(0.04, 30.0)) == {False}
        assert drives(hand.hold(0.02, 30.0, button=True)) == {False}


def test_a_fault_counts_whatever_the_button_says(hand: Held) -> None:
    hand.hold(0.5, 0.0, button=True)
    hand.policy.on_frame(tilt_frame(0.1, 0.0, 0.1, button=1), hand.now)
    assert said(hand.policy, hand.now).source == "fault"


def test_pressing_asks_for_a_lost_lease(hand: Held) -> None:
    hand.policy.operator.on_lease(Lease(seq=1, instance="guard", holder="me", operator="joystick", counter=7))
    assert hand.hold(0.1, 0.0)[-1].lease_counter == 7
    hand.policy.operator.on_lease(
        Lease(seq=2, instance="guard", holder="other", operator="keyboard", counter=8, reason=Trouble("held"))
    )
    assert hand.hold(0.1, 0.0)[-1].lease_counter == 7
    assert hand.policy.operator.refusal
    assert hand.hold(0.1, 0.0, button=True)[-1].lease_counter == 0


def unit(x: float, y: float, z: float) -> Vector:
    length = math.hypot(x, y, z)
    return x / length, y / length, z / length


directions = st.tuples(*[st.floats(-1.0, 1.0)] * 2).map(lambda xy: unit(xy[0], xy[1], 1.5))


@given(directions, st.tuples(*[st.floats(-40.0, 40.0)] * 3))
def test_turning_to_the_zero_is_a_rotation_that_lays_it_flat(zero: Vector, vector: Vector) -> None:
    clutch = Clutch(Words("", "", ""))
    clutch.zero = zero
    assert clutch.relative(zero) == pytest.approx(FLAT, abs=1e-12)
    assert math.hypot(*clutch.relative(vector)) == pytest.approx(math.hypot(*vector), abs=1e-9)
    x, y, _ = zero
    axis = (y, -x, 0.0)  # of the smallest turn: what lies along it stays
    assert clutch.relative(axis) == pytest.approx(axis, abs=1e-12)


@given(st.tuples(*[st.floats(-40.0, 40.0)] * 3))
def test_with_the_zero_flat_nothing_is_changed(vector: Vector) -> None:
    assert Clutch(Words("", "", "")).relative(vector) == vector

"""What presses ask of the robot: for how long, with which moment, and under whose lease."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.operator import ASKS_NOTHING, LINK_SILENCE
from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.policy import KEY_LASTS, Key
from giraff_schemas.messages import DriveCommand, RobotTime, Tick
from giraff_schemas.trouble import NO_TROUBLE
from tests.support.operators import said
from tests.support.robots import ROBOT
from tests.unit.keyboard.keyboards import EPOCH, Person, person


def assert_fault(command: DriveCommand, *words: str) -> None:
    assert command.neutral
    assert command.source == "fault"
    for word in words:
        assert word in str(command.reason)


@pytest.fixture
def someone() -> Person:
    return person()


@pytest.mark.parametrize(
    ("key", "linear", "angular"),
    [
        (Key.FORWARD, 0.6, 0.0),
        (Key.BACKWARD, -0.6, 0.0),
        (Key.LEFT, 0.0, 1.57),
        (Key.RIGHT, 0.0, -1.57),
        (Key.CLUTCH, 0.0, 0.0),
        (Key.FASTER, 0.0, 0.0),
        (Key.NOTHING, 0.0, 0.0),
    ],
)
def test_a_press_asks_for_its_direction(key: Key, linear: float, angular: float) -> None:
    command = person().press(key)
    assert (command.linear_x, command.angular_z) == pytest.approx((linear, angular))
    assert (command.source, str(command.reason), command.operator) == ("hand", "", "keyboard")


def test_without_a_press_a_hand_asks_for_nothing_with_the_newest_moment(someone: Person) -> None:
    for command in someone.wait(1.0):
        assert command.neutral
        assert (command.source, str(command.reason)) == ("hand", "")
    assert said(someone.policy, someone.now).tick == someone.tick_now


def test_a_press_lasts_0_4_s_with_the_tick_of_its_moment(someone: Person) -> None:
    pressed_at = someone.tick_now
    commands = [someone.press(Key.FORWARD), *someone.wait(0.6)]
    moving = [command for command in commands if not command.neutral]
    assert len(moving) == 1 + round(KEY_LASTS / 0.02)
    assert {command.tick for command in moving} == {pressed_at}
    assert all(command.neutral for command in commands[len(moving) :])


def test_each_repeat_is_a_press_of_its_own(someone: Person) -> None:
    for _ in range(30):
        command = someone.press(Key.LEFT)
        assert command.angular_z > 0.0
        assert command.tick == someone.tick_now
        assert not any(command.neutral for command in someone.wait(0.04))


def test_a_press_expires_by_the_robots_clock_where_this_one_stood_still(someone: Person) -> None:
    someone.press(Key.FORWARD)
    someone.robot_ns += round((KEY_LASTS + 0.01) * 1e9)
    someone.tick()
    assert said(someone.policy, someone.now).neutral


def test_a_press_expires_by_this_machines_clock_where_the_robots_is_not_heard(someone: Person) -> None:
    someone.press(Key.FORWARD)
    commands = someone.wait(0.46, ticks=False)
    assert [command.neutral for command in commands] == [False] * 20 + [True] * 3
    assert {command.source for command in commands} == {"hand"}


def test_the_newest_press_alone_counts(someone: Person) -> None:
    someone.press(Key.FORWARD)
    assert (someone.press(Key.LEFT).linear_x, someone.press(Key.NOTHING).neutral) == (0.0, True)


def test_speed_steps() -> None:
    someone = person(KeyboardConfig(steps=5, first_step=2))
    assert someone.press(Key.FORWARD).linear_x == pytest.approx(0.24)
    for _ in range(9):
        someone.press(Key.FASTER)
    assert someone.press(Key.FORWARD).linear_x == pytest.approx(0.6)
    for _ in range(9):
        someone.press(Key.SLOWER)
    assert someone.press(Key.BACKWARD).linear_x == pytest.approx(-0.12)


def test_before_the_first_tick_the_robot_is_lost() -> None:
    someone = Person()
    assert_fault(someone.press(Key.FORWARD), "no tick", "base", "network")
    someone.wait(0.02)
    assert said(someone.policy, someone.now).neutral  # nobody knows how old that press was


def test_without_ticks_for_half_a_second_the_robot_is_lost(someone: Person) -> None:
    commands = someone.wait(1.0, ticks=False)
    lost = [command.source for command in commands].index("fault")
    assert (lost + 1) * 0.02 == pytest.approx(LINK_SILENCE, abs=0.03)
    assert_fault(commands[-1], "no tick", "base", "network")
    assert_fault(someone.press(Key.FORWARD), "no tick")
    assert someone.wait(0.02)[0].source == "hand"


def test_old_ticks_that_come_again_are_no_sign_of_the_robot(someone: Person) -> None:
    last = someone.tick_now
    for _ in range(9):
        someone.wait(0.02, ticks=False)
        someone.policy.operator.on_tick(Tick(epoch=EPOCH, robot_ns=last.robot_ns - 2_000_000_000), someone.now)
    assert said(someone.policy, someone.now).tick == last
    someone.wait(LINK_SILENCE - 0.16, ticks=False)
    assert_fault(said(someone.policy, someone.now), "no tick")


def test_nobody_takes_the_robot_by_starting_a_program(someone: Person) -> None:
    assert {command.lease_counter for command in someone.wait(1.0)} == {ASKS_NOTHING}
    someone.hear("", 0)
    assert {command.lease_counter for command in someone.wait(1.0)} == {ASKS_NOTHING}
    someone.hear("joystick", 8, seq=2)
    assert {command.lease_counter for command in someone.wait(1.0)} == {ASKS_NOTHING}


@pytest.mark.parametrize("key", [Key.FORWARD, Key.RIGHT, Key.CLUTCH])
def test_a_press_asks_for_the_lease_as_long_as_it_lasts(someone: Person, key: Key) -> None:
    assert someone.press(key).lease_counter == 0
    counters = [command.lease_counter for command in someone.wait(0.6)]
    assert counters == [0] * 20 + [ASKS_NOTHING] * 10
    someone.press(key)
    someone.hear("me", 9)
    assert {command.lease_counter for command in someone.wait(1.0)} == {9}
    someone.hear("joystick", 10, seq=2)
    assert 9 not in {command.lease_counter for command in someone.wait(1.0)}
    assert someone.press(key).lease_counter == 0


@pytest.mark.parametrize("key", [Key.FASTER, Key.SLOWER, Key.NOTHING, Key.STOP, Key.RESET, Key.YES])
def test_no_other_key_asks_for_it(key: Key) -> None:
    assert person().press(key).lease_counter == ASKS_NOTHING


def test_who_drives_is_known(someone: Person) -> None:
    someone.hear("joystick", 3, reason="held by joystick")
    assert someone.policy.operator.holder == "joystick"
    assert "joystick" in str(someone.policy.operator.refusal)
    someone.hear("me", 4, seq=2)
    assert someone.policy.operator.refusal == NO_TROUBLE


def test_the_space_bar_stops_at_once_and_until_base_has_confirmed(someone: Person) -> None:
    someone.press(Key.FORWARD)
    assert_fault(someone.press(Key.STOP), "space bar", "not yet confirmed")
    someone.wait(1.0)
    assert_fault(someone.press(Key.FORWARD), "space bar")
    someone.wait(0.5)
    someone.policy.on_stopped()
    assert {(command.neutral, command.source) for command in someone.wait(0.5)} == {(True, "hand")}


steps = st.one_of(st.sampled_from(Key), st.floats(0.0, 0.7), st.none())


@given(st.lists(steps, max_size=60))
def test_it_never_moves_on_anything_but_a_press_of_the_last_0_4_s(events: list[Key | float | None]) -> None:
    """Keys, pauses with ticks, and None for a pause without."""
    someone = Person()
    pressed, moment = -1.0, None
    for event in events:
        if isinstance(event, Key):
            someone.press(event)
            drives = event in (Key.FORWARD, Key.BACKWARD, Key.LEFT, Key.RIGHT)
            pressed = someone.now if drives else -1.0
            moment = someone.tick_now
        else:
            someone.wait(0.3 if event is None else event, ticks=event is not None)
        command = said(someone.policy, someone.now)
        if not command.neutral:
            assert someone.now - pressed <= KEY_LASTS + 1e-9
            assert command.tick is not None
            assert moment is not None
            assert command.tick.robot_ns <= moment.robot_ns
            assert command.source == "hand"
        assert (command.source == "fault") == bool(command.reason)
        assert command.neutral or command.lease_counter == 0
        assert abs(command.linear_x) <= ROBOT.max_wheel_speed + 1e-9
        assert command.tick is None or command.tick == RobotTime(epoch=EPOCH, robot_ns=command.tick.robot_ns)

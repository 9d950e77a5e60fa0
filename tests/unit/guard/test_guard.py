"""Whose command counts, how much of it passes, and what the guard says about it."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_schemas.messages import GuardedCommand, GuardState, RobotTime, Verdict
from tests.unit.guard.rig import EPOCH, FAR, NEAR, Rig, robot_with


def test_before_any_tick_nothing_passes() -> None:
    rig = Rig(ticking=False)
    rig.hear(FAR)
    rig.ask(0.6)
    command, state = rig.decide()
    assert command.neutral
    assert not command.hand_neutral
    assert (command.guard_tick, command.operator, command.source) == (None, "", "fault")
    assert "start giraff_base" in command.reason
    assert state.reason == command.reason
    assert state.forward.freedom == "blocked"


def test_before_any_operator_nothing_passes() -> None:
    rig = Rig()
    rig.hear(FAR)
    command, state = rig.decide()
    assert command.neutral
    assert not command.hand_neutral
    assert command.source == "fault"
    assert "start giraff_joystick" in command.reason
    assert state.operator == ""


def test_a_fresh_command_passes_with_all_that_base_judges_it_by() -> None:
    rig = Rig()
    rig.hear(FAR)
    asked = rig.ask(0.5, -0.4)
    command, state = rig.decide()
    assert (command.linear_x, command.angular_z) == (0.5, -0.4)
    assert command.guard_tick == RobotTime(epoch=EPOCH, robot_ns=rig.robot_ns)
    assert (command.operator, command.operator_tick) == ("operator-1", asked.tick)
    assert (command.source, command.hand_neutral, command.reason) == ("hand", False, "")
    assert (state.operator, state.reason) == ("operator-1", "")


def test_the_guards_moment_is_the_newest_tick_and_not_now() -> None:
    rig = Rig()
    heard = rig.robot_ns
    rig.wait(0.3)
    rig.ask(0.0)
    assert rig.decide()[0].guard_tick == RobotTime(epoch=EPOCH, robot_ns=heard)


@pytest.mark.parametrize(
    ("linear", "angular", "neutral"), [(0.0, 0.0, True), (0.1, 0.0, False), (0.0, 0.1, False), (-0.0, 0.0, True)]
)
def test_a_neutral_hand_is_told_by_what_it_asks(linear: float, angular: float, neutral: bool) -> None:
    rig = Rig()
    rig.hear(FAR)
    rig.ask(linear, angular)
    assert rig.decide()[0].hand_neutral is neutral


def test_a_command_that_was_cut_to_zero_is_no_neutral_hand() -> None:
    rig = Rig()
    rig.hear(NEAR)
    rig.ask(0.6)
    command, _ = rig.decide()
    assert command.neutral
    assert not command.hand_neutral


@pytest.mark.parametrize(("age", "passes"), [(0.0, True), (0.4, True), (0.4 + 1e-9, False), (5.0, False)])
def test_a_command_counts_to_the_edge_of_its_budget(age: float, passes: bool) -> None:
    rig = Rig()
    rig.hear(FAR)
    rig.ask(0.5, 0.2, age=age)
    command, _ = rig.decide()
    assert command.neutral is not passes
    assert (command.reason == "") is passes
    assert not command.hand_neutral
    if not passes:
        assert f"{age:.1f} s old" in command.reason
        assert "check its link" in command.reason


@pytest.mark.parametrize("age", [0.0, 0.5])
def test_a_stale_neutral_hand_is_none(age: float) -> None:
    rig = Rig()
    rig.hear(FAR)
    rig.ask(0.0, age=age)
    assert rig.decide()[0].hand_neutral is (age == 0.0)


@pytest.mark.parametrize(
    "tick",
    [RobotTime(epoch=EPOCH + 1, robot_ns=5), RobotTime(epoch=0, robot_ns=5), RobotTime(epoch=EPOCH, robot_ns=1 << 62)],
    ids=["other epoch", "nobody's", "ahead"],
)
def test_a_command_of_no_known_age_does_not_pass(tick: RobotTime) -> None:
    rig = Rig()
    rig.hear(FAR)
    rig.ask(0.5, tick=tick)
    command, _ = rig.decide()
    assert command.neutral
    assert "no moment of this robot's clock" in command.reason


def test_a_command_gets_old_while_nothing_comes() -> None:
    rig = Rig()
    rig.ask(0.0, 1.0, age=0.0)
    passed = []
    for _ in range(50):
        rig.wait(0.01)
        passed.append(rig.decide()[0].angular_z)
    assert passed == [1.0] * 40 + [0.0] * 10


def test_a_new_epoch_makes_all_that_was_heard_worthless() -> None:
    rig = Rig()
    rig.hear(FAR)
    rig.ask(0.5, 0.5)
    rig.tick(EPOCH + 1)
    command, state = rig.decide()
    assert command.neutral
    assert command.reason
    assert state.forward.freedom == "blocked"


def test_an_operators_fault_stops_and_is_told() -> None:
    rig = Rig()
    rig.hear(FAR)
    rig.ask(0.5, 0.5, source="fault", reason="the sensor is not running; check its plug")
    command, state = rig.decide()
    assert command.neutral
    assert command.source == "fault"
    assert not command.hand_neutral
    assert "the sensor is not running; check its plug" in command.reason
    assert state.reason == command.reason
    rig.ask(0.0, 0.0, source="fault", reason="x")
    assert not rig.decide()[0].hand_neutral


def test_the_first_operator_is_in_charge() -> None:
    rig = Rig()
    for _ in range(100):
        rig.ask(0.0, 0.5, operator="operator-1")
        rig.ask(0.0, -0.5, operator="operator-2")
        command, state = rig.decide()
        assert (command.angular_z, command.operator, state.operator) == (0.5, "operator-1", "operator-1")
        rig.wait(0.02)


@pytest.mark.parametrize(("silence", "taken"), [(0.5, False), (1.0, False), (1.0 + 1e-9, True)])
def test_a_second_one_takes_over_after_a_second_of_silence(silence: float, taken: bool) -> None:
    rig = Rig()
    rig.ask(0.0, 0.5, operator="operator-1")
    rig.wait(silence)
    rig.ask(0.0, -0.5, operator="operator-2")
    command, _ = rig.decide()
    assert command.operator == ("operator-2" if taken else "operator-1")
    assert command.angular_z == (-0.5 if taken else 0.0 if silence > 0.4 else 0.5)


@pytest.mark.parametrize("age", [0.41, 5.0, -1.0])
def test_stale_commands_do_not_hold_the_place(age: float) -> None:
    rig = Rig()
    rig.ask(0.0, 0.5, operator="operator-1")
    for _ in range(101):
        rig.wait(0.01)
        rig.ask(0.0, 0.5, operator="operator-1", age=age)
    rig.ask(0.0, -0.5, operator="operator-2")
    assert rig.decide()[0].operator == "operator-2"


def test_one_whose_commands_prove_nothing_does_not_take_the_place() -> None:
    rig = Rig()
    rig.ask(0.0, 0.5, operator="operator-1", age=5.0)
    rig.ask(0.0, -0.5, operator="operator-2")
    command, _ = rig.decide()
    assert (command.operator, command.angular_z) == ("operator-2", -0.5)


def test_a_fault_holds_the_place() -> None:
    rig = Rig()
    for _ in range(30):
        rig.ask(0.0, source="fault", reason="x", operator="operator-1")
        rig.wait(0.1)
        rig.ask(0.0, -0.5, operator="operator-2")
    assert rig.decide()[0].operator == "operator-1"


@pytest.mark.parametrize("seq", [9, 10, 0])
def test_an_older_or_repeated_command_is_ignored(seq: int) -> None:
    rig = Rig()
    rig.ask(0.0, 0.5, seq=10)
    rig.ask(0.0, -0.5, seq=seq)
    assert rig.decide()[0].angular_z == 0.5
    rig.ask(0.0, -0.5, seq=11)
    assert rig.decide()[0].angular_z == -0.5


def test_an_operator_that_speaks_before_base_is_heard_is_not_in_charge() -> None:
    rig = Rig(ticking=False)
    rig.ask(0.0, 0.5, operator="operator-1")
    rig.tick()
    rig.ask(0.0, -0.5, operator="operator-2")
    assert rig.decide()[0].operator == "operator-2"


def test_an_older_reading_does_not_replace_a_newer_one() -> None:
    rig = Rig()
    rig.hear(NEAR, seq=10)
    rig.hear(FAR, seq=9)
    assert rig.passes(0.6) == (0.0, 0.0)
    rig.hear(FAR, seq=11)
    assert rig.passes(0.6) == (0.6, 0.0)


@pytest.mark.parametrize(("linear", "expected"), [(0.6, 0.15), (-0.6, 0.02), (0.01, 0.15), (0.0, None)])
def test_the_ranges_moment_is_the_oldest_that_the_motion_relies_on(linear: float, expected: float | None) -> None:
    rig = Rig()
    rig.hear(FAR, "front_left", age=0.05)
    rig.hear(FAR, "front_right", age=0.15)
    rig.hear(FAR, "rear", age=0.02)
    rig.ask(linear, 1.0)
    assert rig.decide()[0].range_tick == (None if expected is None else rig.ago(expected))


def test_a_blocked_way_still_relies_on_its_ranges() -> None:
    rig = Rig()
    rig.hear(NEAR, age=0.1)
    rig.ask(0.6, 1.0)
    assert rig.decide()[0].range_tick == rig.ago(0.1)


@pytest.mark.parametrize("missing", ["never heard", "other epoch"])
def test_a_range_that_proves_nothing_counts_as_the_beginning_of_time(missing: str) -> None:
    rig = Rig()
    rig.hear(FAR, "front_left")
    if missing == "other epoch":
        rig.hear(FAR, "front_right", tick=RobotTime(epoch=EPOCH + 1, robot_ns=rig.robot_ns))
    rig.ask(0.6)
    assert rig.decide()[0].range_tick == RobotTime(epoch=EPOCH, robot_ns=0)


def test_a_way_without_a_sensor_relies_on_none() -> None:
    rig = Rig(robot_with("rear"))
    rig.ask(0.6)
    command, _ = rig.decide()
    assert command.range_tick is None
    assert command.linear_x == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("linear", "angular", "passed"),
    [
        (0.0, 3.0, (0.0, 1.57)),
        (0.0, -3.0, (0.0, -1.57)),
        (0.4, 3.14, (0.2, 1.57)),
        (-0.001, 3.14, (-0.0005, 1.57)),
        (1.2, 0.0, (0.6, 0.0)),
        (-1.2, 1.0, (-0.6, 0.5)),
        (0.6, 1.57, (0.6, 1.57)),
    ],
)
def test_what_the_robot_cannot_do_is_scaled_and_named(
    linear: float, angular: float, passed: tuple[float, float]
) -> None:
    rig = Rig()
    rig.hear(FAR)
    assert rig.passes(linear, angular) == pytest.approx(passed)
    reason = rig.decide()[0].reason
    assert (reason == "") is ((linear, angular) == passed)
    assert not reason or "this robot" in reason


@pytest.mark.parametrize("angular", [1.5, 0.36, 0.35, 0.2, 0.0, -0.2, -1.5])
def test_rotation_passes_slowly_where_the_way_ahead_is_blocked(angular: float) -> None:
    rig = Rig()
    rig.hear(NEAR)
    linear, passed = rig.passes(0.6, angular)
    assert linear == 0.0
    assert passed == pytest.approx(math.copysign(min(abs(angular), 0.35), angular))
    assert rig.decide()[0].reason.startswith("forward blocked: ")


def test_the_verdict_on_turning_says_when_and_why_it_is_slow() -> None:
    rig = Rig()
    rig.hear(FAR)
    rig.hear(NEAR, "front_left")
    rig.ask(0.0, 1.0)
    _, state = rig.decide()
    assert state.turn_left == Verdict(allowed=1.57, freedom="free", sensor="", reason="", way_out="")
    rig.ask(-0.1, 1.0)
    assert rig.decide()[1].turn_left.freedom == "free"
    rig.ask(0.1, 1.0)
    _, state = rig.decide()
    assert state.turn_left == state.turn_right
    assert (state.turn_left.allowed, state.turn_left.freedom) == (0.35, "creep")
    assert state.turn_left.sensor == "front_left"
    assert state.turn_left.reason
    assert state.turn_left.way_out


def check_verdicts(state: GuardState) -> None:
    """That each verdict is whole: it says no without a number, a reason and a way out for nobody."""
    for verdict in (state.forward, state.backward, state.turn_left, state.turn_right):
        assert verdict.allowed >= 0.0
        assert (verdict.freedom == "blocked") == (verdict.allowed == 0.0)
        assert (verdict.freedom == "free") == (verdict.reason == "")
        if verdict.freedom == "blocked":
            assert verdict.sensor
            assert verdict.way_out


def check_passed(command: GuardedCommand, state: GuardState, linear: float, angular: float) -> None:
    """That what passed is never more than was asked or allowed, and that the difference is explained."""
    for passed, asked in ((command.linear_x, linear), (command.angular_z, angular)):
        assert abs(passed) <= abs(asked)
        assert passed * asked >= 0.0
    assert abs(command.linear_x) <= (state.forward if linear > 0.0 else state.backward).allowed + 1e-12
    assert abs(command.angular_z) <= 1.57
    if command.linear_x != 0.0:
        assert command.angular_z / command.linear_x == pytest.approx(angular / linear)
    elif linear != 0.0:
        assert abs(command.angular_z) <= 0.35
    if (command.linear_x, command.angular_z) != (linear, angular):
        assert command.reason
    assert state.reason == command.reason


AGES_MS = st.integers(-100, 600)


@given(
    linear=st.one_of(st.just(0.0), st.floats(-2.0, 2.0).filter(lambda v: abs(v) > 1e-6)),
    angular=st.floats(-6.0, 6.0),
    distances=st.tuples(*[st.one_of(st.none(), st.floats(0.02, 4.0))] * 3),
    ages_ms=st.tuples(*[AGES_MS] * 3),
    command_age_ms=AGES_MS,
    velocity=st.floats(-0.7, 0.7),
    faulty=st.sampled_from(["", "", "", "front_left", "rear"]),
    waits_ms=st.lists(st.integers(0, 200), max_size=5),
)
def test_whatever_comes_in_no_more_comes_out_than_was_asked(
    linear: float,
    angular: float,
    distances: tuple[float | None, ...],
    ages_ms: tuple[int, ...],
    command_age_ms: int,
    velocity: float,
    faulty: str,
    waits_ms: list[int],
) -> None:
    rig = Rig()
    for wait in [0, *waits_ms]:
        rig.wait(wait / 1000)
        for sensor, distance, age_ms in zip(rig.robot.sensors, distances, ages_ms, strict=True):
            rig.hear(distance, sensor, age=age_ms / 1000, fault="broken" if sensor == faulty else "")
        rig.move(velocity)
        rig.ask(linear, angular, age=command_age_ms / 1000)
        command, state = rig.decide()
        check_passed(command, state, linear, angular)
        check_verdicts(state)
        if not 0 <= command_age_ms <= 400:
            assert command.neutral


def test_where_the_wheels_are_not_heard_it_reckons_with_what_it_passed_on() -> None:
    rig = Rig()
    rig.hear(FAR)
    rig.ask(0.6)
    assert rig.decide()[0].linear_x == 0.6
    rig.wait(0.02)
    rig.hear(0.5)  # room to go on slowly, and not to stop in from 0.6 m/s
    rig.ask(0.6)
    command, state = rig.decide()
    assert command.linear_x == 0.0
    assert "braking" in state.forward.reason

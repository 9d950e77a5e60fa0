"""Whose command counts, how much of it passes, and what the guard says about it."""

import msgspec
import pytest

from giraff_core.lease import ASK
from giraff_schemas.messages import Range, RobotTime, Wheels
from giraff_schemas.trouble import NO_TROUBLE
from tests.unit.guard.rig import CONFIG, EPOCH, FAR, FIRST_LEASE, NEAR, OPERATOR, Rig


def test_before_any_tick_nothing_passes() -> None:
    rig = Rig(ticking=False)
    rig.hear(FAR)
    rig.ask(0.6)
    command, state = rig.decide()
    assert command.neutral
    assert not command.hand_neutral
    assert (command.guard_tick, command.operator, command.source) == (None, "", "fault")
    assert "start giraff_base" in str(command.reason)
    assert state.reason == command.reason
    assert state.forward.clearance == "blocked"


def test_before_any_operator_nothing_passes(rig: Rig) -> None:
    rig.hear(FAR)
    command, state = rig.decide()
    assert command.neutral
    assert not command.hand_neutral
    assert command.source == "fault"
    assert "start giraff drive" in str(command.reason)
    assert state.operator == ""


def test_a_fresh_command_passes_with_all_that_base_judges_it_by(rig: Rig) -> None:
    rig.look()
    rig.hear(FAR)
    asked = rig.ask(0.5, -0.4)
    command, state = rig.decide()
    assert (command.linear_x, command.angular_z) == (0.5, -0.4)
    assert command.guard_tick == RobotTime(epoch=EPOCH, robot_ns=rig.robot_ns)
    assert (command.operator, command.operator_tick) == (OPERATOR, asked.tick)
    assert command.lease_counter == FIRST_LEASE
    assert (command.source, command.hand_neutral, str(command.reason)) == ("hand", False, "")
    assert (state.operator, str(state.reason)) == (OPERATOR, "")


def test_the_guards_moment_is_the_newest_tick_and_not_now(rig: Rig) -> None:
    heard = rig.robot_ns
    rig.pause(0.3)
    rig.ask(0.0)
    assert rig.decide()[0].guard_tick == RobotTime(epoch=EPOCH, robot_ns=heard)


@pytest.mark.parametrize(
    ("linear", "angular", "neutral"), [(0.0, 0.0, True), (0.1, 0.0, False), (0.0, 0.1, False), (-0.0, 0.0, True)]
)
def test_a_neutral_hand_is_told_by_what_it_asks(rig: Rig, linear: float, angular: float, neutral: bool) -> None:
    rig.hear(FAR)
    rig.ask(linear, angular)
    assert rig.decide()[0].hand_neutral is neutral


def test_a_command_that_was_cut_to_zero_is_no_neutral_hand(rig: Rig) -> None:
    rig.hear(NEAR)
    rig.ask(0.6)
    command, _ = rig.decide()
    assert command.neutral
    assert not command.hand_neutral


@pytest.mark.parametrize(("age", "passes"), [(0.0, True), (0.4, True), (0.4 + 1e-9, False), (5.0, False)])
def test_a_command_counts_to_the_edge_of_its_budget(rig: Rig, age: float, passes: bool) -> None:
    rig.look()
    rig.hear(FAR)
    rig.ask(0.5, 0.2, age=age)
    command, _ = rig.decide()
    assert command.neutral is not passes
    assert (str(command.reason) == "") is passes
    assert not command.hand_neutral
    if not passes:
        assert f"{age:.1f} s old" in str(command.reason)
        assert "check its link" in str(command.reason)


@pytest.mark.parametrize("age", [0.0, 0.5])
def test_a_stale_neutral_hand_is_none(rig: Rig, age: float) -> None:
    rig.hear(FAR)
    rig.ask(0.0, age=age)
    assert rig.decide()[0].hand_neutral is (age == 0.0)


@pytest.mark.parametrize(
    "tick",
    [RobotTime(epoch=EPOCH + 1, robot_ns=5), RobotTime(epoch=0, robot_ns=5), RobotTime(epoch=EPOCH, robot_ns=1 << 62)],
    ids=["other epoch", "nobody's", "ahead"],
)
def test_a_command_of_no_known_age_does_not_pass(rig: Rig, tick: RobotTime) -> None:
    rig.hear(FAR)
    rig.ask(0.5, tick=tick)
    command, _ = rig.decide()
    assert command.neutral
    assert "no moment of this robot's clock" in str(command.reason)


def test_a_command_gets_old_while_nothing_comes(rig: Rig) -> None:
    rig.ask(0.0, 1.0, age=0.0)
    passed = []
    for _ in range(50):
        rig.wait(0.01)
        passed.append(rig.decide()[0].angular_z)
    assert passed == [1.0] * 40 + [0.0] * 10


def test_a_new_epoch_makes_all_that_was_heard_worthless(rig: Rig) -> None:
    rig.hear(FAR)
    rig.ask(0.5, 0.5)
    rig.pause(0.51)
    rig.tick(EPOCH + 1)
    for _ in range(10):
        rig.ask(0.5, 0.5)  # with ticks of the old epoch
        command, state = rig.decide()
        assert command.neutral
        assert command.guard_tick == rig.ago(0.0, EPOCH + 1)
        assert command.reason
        assert "has not been heard yet" in str(state.forward.reason)


def test_base_falling_silent_stops_the_robot_and_is_told(rig: Rig) -> None:
    rig.hear(FAR)
    rig.ask(0.5)
    rig.pause(0.51)
    rig.ask(0.5, age=0.0)
    command, _ = rig.decide()
    assert command.neutral
    assert (command.source, command.hand_neutral) == ("hand", False)
    assert "start giraff_base" in str(command.reason)


def test_an_operators_fault_stops_and_is_told(rig: Rig) -> None:
    rig.hear(FAR)
    rig.ask(0.5, 0.5, source="fault", reason="the sensor is not running; check its plug")
    command, state = rig.decide()
    assert command.neutral
    assert command.source == "fault"
    assert not command.hand_neutral
    assert "the sensor is not running; check its plug" in str(command.reason)
    assert state.reason == command.reason
    rig.ask(0.0, 0.0, source="fault", reason="x")
    assert not rig.decide()[0].hand_neutral


def test_only_the_holder_of_the_lease_is_obeyed(rig: Rig) -> None:
    for _ in range(100):
        rig.ask(0.0, 0.5)
        for counter in (ASK, FIRST_LEASE):
            rig.ask(0.0, -0.5, operator="operator-2", counter=counter)
        command, state = rig.decide()
        assert (command.angular_z, command.operator, state.operator) == (0.5, OPERATOR, OPERATOR)
        assert rig.lease is not None
        assert (rig.lease.holder, rig.lease.operator, rig.lease.counter) == (OPERATOR, "joystick", FIRST_LEASE)
        assert "held by joystick" in str(rig.lease.reason)
        rig.wait(0.02)


def test_a_grant_by_itself_moves_nothing_and_arms_nothing(rig: Rig) -> None:
    rig.hear(FAR)
    rig.ask(0.5, counter=ASK)
    command, _ = rig.decide()
    assert command.neutral
    assert (command.operator, command.lease_counter) == (OPERATOR, FIRST_LEASE)
    assert (command.operator_tick, command.source, command.hand_neutral) == (None, "fault", False)


def test_a_lease_that_ended_is_nobodys(rig: Rig) -> None:
    rig.hear(FAR)
    rig.ask(0.5)
    rig.wait(1.0 + 1e-9)
    command, state = rig.decide()
    assert command.neutral
    assert (command.operator, command.lease_counter, state.operator) == ("", 0, "")
    assert (command.operator_tick, command.source, command.hand_neutral) == (None, "fault", False)
    assert rig.lease is not None
    assert (rig.lease.holder, rig.lease.operator, rig.lease.counter) == ("", "", 0)
    assert command.reason == rig.lease.reason
    assert "joystick was silent for 1 s" in str(command.reason)


def test_a_hand_over_has_another_lease_and_begins_neutral() -> None:
    rig = Rig(config=msgspec.structs.replace(CONFIG, priorities={"carer": 1}))
    rig.ask(0.0, 0.5)
    rig.ask(0.0, -0.5, operator="operator-2", name="carer", counter=ASK)
    command, _ = rig.decide()
    assert command.neutral
    assert (command.operator, command.lease_counter) == ("operator-2", FIRST_LEASE + 1)
    assert (command.operator_tick, command.source) == (None, "fault")  # nothing of the last holder's
    rig.ask(0.0, 0.5, counter=FIRST_LEASE)
    rig.ask(0.0, 0.5, counter=FIRST_LEASE + 1)
    assert rig.decide()[0].neutral
    rig.ask(0.0, -0.5, operator="operator-2", name="carer")
    assert rig.decide()[0].angular_z == -0.5


@pytest.mark.parametrize("seq", [9, 10, 0])
def test_an_older_or_repeated_command_is_ignored(rig: Rig, seq: int) -> None:
    rig.ask(0.0, 0.5, seq=10)
    rig.ask(0.0, -0.5, seq=seq)
    assert rig.decide()[0].angular_z == 0.5
    rig.ask(0.0, -0.5, seq=11)
    assert rig.decide()[0].angular_z == -0.5


def test_an_operator_that_asks_before_base_is_heard_is_not_in_charge() -> None:
    rig = Rig(ticking=False)
    rig.ask(0.0, 0.5, operator="operator-1", counter=ASK)
    rig.tick()
    rig.ask(0.0, -0.5, operator="operator-2", counter=ASK)
    assert rig.decide()[0].operator == "operator-2"


def test_a_second_base_stops_the_robot_and_is_named_while_both_speak(rig: Rig) -> None:
    for _ in range(50):
        rig.wait(0.02)
        rig.hear(FAR)
        rig.tick(EPOCH + 1)
        rig.ask(0.5, 0.5)
        command, state = rig.decide()
        assert command.neutral
        assert (command.source, command.hand_neutral, command.operator) == ("fault", False, OPERATOR)
        for text in (command.reason, state.reason, str(rig.guard.fault)):
            assert f"base-{EPOCH}/" in str(text)
            assert f"base-{EPOCH + 1}/" in str(text)
    for _ in range(26):
        rig.wait(0.02)
        rig.hear(FAR)
        rig.ask(0.5, 0.5)
    assert rig.decide()[0].linear_x == 0.5
    assert rig.guard.fault == NO_TROUBLE


def test_a_fault_that_no_command_shows_is_counted(rig: Rig) -> None:
    rig.ask(0.5)
    assert rig.decide()[0].faults == 0
    rig.ask(0.0, source="fault", reason="shaken")
    rig.ask(0.5)
    command = rig.decide()[0]
    assert (command.source, command.faults) == ("hand", 1)
    for _ in range(3):
        rig.tick(EPOCH + 1)  # a second base
        command = rig.decide()[0]
        assert (command.source, command.faults) == ("fault", 2)


def test_a_second_ranger_stops_the_robot_and_is_named_while_both_speak(rig: Rig) -> None:
    for _ in range(20):
        rig.wait(0.18)
        rig.hear(FAR, ranger="ranger-1")
        rig.hear(FAR, ranger="ranger-2")
        rig.ask(0.0, 0.5)
        command, state = rig.decide()
        assert command.neutral
        assert command.source == "fault"
        assert "ranger-2, speaks beside ranger-1" in str(command.reason)
        assert "ranger-2, speaks beside ranger-1" in str(state.sensors["rear"])
    rig.hear(NEAR, ranger="ranger-2")  # not listened to
    assert rig.decide()[1].forward.clearance == "free"


def test_a_restarted_ranger_is_listened_to_and_has_the_robot_armed_anew(rig: Rig) -> None:
    rig.look(ranger="ranger-1")
    rig.wait(0.6)
    rig.hear(FAR, ranger="ranger-2")
    rig.ask(0.5)
    command, _ = rig.decide()
    assert (command.neutral, command.source) == (True, "fault")
    assert command.reason.action == "hold_level"
    rig.look(ranger="ranger-2")
    rig.ask(0.5)
    assert rig.decide()[0].linear_x == 0.5


def test_only_readings_and_wheels_of_those_it_is_bound_to_are_judged(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    rig.hear(FAR)
    judged: list[Range | Wheels] = []

    def judge(sample: Range | Wheels, _now: RobotTime) -> bool:
        judged.append(sample)
        return False

    for name in ("on_sensed", "on_wheels"):
        monkeypatch.setattr(rig.guard._obstacles, name, judge)
    rig.hear(NEAR, "rear_right")  # the robot file knows no such sensor
    rig.hear(NEAR, age=0.6)
    rig.hear(NEAR, ranger="ranger-2")
    rig.move(0.6, base=EPOCH + 1)
    rig.move(0.6, age=0.6)
    assert judged == []
    rig.hear(NEAR, "rear")
    rig.move(0.6)
    assert [type(sample) for sample in judged] == [Range, Wheels]


def test_an_older_reading_does_not_replace_a_newer_one(rig: Rig) -> None:
    rig.look()
    rig.hear(NEAR, seq=1010)
    rig.hear(FAR, seq=1009)
    rig.hear(FAR, seq=1010)
    assert rig.passes(0.6) == (0.0, 0.0)
    assert "0.30 m" in str(rig.decide()[0].reason)


@pytest.mark.parametrize(("linear", "expected"), [(0.6, 0.15), (-0.6, 0.02), (0.0, None)])
def test_the_ranges_moment_is_the_oldest_that_the_motion_relies_on(linear: float, expected: float | None) -> None:
    rig = Rig()
    rig.look()
    rig.hear(FAR, "front_left", age=0.05)
    rig.hear(FAR, "front_right", age=0.15)
    rig.hear(FAR, "rear", age=0.02)
    rig.ask(linear, 0.1)
    assert rig.decide()[0].range_tick == (None if expected is None else rig.ago(expected))

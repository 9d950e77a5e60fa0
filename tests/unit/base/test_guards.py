"""One guard at a time: base is bound to it, and no copy, replay or double moves the robot."""

from __future__ import annotations

import msgspec
import pytest

from giraff_schemas.trouble import WELL
from tests.unit.base.rig import Rig, moving


def test_a_second_guard_while_the_first_lives_disarms_and_is_named() -> None:
    rig = Rig()
    rig.drive(0.6)
    double = msgspec.structs.replace(rig.command(), instance="guard-2", seq=10_000)
    rig.say(double)
    assert not rig.base.state().armed
    assert "guard-2" in str(rig.base.faults["guard"])
    assert "end one of the two" in str(rig.base.faults["guard"])
    assert moving(rig.run(2.0)) == []
    assert rig.base.state().guard == "guard-1"


@pytest.mark.parametrize("age", [0.201, 0.6, 8.0, -5.0])
def test_a_late_sample_of_a_guard_that_has_gone_does_nothing(age: float) -> None:
    rig = Rig()
    rig.drive(0.6)
    stray = msgspec.structs.replace(rig.command(), instance="guard-0", seq=10_000, guard_tick=rig.ago(age))
    for _ in range(20):
        rig.say(stray)
        assert rig.run(0.02)[-1].levels == (70, 70)
    assert rig.base.state().armed
    assert rig.base.faults["guard"] == WELL


@pytest.mark.parametrize("age", [0.0, 0.2])
def test_one_fresh_sample_of_a_second_guard_disarms(age: float) -> None:
    rig = Rig()
    rig.drive(0.6)
    rig.say(msgspec.structs.replace(rig.command(), instance="guard-2", guard_tick=rig.ago(age)))
    assert not rig.base.state().armed
    assert moving(rig.run(1.0)) == []


def test_nothing_arms_while_a_second_guard_is_about() -> None:
    rig = Rig()
    rig.arm()
    for _ in range(20):  # it is heard now and then only
        rig.say(msgspec.structs.replace(rig.command(), instance="guard-2"))
        rig.run(0.4)
        assert not rig.base.state().armed
    rig.arm()


def test_late_samples_do_not_keep_a_dead_guard_in_charge() -> None:
    rig = Rig()
    rig.arm()
    rig.guard_speaks = False
    backlog = [rig.command() for _ in range(100)]
    rig.run(0.6)
    rig.guard_speaks, rig.guard = True, "guard-2"
    for late in backlog:
        rig.say(late)
        rig.run(0.02)
    assert rig.base.state().guard == "guard-2"
    rig.drive(0.6)


def test_a_second_guard_is_no_longer_named_when_both_have_gone() -> None:
    rig = Rig()
    rig.arm()
    rig.say(msgspec.structs.replace(rig.command(), instance="guard-2"))
    rig.guard_speaks = False
    rig.run(0.6)
    assert rig.base.faults["guard"] == WELL
    assert "the guard is not heard" in str(rig.base.state().reason)


def test_two_guards_that_both_speak_never_drive() -> None:
    rig = Rig()
    rig.arm()
    for _ in range(100):
        rig.guard = "guard-2"
        rig.run(0.02)
        rig.guard = "guard-1"
        rig.run(0.02)
    rig.tilt(0.3)
    assert moving(rig.run(1.0)) == []


def test_a_second_guard_that_has_ended_is_no_longer_named() -> None:
    rig = Rig()
    rig.arm()
    rig.say(msgspec.structs.replace(rig.command(), instance="guard-2"))
    assert rig.base.faults["guard"]
    rig.run(0.4)
    assert rig.base.faults["guard"]
    rig.run(0.2)
    assert rig.base.faults["guard"] == WELL
    rig.drive(0.3)


def test_a_restarted_guard_is_bound_after_half_a_second_of_silence() -> None:
    rig = Rig()
    rig.arm()
    rig.run(0.02)
    last_heard = rig.robot_ns
    rig.guard = "guard-2"
    while rig.base.state().guard == "guard-1":
        rig.step()
        assert rig.robot_ns - last_heard < 1_000_000_000
    assert rig.robot_ns - last_heard == 500_000_000
    assert rig.base.faults["guard"] == WELL


def test_a_restarted_guard_is_bound_only_at_rest() -> None:
    rig = Rig()
    rig.drive(0.6)
    rig.guard_speaks = False
    rig.run(0.2)
    rig.board.speeds = [0.3, 0.3]
    rig.guard_speaks, rig.guard = True, "guard-2"
    for _ in range(100):
        rig.board.speeds = [0.3, 0.3]  # a slope, or somebody pushes
        rig.step()
    assert rig.base.state().guard == "guard-1"
    assert "at rest" in str(rig.base.state().reason)
    rig.run(2.0)
    assert rig.base.state().guard == "guard-2"
    assert moving(rig.sent[-100:]) == []
    rig.drive(0.6)


def test_a_restarted_guard_begins_its_numbers_anew() -> None:
    rig = Rig()
    rig.run(10.0)
    rig.guard_speaks = False
    rig.run(0.6)
    rig.guard_speaks, rig.guard = True, "guard-2"
    rig.drive(0.6)


def test_a_guard_that_does_not_hear_base_is_not_bound() -> None:
    rig = Rig()
    rig.arm()
    rig.guard_speaks = False
    rig.run(0.6)
    rig.guard_speaks, rig.guard, rig.guard_age = True, "guard-2", 5.0
    rig.run(1.0)
    assert rig.base.state().guard == "guard-1"
    rig.guard, rig.guard_age = "guard-3", 0.005
    rig.run(0.1)
    assert rig.base.state().guard == "guard-3"


def test_no_guard_is_bound_before_it_hears_base() -> None:
    rig = Rig()
    rig.guard_age = 5.0
    rig.run(1.0)
    assert rig.base.state().guard == ""
    assert "too old" in str(rig.base.state().reason)


@pytest.mark.parametrize("behind", [0, 1, 5, 50])
def test_a_replayed_command_counts_for_nothing(behind: int) -> None:
    rig = Rig()
    rig.drive(0.6)
    rig.tilt(0.0)
    rig.run(0.1)
    now = rig.command()
    rig.say(now)
    replay = msgspec.structs.replace(now, seq=now.seq - behind, linear_x=0.6, hand_neutral=False)
    for _ in range(5):
        rig.say(replay)
        rig.guard_speaks = False
        assert moving(rig.run(0.01)) == []


def test_a_late_copy_does_not_stop_the_robot() -> None:
    rig = Rig()
    rig.drive(0.6)
    late = msgspec.structs.replace(rig.command(), seq=0, linear_x=0.0)
    for _ in range(20):
        rig.say(late)
        assert rig.run(0.02)[-1].levels == (70, 70)


def test_commands_that_overtake_each_other_count_in_their_order() -> None:
    rig = Rig()
    rig.drive(0.6)
    older, newer = rig.command(), rig.command()
    rig.say(msgspec.structs.replace(newer, linear_x=0.3))
    rig.say(msgspec.structs.replace(older, linear_x=0.6))
    rig.guard_speaks = False
    assert rig.run(0.01)[-1].levels == (35, 35)


def test_a_replay_of_the_whole_past_does_not_arm() -> None:
    rig = Rig()
    past = []
    for _ in range(50):
        rig.run(0.02)
        past.append(rig.command())
    rig.base.on_link_opened(session=100)
    rig.guard_speaks = False
    for command in past:
        rig.say(command)
    assert not rig.base.state().armed

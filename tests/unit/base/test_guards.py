"""One guard at a time: base is bound to it, and no copy, replay or double moves the robot."""

import msgspec
import pytest

from giraff_schemas.trouble import NO_TROUBLE
from tests.unit.base.rig import Rig, moving


def test_a_second_guard_while_the_first_lives_disarms_and_is_named(driven: Rig) -> None:
    double = msgspec.structs.replace(driven.command(), instance="guard-2", seq=10_000)
    driven.say(double)
    assert not driven.base.state().armed
    assert "guard-2" in str(driven.base.faults["guard"])
    assert "end one of the two" in str(driven.base.faults["guard"])
    assert moving(driven.run(2.0)) == []
    assert driven.base.state().guard == "guard-1"


@pytest.mark.parametrize("age", [0.201, 0.6, 8.0, -5.0])
def test_a_late_sample_of_a_guard_that_has_gone_does_nothing(driven: Rig, age: float) -> None:
    stray = msgspec.structs.replace(driven.command(), instance="guard-0", seq=10_000, guard_tick=driven.ago(age))
    for _ in range(20):
        driven.say(stray)
        assert driven.run(0.02)[-1].levels == (70, 70)
    assert driven.base.state().armed
    assert driven.base.faults["guard"] == NO_TROUBLE


@pytest.mark.parametrize("age", [0.0, 0.2])
def test_one_fresh_sample_of_a_second_guard_disarms(driven: Rig, age: float) -> None:
    driven.say(msgspec.structs.replace(driven.command(), instance="guard-2", guard_tick=driven.ago(age)))
    assert not driven.base.state().armed
    assert moving(driven.run(1.0)) == []


def test_nothing_arms_while_a_second_guard_is_about(armed: Rig) -> None:
    for _ in range(20):  # it is heard now and then only
        armed.say(msgspec.structs.replace(armed.command(), instance="guard-2"))
        armed.run(0.4)
        assert not armed.base.state().armed
    armed.arm()


def test_late_samples_do_not_keep_a_dead_guard_in_charge(armed: Rig) -> None:
    armed.guard_speaks = False
    backlog = [armed.command() for _ in range(100)]
    armed.run(0.6)
    armed.guard_speaks, armed.guard = True, "guard-2"
    for late in backlog:
        armed.say(late)
        armed.run(0.02)
    assert armed.base.state().guard == "guard-2"
    armed.drive(0.6)


def test_a_second_guard_is_no_longer_named_when_both_have_gone(armed: Rig) -> None:
    armed.say(msgspec.structs.replace(armed.command(), instance="guard-2"))
    armed.guard_speaks = False
    armed.run(0.6)
    assert armed.base.faults["guard"] == NO_TROUBLE
    assert "the guard is not heard" in str(armed.base.state().reason)


def test_two_guards_that_both_speak_never_drive(armed: Rig) -> None:
    for _ in range(100):
        armed.guard = "guard-2"
        armed.run(0.02)
        armed.guard = "guard-1"
        armed.run(0.02)
    armed.tilt(0.3)
    assert moving(armed.run(1.0)) == []


def test_a_second_guard_that_has_ended_is_no_longer_named(armed: Rig) -> None:
    armed.say(msgspec.structs.replace(armed.command(), instance="guard-2"))
    assert armed.base.faults["guard"]
    armed.run(0.4)
    assert armed.base.faults["guard"]
    armed.run(0.2)
    assert armed.base.faults["guard"] == NO_TROUBLE
    armed.drive(0.3)


def test_a_restarted_guard_is_bound_after_half_a_second_of_silence(armed: Rig) -> None:
    armed.run(0.02)
    last_heard = armed.robot_ns
    armed.guard = "guard-2"
    while armed.base.state().guard == "guard-1":
        armed.step()
        assert armed.robot_ns - last_heard < 1_000_000_000
    assert armed.robot_ns - last_heard == 500_000_000
    assert armed.base.faults["guard"] == NO_TROUBLE


def test_a_restarted_guard_is_bound_only_at_rest(driven: Rig) -> None:
    driven.guard_speaks = False
    driven.run(0.2)
    driven.board.speeds = [0.3, 0.3]
    driven.guard_speaks, driven.guard = True, "guard-2"
    for _ in range(100):
        driven.board.speeds = [0.3, 0.3]  # a slope, or somebody pushes
        driven.step()
    assert driven.base.state().guard == "guard-1"
    assert "at rest" in str(driven.base.state().reason)
    driven.run(2.0)
    assert driven.base.state().guard == "guard-2"
    assert moving(driven.sent[-100:]) == []
    driven.drive(0.6)


def test_a_restarted_guard_begins_its_numbers_anew(rig: Rig) -> None:
    rig.run(10.0)
    rig.guard_speaks = False
    rig.run(0.6)
    rig.guard_speaks, rig.guard = True, "guard-2"
    rig.drive(0.6)


def test_a_guard_that_does_not_hear_base_is_not_bound(armed: Rig) -> None:
    armed.guard_speaks = False
    armed.run(0.6)
    armed.guard_speaks, armed.guard, armed.guard_age = True, "guard-2", 5.0
    armed.run(1.0)
    assert armed.base.state().guard == "guard-1"
    armed.guard, armed.guard_age = "guard-3", 0.005
    armed.run(0.1)
    assert armed.base.state().guard == "guard-3"


def test_no_guard_is_bound_before_it_hears_base(rig: Rig) -> None:
    rig.guard_age = 5.0
    rig.run(1.0)
    assert rig.base.state().guard == ""
    assert "too old" in str(rig.base.state().reason)


@pytest.mark.parametrize("behind", [0, 1, 5, 50])
def test_a_replayed_command_counts_for_nothing(driven: Rig, behind: int) -> None:
    driven.tilt(0.0)
    driven.run(0.1)
    now = driven.command()
    driven.say(now)
    replay = msgspec.structs.replace(now, seq=now.seq - behind, linear_x=0.6, hand_neutral=False)
    for _ in range(5):
        driven.say(replay)
        driven.guard_speaks = False
        assert moving(driven.run(0.01)) == []


def test_a_late_copy_does_not_stop_the_robot(driven: Rig) -> None:
    late = msgspec.structs.replace(driven.command(), seq=0, linear_x=0.0)
    for _ in range(20):
        driven.say(late)
        assert driven.run(0.02)[-1].levels == (70, 70)


def test_commands_that_overtake_each_other_count_in_their_order(driven: Rig) -> None:
    older, newer = driven.command(), driven.command()
    driven.say(msgspec.structs.replace(newer, linear_x=0.3))
    driven.say(msgspec.structs.replace(older, linear_x=0.6))
    driven.guard_speaks = False
    assert driven.run(0.01)[-1].levels == (35, 35)


def test_a_replay_of_the_whole_past_does_not_arm(rig: Rig) -> None:
    past = []
    for _ in range(50):
        rig.run(0.02)
        past.append(rig.command())
    rig.base.on_link_opened(session=100)
    rig.guard_speaks = False
    for command in past:
        rig.say(command)
    assert not rig.base.state().armed

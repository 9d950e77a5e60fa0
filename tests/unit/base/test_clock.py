"""The robot's clock: after a suspend everything is old, and one that goes back makes nothing old look new."""

import pytest

from tests.unit.base.rig import Rig, moving

NS = 1_000_000_000


@pytest.mark.parametrize("seconds", [1.5, 60.0, 30_000.0])
def test_a_machine_that_was_suspended_must_be_armed_again(driven: Rig, seconds: float) -> None:
    queued = [driven.command() for _ in range(5)]
    driven.robot_ns += round(seconds * NS)
    for command in queued:  # what waited in the network is handed over now
        driven.say(command)
    assert moving(driven.run(2.0)) == []
    assert "stale" in str(driven.base.state().reason)
    driven.drive(0.6)


@pytest.mark.parametrize("seconds", [0.001, 0.05, 0.5, 3.0])
def test_a_clock_that_goes_back_stops_the_robot_until_it_is_well_past_all_it_has_shown(seconds: float) -> None:
    rig = Rig()
    sent = rig.drive(0.6)
    latest = rig.robot_ns
    rig.robot_ns -= round(seconds * NS) + 10_000_000
    rig.tilt(0.0)
    while rig.robot_ns < latest + NS - 10_000_000:
        sent = rig.run(0.01)
        assert moving(sent) == []
        assert not rig.base.state().armed
    assert str(sent[-1].state.reason) == "the robot's clock went back; restart giraff_base"
    rig.drive(0.6)


def test_commands_from_before_the_clock_went_back_are_not_fresh_a_second_time(armed: Rig) -> None:
    armed.guard_speaks = False
    recorded = []
    for n in range(150):
        armed.tilt(0.0 if n < 50 else 0.6)  # a hand that arms, and then drives
        armed.step()
        recorded.append((armed.robot_ns, armed.command()))
    armed.base.on_link_opened(session=100)
    armed.robot_ns = recorded[0][0] - NS
    before = len(armed.sent)
    for moment, command in recorded:
        while armed.robot_ns < moment:
            armed.step()
        armed.say(command)
    assert len(armed.sent) - before > 200
    assert moving(armed.sent[before:]) == []
    assert not armed.base.state().armed


def test_a_clock_that_goes_back_while_the_robot_stands_lets_nothing_arm(rig: Rig) -> None:
    rig.run(0.1)
    rig.robot_ns -= 10 * NS
    rig.run(5.0)
    assert not rig.base.state().armed
    assert "clock went back" in str(rig.base.state().reason)


def test_a_clock_that_goes_back_twice_is_held_against_all_it_has_ever_shown(driven: Rig) -> None:
    latest = driven.robot_ns
    driven.tilt(0.0)
    for back in (20 * NS, NS // 2):
        driven.robot_ns -= back
        driven.run(1.0)
    while driven.robot_ns < latest + NS - 10_000_000:
        assert moving(driven.run(0.1)) == []
        assert not driven.base.state().armed
    driven.drive(0.6)

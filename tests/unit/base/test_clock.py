"""The robot's clock: after a suspend everything is old, and one that goes back makes nothing old look new."""

from __future__ import annotations

import pytest

from tests.unit.base.rig import Rig, moving

NS = 1_000_000_000


@pytest.mark.parametrize("seconds", [1.5, 60.0, 30_000.0])
def test_a_machine_that_was_suspended_must_be_armed_again(seconds: float) -> None:
    rig = Rig()
    rig.drive(0.6)
    queued = [rig.command() for _ in range(5)]
    rig.robot_ns += round(seconds * NS)
    for command in queued:  # what waited in the network is handed over now
        rig.say(command)
    assert moving(rig.run(2.0)) == []
    assert "stale" in str(rig.base.state().reason)
    rig.drive(0.6)


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


def test_commands_from_before_the_clock_went_back_are_not_fresh_a_second_time() -> None:
    rig = Rig()
    rig.arm()
    rig.guard_speaks = False
    recorded = []
    for n in range(150):
        rig.tilt(0.0 if n < 50 else 0.6)  # a hand that arms, and then drives
        rig.step()
        recorded.append((rig.robot_ns, rig.command()))
    rig.base.on_link_opened(session=100)
    rig.robot_ns = recorded[0][0] - NS
    before = len(rig.sent)
    for moment, command in recorded:
        while rig.robot_ns < moment:
            rig.step()
        rig.say(command)
    assert len(rig.sent) - before > 200
    assert moving(rig.sent[before:]) == []
    assert not rig.base.state().armed


def test_a_clock_that_goes_back_while_the_robot_stands_lets_nothing_arm() -> None:
    rig = Rig()
    rig.run(0.1)
    rig.robot_ns -= 10 * NS
    rig.run(5.0)
    assert not rig.base.state().armed
    assert "clock went back" in str(rig.base.state().reason)


def test_a_clock_that_goes_back_twice_is_held_against_all_it_has_ever_shown() -> None:
    rig = Rig()
    rig.drive(0.6)
    latest = rig.robot_ns
    rig.tilt(0.0)
    for back in (20 * NS, NS // 2):
        rig.robot_ns -= back
        rig.run(1.0)
    while rig.robot_ns < latest + NS - 10_000_000:
        assert moving(rig.run(0.1)) == []
        assert not rig.base.state().armed
    rig.drive(0.6)

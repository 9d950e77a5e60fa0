"""Only the holder of the lease arms and drives, and only a hand that is held neutral without a gap arms."""

import random

import msgspec
import pytest

from giraff_schemas.messages import RobotTime
from tests.unit.base.rig import EPOCH, Rig, moving


def test_another_lease_of_the_same_operator_disarms(driven: Rig) -> None:
    driven.lease_counter = 6
    assert moving(driven.run(2.0)[2:]) == []
    assert str(driven.base.state().reason).startswith("not armed since a new lease")
    driven.drive(0.6)


def test_a_lease_that_was_away_for_a_moment_disarms(driven: Rig) -> None:
    driven.lease_counter = 0
    driven.run(0.02)
    driven.lease_counter = 5
    assert moving(driven.run(2.0)[2:]) == []


def test_nobodys_command_never_arms_and_never_drives(rig: Rig) -> None:
    rig.lease_counter = 0
    rig.run(2.0)
    assert not rig.base.state().armed
    assert "lease" in str(rig.base.state().reason)
    rig.tilt(0.6)
    assert moving(rig.run(2.0)) == []


def test_nobodys_command_stops_a_robot_that_drives_and_the_guard_says_why(driven: Rig) -> None:
    driven.lease_counter, driven.reason = 0, "nobody drives the robot; tilt to ask"
    assert not driven.run(0.03)[-1].moves
    assert str(driven.base.state().reason) == str(driven.reason)


def hold(rig: Rig, moments_ms: list[float]) -> bool:
    """Whether a hand that is neutral at these moments arms, heard as it happens."""
    rig.guard_speaks = False
    start = rig.robot_ns
    for moment in moments_ms:
        rig.robot_ns = start + round(moment * 1e6)
        rig.say(msgspec.structs.replace(rig.command(), operator_tick=RobotTime(EPOCH, rig.robot_ns)))
    return rig.base.state().armed


@pytest.mark.parametrize(
    ("moments_ms", "arms"),
    [
        ([0, 100, 200], True),
        ([0, 100, 199.999], False),
        ([0, 200], False),
        ([0, 100.001, 200.001], False),
        ([0, 100, 201, 250], False),
        ([0, 33, 66, 100, 133, 166, 200], True),
        ([0, 150, 250, 350], True),
        ([0, 150, 250, 300], False),
    ],
)
def test_neutral_is_held_only_without_a_gap_of_over_0_1_s(moments_ms: list[float], arms: bool) -> None:
    assert hold(Rig(), moments_ms) == arms


def test_moments_in_the_wrong_order_are_not_a_held_hand() -> None:
    assert not hold(Rig(), [300, 200, 100, 0])
    rig = Rig()
    for _ in range(20):
        assert not hold(rig, [0, 90, 20])


@pytest.mark.parametrize("loss", [0.0, 0.02, 0.1])
def test_a_held_hand_arms_over_a_bad_network(loss: float) -> None:
    # 30 commands a second, each with the newest of 50 measurements and 50 ticks a second, and the guard at 50 Hz.
    chance = random.Random(1)
    times = []
    for _ in range(200):
        rig = Rig()
        rig.guard_speaks = False
        began, operator = rig.robot_ns, rig.now
        phase = chance.randrange(0, 33_000_000)
        while not rig.base.state().armed:
            rig.robot_ns += 1_000_000
            elapsed = rig.robot_ns - began
            if (elapsed + phase) % 33_000_000 < 1_000_000 and chance.random() >= loss:
                measured = (rig.robot_ns - 5_000_000) // 20_000_000 * 20_000_000
                operator = RobotTime(EPOCH, (measured - 5_000_000) // 20_000_000 * 20_000_000)
            if elapsed % 20_000_000 == 0:
                rig.say(msgspec.structs.replace(rig.command(), operator_tick=operator))
            assert elapsed < 3_000_000_000
        times.append((rig.robot_ns - began) / 1e9)
    times.sort()
    assert times[190] <= 0.5, times[-10:]
    assert times[-1] <= (0.5 if loss == 0.0 else 1.0)

"""What is tightened while the robot drives counts at once, in each part that judges by it."""

import msgspec
import pytest

from tests.support.robots import DRIVE
from tests.unit.base.rig import CONFIG, Rig


def tightened(rig: Rig, **changes: float) -> None:
    rig.live.replace(msgspec.structs.replace(CONFIG, **changes))


def test_a_hand_must_be_held_level_for_the_new_time(rig: Rig) -> None:
    tightened(rig, arm_time=1.0)
    rig.operator_age = 0.0
    rig.run(0.02)
    first_neutral = rig.robot_ns
    assert "for 1 s" in str(rig.base.state().reason)
    while not rig.base.state().armed:
        rig.step()
    assert rig.robot_ns - first_neutral == 1_000_000_000


def test_a_hand_that_held_level_for_the_old_time_only_does_not_arm(rig: Rig) -> None:
    rig.run(0.15)
    tightened(rig, arm_time=1.0)
    rig.run(0.5)
    assert not rig.base.state().armed


def test_an_operators_command_older_than_the_new_budget_does_not_drive(driven: Rig) -> None:
    driven.operator_age = 0.15
    assert driven.run(0.5)[-1].moves
    tightened(driven, operator_budget=0.1)
    assert not driven.run(0.05)[-1].moves


def test_a_guards_command_older_than_the_new_budget_is_not_admitted(driven: Rig) -> None:
    tightened(driven, guard_budget=0.05)
    driven.guard_age = 0.06
    driven.run(0.1)
    sent = driven.run(0.1)
    assert not any(each.moves for each in sent)
    assert "guard's command is too old" in str(sent[-1].state.reason)


def test_a_battery_below_the_new_limits_slows_and_stops(driven: Rig) -> None:
    volts = driven.board.battery_adc_counts * DRIVE.battery_volts_per_count
    tightened(driven, battery_low=volts + 1.0)
    assert driven.run(6.0)[-1].levels == (35, 35)
    tightened(driven, battery_low=volts + 1.0, battery_cutoff=volts + 0.5)
    assert not driven.run(6.0)[-1].moves


@pytest.mark.parametrize(("linear", "angular"), [(0.6, 0.0), (0.0, 1.5)])
def test_a_start_keeps_to_the_new_acceleration(armed: Rig, linear: float, angular: float) -> None:
    tightened(armed, linear_acceleration=0.06, angular_acceleration=0.15)
    armed.tilt(linear, angular)
    sent = armed.run(1.0)
    assert sent[-1].moves
    assert abs(sent[-1].levels[1]) <= 8

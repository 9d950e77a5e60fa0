"""Reports of the base board as samples, and whether its wheels stand still."""

from __future__ import annotations

import msgspec
import pytest

from giraff_base.drives.wheels.reports import WheelReports
from giraff_schemas.messages import RobotTime
from giraff_schemas.wire import WheelsFrame

TICK = RobotTime(epoch=7, robot_ns=5)
STILL = WheelsFrame(
    seq=0,
    board_us=123_000,
    board_ms=123,
    boot_id=4,
    session=9,
    left_ticks=-5,
    right_ticks=6,
    left_pwm_counts=0,
    right_pwm_counts=0,
    drive_state=0,
    latch=0,
    last_refusal=0,
    accepted=0,
    refused=0,
    line_errors=0,
    battery_adc_counts=0,
    left_um_s=0,
    right_um_s=0,
    speed_flags=0,
)


def test_a_sample_is_the_report() -> None:
    report = msgspec.structs.replace(STILL, left_pwm_counts=35, right_pwm_counts=-36)
    sample = WheelReports().take(report, TICK)
    assert (sample.left_ticks, sample.right_ticks) == (-5, 6)
    assert (sample.left_pwm_counts, sample.right_pwm_counts) == (35, -36)
    assert (sample.board_us, sample.boot_id, sample.tick) == (123_000, 4, TICK)


def test_the_boards_speeds_are_told_in_metres_a_second() -> None:
    sample = WheelReports().take(msgspec.structs.replace(STILL, left_um_s=600_000, right_um_s=-1), TICK)
    assert sample.left_velocity == pytest.approx(0.6)
    assert sample.right_velocity == pytest.approx(-1e-6)


def test_at_rest_is_no_speed_and_no_power() -> None:
    reports = WheelReports()
    assert reports.at_rest
    reports.take(STILL, TICK)
    assert reports.at_rest


@pytest.mark.parametrize("field", ["left_pwm_counts", "right_pwm_counts", "left_um_s", "right_um_s"])
@pytest.mark.parametrize("value", [1, -1])
def test_a_wheel_that_turns_or_has_power_is_not_at_rest(field: str, value: int) -> None:
    reports = WheelReports()
    reports.take(STILL, TICK)
    reports.take(msgspec.structs.replace(STILL, **{field: value}), TICK)
    assert not reports.at_rest
    reports.take(STILL, TICK)
    assert reports.at_rest


def test_after_forgetting_nothing_is_known() -> None:
    reports = WheelReports()
    reports.take(msgspec.structs.replace(STILL, left_um_s=5), TICK)
    reports.forget()
    assert reports.at_rest

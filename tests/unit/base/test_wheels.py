"""Reports of the base board as samples: speeds from the board's own time, across each of its wraps."""

from __future__ import annotations

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_base.wheels import WheelReports
from giraff_schemas.messages import RobotTime, Wheels
from giraff_schemas.wire import WheelsFrame
from tests.unit.base.rig import ROBOT

TICK = RobotTime(epoch=7, robot_ns=5)
WRAP = 1 << 32


def signed32(count: int) -> int:
    return (count + (WRAP >> 1)) % WRAP - (WRAP >> 1)


def report(board_us: int, left: int, right: int, boot_id: int = 1, session: int = 9, pwm: int = 0) -> WheelsFrame:
    return WheelsFrame(
        seq=0,
        board_us=board_us % WRAP,
        board_ms=board_us // 1000 % WRAP,
        boot_id=boot_id,
        session=session,
        left_ticks=signed32(left),
        right_ticks=signed32(right),
        left_pwm_counts=pwm,
        right_pwm_counts=-pwm,
        drive_state=0,
        latch=0,
        last_refusal=0,
        accepted=0,
        refused=0,
        line_errors=0,
        battery_adc_counts=0,
    )


def travel(
    reports: WheelReports, periods: int, left: int, right: int, start_us: int = 0, start_ticks: int = 0
) -> Wheels:
    """Reports each 10 ms in which the wheels make `left` and `right` ticks; the sample of the last one."""
    sample = reports.take(report(start_us, start_ticks, start_ticks), TICK)
    for n in range(1, periods + 1):
        sample = reports.take(report(start_us + n * 10_000, start_ticks + n * left, start_ticks + n * right), TICK)
    return sample


def test_a_sample_is_the_report() -> None:
    sample = WheelReports(ROBOT).take(report(123_000, -5, 6, boot_id=4, pwm=35), TICK)
    assert (sample.left_ticks, sample.right_ticks) == (-5, 6)
    assert (sample.left_pwm_counts, sample.right_pwm_counts) == (35, -35)
    assert (sample.board_us, sample.boot_id, sample.tick) == (123_000, 4, TICK)


def test_speed_is_ticks_by_the_boards_own_time() -> None:
    sample = travel(WheelReports(ROBOT), 20, left=12, right=-6)
    assert sample.left_velocity == pytest.approx(0.6)  # 12 ticks of 0.5 mm in 10 ms
    assert sample.right_velocity == pytest.approx(-0.3)


def test_speed_is_over_50_ms_so_that_one_tick_is_one_centimetre_a_second() -> None:
    reports = WheelReports(ROBOT)
    travel(reports, 20, left=0, right=0)
    reports.take(report(210_000, 1, 0), TICK)
    assert reports.left_velocity == pytest.approx(0.01)
    for n in range(1, 5):
        reports.take(report(210_000 + n * 10_000, 1, 0), TICK)
        assert reports.left_velocity == pytest.approx(0.01)
    reports.take(report(260_000, 1, 0), TICK)
    assert reports.left_velocity == 0.0


@given(start_us=st.integers(0, WRAP - 1), start_ticks=st.integers(0, WRAP - 1), ticks=st.integers(-200, 200))
def test_no_wrap_of_a_counter_shows(start_us: int, start_ticks: int, ticks: int) -> None:
    sample = travel(WheelReports(ROBOT), 10, ticks, -ticks, start_us, start_ticks)
    assert sample.left_velocity == pytest.approx(ticks * 0.05)
    assert sample.right_velocity == pytest.approx(-ticks * 0.05)


@pytest.mark.parametrize(
    ("start_us", "start_ticks"), [(WRAP - 105_000, 0), (0, (WRAP >> 1) - 90), (0, -(WRAP >> 1) + 90), (0, 90), (0, -90)]
)
@pytest.mark.parametrize("ticks", [12, -12])
def test_each_wrap_by_name(start_us: int, start_ticks: int, ticks: int) -> None:
    reports = WheelReports(ROBOT)
    sample = travel(reports, 10, ticks, ticks, start_us, start_ticks)
    assert sample.left_velocity == pytest.approx(ticks * 0.05)
    # Standing from there on: a speed that was not made anew would show.
    for n in range(11, 14):
        reports.take(report(start_us + n * 10_000, start_ticks + 10 * ticks, start_ticks + 10 * ticks), TICK)
    assert reports.left_velocity == pytest.approx(ticks * 0.05 * 2 / 5)


def test_another_boot_is_no_jump() -> None:
    reports = WheelReports(ROBOT)
    travel(reports, 10, 12, 12)
    sample = reports.take(report(110_000, 0, 0, boot_id=2), TICK)
    assert (sample.left_velocity, sample.right_velocity) == (0.0, 0.0)
    sample = reports.take(report(120_000, 12, 12, boot_id=2), TICK)
    assert sample.left_velocity == pytest.approx(0.6)


def test_another_session_is_another_wiring_and_no_jump() -> None:
    reports = WheelReports(ROBOT)
    travel(reports, 10, 12, 12)
    assert reports.take(report(110_000, -120, -120, session=10), TICK).left_velocity == 0.0


@pytest.mark.parametrize("gap_us", [200_001, 5_000_000, -10_000])
def test_a_gap_is_no_speed(gap_us: int) -> None:
    reports = WheelReports(ROBOT)
    travel(reports, 10, 12, 12, start_us=1_000_000)
    assert reports.take(report(1_100_000 + gap_us, 5000, 5000), TICK).left_velocity == 0.0


def test_a_few_lost_reports_are_no_gap() -> None:
    reports = WheelReports(ROBOT)
    travel(reports, 10, 12, 12)
    assert reports.take(report(300_000, 360, 360), TICK).left_velocity == pytest.approx(0.6)


def test_at_rest_is_no_movement_in_50_ms_and_no_power() -> None:
    reports = WheelReports(ROBOT)
    assert reports.at_rest
    travel(reports, 10, 0, 0)
    assert reports.at_rest
    reports.take(report(110_000, 0, 0, pwm=5), TICK)
    assert not reports.at_rest


@pytest.mark.parametrize(("left", "right"), [(12, 12), (-12, 12), (0, 1), (-1, 0)])
def test_a_wheel_that_turns_is_not_at_rest(left: int, right: int) -> None:
    reports = WheelReports(ROBOT)
    travel(reports, 10, left, right)
    assert not reports.at_rest


def test_after_forgetting_nothing_is_known() -> None:
    reports = WheelReports(ROBOT)
    travel(reports, 10, 12, 12)
    reports.forget()
    assert (reports.left_velocity, reports.right_velocity) == (0.0, 0.0)
    assert reports.at_rest


@pytest.mark.parametrize("powered", ["left_pwm_counts", "right_pwm_counts"])
def test_a_robot_with_power_on_one_wheel_is_not_at_rest(powered: str) -> None:
    reports = WheelReports(ROBOT)
    for n in range(10):
        still = report(n * 10_000, 0, 0)
        reports.take(msgspec.structs.replace(still, **{powered: 20}), TICK)
    assert not reports.at_rest

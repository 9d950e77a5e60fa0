"""Reports of the base board as samples, and whether its wheels stand still."""

from __future__ import annotations

from collections.abc import Iterable

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


class Reported:
    """Reports of a board, 10 ms apart."""

    def __init__(self) -> None:
        self.reports, self._board_us = WheelReports(), STILL.board_us

    def rests(self, ways: Iterable[tuple[int, int]], *, pwm: tuple[int, int] = (0, 0)) -> list[bool]:
        """Take a report for each pair of counters. Return whether the robot rested at each."""
        found = []
        for left, right in ways:
            self._board_us += 10_000
            seen: dict[str, int] = {"left_ticks": left, "right_ticks": right, "board_us": self._board_us}
            seen |= {"left_pwm_counts": pwm[0], "right_pwm_counts": pwm[1]}
            self.reports.take(msgspec.structs.replace(STILL, **seen), TICK)
            found.append(self.reports.at_rest)
        return found


def test_it_rests_once_the_wheels_have_stood_for_a_fifth_of_a_second() -> None:
    board = Reported()
    assert board.reports.at_rest, "before any report"
    assert board.rests([(0, 0)] * 22) == [False] * 20 + [True] * 2


@pytest.mark.parametrize(("way", "pwm"), [((2, 0), (0, 0)), ((0, -2), (0, 0)), ((0, 0), (1, 0)), ((0, 0), (0, -1))])
def test_a_wheel_that_turns_or_has_power_is_not_at_rest(way: tuple[int, int], pwm: tuple[int, int]) -> None:
    board = Reported()
    assert board.rests([(0, 0)] * 22)[-1]
    assert board.rests([way], pwm=pwm) == [False]
    assert board.rests([way] * 22)[-1]


@pytest.mark.parametrize("away", [(1, 0), (0, 1), (-1, 1)])
def test_an_encoder_that_flickers_on_the_edge_of_a_count_rests(away: tuple[int, int]) -> None:
    """An edge each 20 ms, to and fro, after the wheels have rolled."""
    rolled = [(10 * step, 10 * step) for step in range(-50, 1)]
    flicker = [(0, 0) if period // 2 % 2 else away for period in range(200)]
    assert all(Reported().rests(rolled + flicker)[len(rolled) + 25 :])


def test_a_wheel_that_creeps_rests_no_longer_than_its_board_calls_it_still() -> None:
    """A count each 0.3 s: it rests for 0.1 s of them. The board tells no speed of it for 0.2 s of them."""
    rests = Reported().rests((period // 30, 0) for period in range(3060))
    assert sum(rests[60:]) == 1000
    assert not any(Reported().rests((0, period // 20) for period in range(3000))[60:])


def test_after_forgetting_nothing_is_known() -> None:
    board = Reported()
    assert not board.rests([(0, 0)])[0]
    board.reports.forget()
    assert board.reports.at_rest

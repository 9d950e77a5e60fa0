"""Reports of the base board as samples, and whether its wheels stand still."""

from collections.abc import Iterable, Iterator
from itertools import pairwise

import msgspec
import pytest

from giraff_base.drives.wheels.reports import WheelReports
from giraff_schemas.messages import RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_schemas.wire import WheelsFrame

TICKS_PER_METRE = 2000.0
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
    sample = WheelReports(TICKS_PER_METRE).on_report(report, TICK)
    assert (sample.left_ticks, sample.right_ticks) == (-5, 6)
    assert (sample.left_pwm_counts, sample.right_pwm_counts) == (35, -36)
    assert (sample.board_us, sample.boot_id, sample.tick) == (123_000, 4, TICK)


def test_the_boards_speeds_are_told_in_metres_a_second() -> None:
    sample = WheelReports(TICKS_PER_METRE).on_report(
        msgspec.structs.replace(STILL, left_um_s=600_000, right_um_s=-1), TICK
    )
    assert sample.left_velocity == pytest.approx(0.6)
    assert sample.right_velocity == pytest.approx(-1e-6)


class Reported:
    """Reports of a board, 10 ms apart."""

    def __init__(self) -> None:
        self.reports, self._board_us = WheelReports(TICKS_PER_METRE), STILL.board_us

    def rests(self, ways: Iterable[tuple[int, int]], *, pwm: tuple[int, int] = (0, 0)) -> list[bool]:
        """Take a report for each pair of counters. Return whether the robot rested at each."""
        return [rests for rests, _ in self.take(ways, pwm)]

    def take(self, ways: Iterable[tuple[int, int]], pwm: tuple[int, int] = (0, 0)) -> Iterator[tuple[bool, Trouble]]:
        """Return whether the robot rested at each report, and the notice."""
        for left, right in ways:
            self._board_us += 10_000
            seen: dict[str, int] = {"left_ticks": left, "right_ticks": right, "board_us": self._board_us}
            seen |= {"left_pwm_counts": pwm[0], "right_pwm_counts": pwm[1]}
            tick = RobotTime(epoch=7, robot_ns=self._board_us * 1000)
            self.reports.on_report(msgspec.structs.replace(STILL, **seen), tick)
            yield self.reports.at_rest, self.reports.warning


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


def test_wheels_that_roll_without_power_are_a_notice_that_does_not_flap() -> None:
    """As on a slope of 8 degrees, 0.69 m in 6 s. It stands for 5 s, rolls on, and stands for good."""
    roll = [(at := round(1380 * (period / 600) ** 2), at) for period in range(600)]
    end = roll[-1][0]
    ways = [*roll, *[(end, end)] * 500, *((end + left, end + left) for left, _ in roll), *[(2 * end, 2 * end)] * 1500]
    notices = [notice.what for _, notice in Reported().take(ways)]
    changes = [at for at, (one, other) in enumerate(pairwise(notices)) if one != other]
    assert (notices[0], notices[-1], len(changes)) == ("", "", 2)
    assert changes[0] < 300
    assert "the wheels turn without power" in notices[300]


def test_wheels_that_are_driven_coast_or_flicker_are_none() -> None:
    board = Reported()
    driven = [(10 * period, -10 * period) for period in range(300)]
    coasts = [(3000 + 5 * period, -3000 - 5 * period) for period in range(100)]
    flickers = [(3500 + period // 2 % 2, -3500) for period in range(1000)]
    notices = {
        notice
        for ways, pwm in ((driven, (35, -35)), (coasts + flickers, (0, 0)))
        for _, notice in board.take(ways, pwm)
    }
    assert notices == {NO_TROUBLE}

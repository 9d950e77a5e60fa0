"""A wheel that something holds while the board asks for its speed: PWM 0, and soon a latch."""

import math
import random
from collections.abc import Callable

import pytest

from giraff_schemas.wire import (
    HELD_FALLEN_MS,
    HELD_REACH_MS,
    HELD_TIMES,
    HELD_WITHIN_MS,
    OVERDUE_INTERVALS,
    OVERDUE_MS,
    SILENT_MS,
    STUCK_MS,
    DriveState,
    Latch,
    Refusal,
    SpeedFlag,
)
from tests.firmware.bench import ACCELERATION, SpeedBench
from tests.support.robots import BY_SPEED, ROBOT

TELEMETRY_MS = 17
PERIOD_MS = 10
METER_MS = 50  # until the speedometer tells of a new speed
CONTROL = BY_SPEED.speed_control
LATCH_AT, LATCHED = 4, 0xA0  # in EEPROM, as latch.c has them
BOTH = ("left", "right")


def held_ms(robot: SpeedBench, left: float, right: float, longest: int = 2000) -> int:
    """For how long the motors get something, while these speeds are asked for."""
    for millisecond in range(longest):
        if millisecond % 20 == 0:
            robot.send(robot.speed_frame(left, right))
        robot.run(1)
        if millisecond > 30 and robot.duties() == (0, 0):
            robot.run(TELEMETRY_MS)
            return millisecond
    return longest


def hold(robot: SpeedBench, wheel: str, speed: Callable[[int], float] | None = lambda _ms: 0.0) -> None:
    robot.hands[BOTH.index(wheel)] = speed


def flag(wheel: str, what: str) -> SpeedFlag:
    return SpeedFlag[f"{wheel.upper()}_{what}"]


def open_again(robot: SpeedBench) -> None:
    robot.hands = [None, None]
    robot.run(20)
    robot.go(0.0, 0.0, 100)
    assert robot.wheels().drive_state == DriveState.ACTIVE


@pytest.mark.parametrize("asked", [0.1, -0.1, 0.3, -0.5])
@pytest.mark.parametrize("wheel", BOTH)
def test_a_wheel_that_stops_is_held_at_once(robot: SpeedBench, wheel: str, asked: float) -> None:
    robot.begin(asked, asked)
    hold(robot, wheel)
    assert held_ms(robot, asked, asked) <= HELD_FALLEN_MS + METER_MS
    told = robot.wheels()
    assert (told.drive_state, told.latch) == (DriveState.HELD, Latch.NONE)
    assert told.speed_flags & flag(wheel, "HELD")
    other = BOTH[1 - BOTH.index(wheel)]
    assert not told.speed_flags & flag(other, "HELD")


@pytest.mark.parametrize("asked", [0.15, -0.4])
@pytest.mark.parametrize("share", [0.45, 0.55])
def test_a_wheel_that_falls_below_half_of_the_speed_it_had_is_held(
    robot: SpeedBench, asked: float, share: float
) -> None:
    robot.begin(asked, asked)
    hold(robot, "right", lambda _ms: share * asked)
    if share < 0.5:
        assert held_ms(robot, asked, asked) <= HELD_FALLEN_MS + METER_MS
        assert robot.wheels().speed_flags & SpeedFlag.RIGHT_HELD
    else:
        assert held_ms(robot, asked, asked, 3000) == 3000


@pytest.mark.parametrize("asked", [0.12, 0.4, -0.4])
def test_a_wheel_that_does_not_reach_half_in_time_is_held(robot: SpeedBench, asked: float) -> None:
    robot.begin()
    hold(robot, "left", lambda _ms: 0.4 * asked)
    behind_from_ms = max(0.1, 0.8 * abs(asked)) / ACCELERATION * 1000
    assert 0 <= held_ms(robot, asked, asked) - HELD_REACH_MS - behind_from_ms <= 60
    assert (robot.wheels().drive_state, robot.wheels().latch) == (DriveState.HELD, Latch.NONE)
    assert robot.wheels().speed_flags & SpeedFlag.LEFT_HELD


def test_a_wheel_that_has_reached_half_of_less_is_held_when_more_is_asked_for(robot: SpeedBench) -> None:
    """A hand that lets it creep, at first as fast as is asked."""
    robot.begin(0.12, 0.12)
    hold(robot, "left", lambda _ms: 0.12)
    assert HELD_REACH_MS <= held_ms(robot, 0.5, 0.5) <= HELD_REACH_MS + 300
    assert robot.wheels().speed_flags & SpeedFlag.LEFT_HELD


def test_a_wheel_that_was_slow_is_held_when_it_gets_slower(robot: SpeedBench) -> None:
    """It had never been as fast as HELD_FROM_UM_S."""
    robot.begin()
    hold(robot, "left", lambda _ms: 0.08)
    robot.go(0.15, 0.15, 1000)
    hold(robot, "left", lambda _ms: 0.02)
    assert held_ms(robot, 0.15, 0.15) <= HELD_FALLEN_MS + METER_MS + 30
    assert robot.wheels().speed_flags & SpeedFlag.LEFT_HELD


def test_a_wheel_that_is_slow_now_and_then_is_not_held(robot: SpeedBench) -> None:
    """On a rough floor: half of what is asked for, a little less or more, is less for some 0.2 s each time."""
    robot.begin()
    hold(robot, "left", lambda ms: 0.15 + 0.03 * math.sin(ms / 60))
    assert held_ms(robot, 0.3, 0.3, 4000) == 4000


def test_slower_wheels_are_not_judged(robot: SpeedBench) -> None:
    robot.begin(0.095, 0.095)
    hold(robot, "left")
    assert held_ms(robot, 0.095, 0.095, 3000) == 3000
    assert robot.model.motor[0].drive_peak <= CONTROL.stall_pwm


def test_a_wheel_that_has_crept_is_held_after_a_while_without_an_edge(robot: SpeedBench) -> None:
    """It never was so fast that it can have fallen."""
    robot.begin()
    began = robot.now_ms
    hold(robot, "left", lambda ms: 0.03 if ms < began + 150 else 0.0)
    assert 130 <= held_ms(robot, 0.2, 0.2) - SILENT_MS <= 190
    assert robot.wheels().speed_flags & SpeedFlag.LEFT_HELD


def test_from_rest_it_is_the_stuck_rule_that_judges(robot: SpeedBench) -> None:
    robot.begin()
    hold(robot, "left")
    assert held_ms(robot, 0.5, 0.5) == pytest.approx(STUCK_MS, abs=70)
    assert (robot.wheels().drive_state, robot.wheels().latch) == (DriveState.LATCHED, Latch.LEFT_STUCK)


@pytest.mark.parametrize("wheel", BOTH)
def test_an_overdue_edge_takes_the_loop_away(robot: SpeedBench, wheel: str) -> None:
    """Plain feed-forward, no more than stall_pwm, until it is held; and flagged."""
    robot.begin(0.09, -0.09, stall_pwm=8)
    hold(robot, wheel)
    given: list[float] = []
    robot.go(0.09, -0.09, 60, lambda: given.append(abs(robot.duties()[BOTH.index(wheel)])))
    assert max(given[OVERDUE_MS - 5 : OVERDUE_MS]) > 8, "not yet"
    robot.go(0.09, -0.09, TELEMETRY_MS, lambda: given.append(abs(robot.duties()[BOTH.index(wheel)])))
    assert set(given[OVERDUE_MS + PERIOD_MS + 2 :]) == {8}
    assert robot.wheels().speed_flags == flag(wheel, "OVERDUE")
    hold(robot, wheel, None)
    robot.go(0.09, -0.09, 500)
    assert robot.wheels().speed_flags == 0


@pytest.mark.parametrize("intervals", [OVERDUE_INTERVALS - 0.5, OVERDUE_INTERVALS + 1])
def test_a_slow_wheels_edge_is_overdue_after_three_intervals(robot: SpeedBench, intervals: float) -> None:
    robot.begin(0.02, 0.02, 2000)
    interval_ms = 1000 / (0.02 * ROBOT.ticks_per_metre)
    ticks = robot.wheels().left_ticks
    while robot.wheels().left_ticks == ticks:
        robot.go(0.02, 0.02, 1)
    hold(robot, "left")
    robot.go(0.02, 0.02, round(intervals * interval_ms))
    assert bool(robot.wheels().speed_flags & SpeedFlag.LEFT_OVERDUE) == (intervals > OVERDUE_INTERVALS)


@pytest.mark.parametrize("asked", [0.05, 0.09])
def test_an_overdue_wheel_gathers_nothing(robot: SpeedBench, asked: float) -> None:
    robot.begin(asked, asked)
    hold(robot, "left")
    robot.go(asked, asked, 200)
    assert robot.wheels().speed_flags & SpeedFlag.LEFT_OVERDUE
    assert not robot.wheels().speed_flags & SpeedFlag.RIGHT_OVERDUE
    before = robot.duties()[0]
    robot.go(asked, asked, 2000)
    assert robot.duties()[0] == pytest.approx(before, abs=1)
    hold(robot, "left", None)
    fastest: list[float] = []
    robot.go(asked, asked, 1000, lambda: fastest.append(robot.speed[0]))
    assert max(fastest) <= 1.25 * asked
    assert robot.wheels().speed_flags == 0


def test_while_held_nothing_moves_before_a_zero(robot: SpeedBench) -> None:
    robot.begin(0.3, 0.3)
    hold(robot, "left")
    held_ms(robot, 0.3, 0.3)
    robot.hands = [None, None]
    robot.model.motor[0].drive_peak = robot.model.motor[1].drive_peak = 0
    robot.go(0.3, 0.3, 400)
    assert (robot.wheels().drive_state, robot.wheels().last_refusal) == (DriveState.HELD, Refusal.AWAITING_ZERO)
    robot.go(0.0, 1e-6, 100)
    assert robot.wheels().drive_state == DriveState.HELD
    robot.send(robot.drive_frame(1, 0))
    robot.run(TELEMETRY_MS)
    assert (robot.wheels().drive_state, robot.wheels().last_refusal) == (DriveState.HELD, Refusal.LEVEL)
    assert robot.model.motor[0].drive_peak == robot.model.motor[1].drive_peak == 0
    open_again(robot)
    robot.go(0.3, 0.3, 1500)
    assert robot.speed[0] == pytest.approx(0.3, rel=0.03)
    assert robot.wheels().speed_flags & SpeedFlag.LEFT_HELD, "the newest time that it was so"


def test_a_zero_from_before_it_was_held_opens_nothing(robot: SpeedBench) -> None:
    """Its host cannot know yet, and would go on."""
    robot.begin(0.3, 0.3)
    early = robot.wheels().board_ms
    hold(robot, "left")
    while robot.duties() != (0, 0):
        robot.send(robot.speed_frame(0.3, 0.3))
        robot.run(3)
    robot.hands = [None, None]
    robot.run(TELEMETRY_MS)
    robot.send(robot.speed_frame(0.0, 0.0, board_ms=early))
    robot.run(TELEMETRY_MS)
    assert (robot.wheels().drive_state, robot.wheels().last_refusal) == (DriveState.HELD, Refusal.AWAITING_ZERO)
    robot.send(robot.speed_frame(0.0, 0.0))
    robot.run(TELEMETRY_MS)
    assert robot.wheels().drive_state == DriveState.ACTIVE


def test_held_three_times_within_a_minute_is_latched_and_kept(robot: SpeedBench) -> None:
    robot.begin()
    for wheel in ("left", "left", "right"):
        assert robot.wheels().latch == Latch.NONE
        robot.go(0.3, 0.3, 900)
        hold(robot, wheel)
        held_ms(robot, 0.3, 0.3)
        robot.hands = [None, None]
        robot.run(20)
        robot.go(0.0, 0.0, 400)
    assert (robot.wheels().drive_state, robot.wheels().latch) == (DriveState.LATCHED, Latch.RIGHT_STUCK)
    assert set(robot.board.eeprom[LATCH_AT : LATCH_AT + 2]) == {LATCHED + Latch.RIGHT_STUCK}
    robot.model.motor[0].drive_peak = 0
    robot.go(0.3, 0.3, 100)
    assert (robot.wheels().last_refusal, robot.model.motor[0].drive_peak) == (Refusal.LATCHED, 0)


def test_a_release_begins_to_count_anew(robot: SpeedBench) -> None:
    robot.begin()
    causes = []
    for _ in range(2 * HELD_TIMES):
        robot.go(0.3, 0.3, 900)
        hold(robot, "left")
        held_ms(robot, 0.3, 0.3)
        robot.hands = [None, None]
        robot.run(20)
        causes.append(Latch(robot.wheels().latch))
        if causes[-1] != Latch.NONE:
            robot.send(robot.estop_frame(engage=0))
            robot.run(20)
        robot.go(0.0, 0.0, 400)
    assert causes == [Latch.NONE, Latch.NONE, Latch.LEFT_STUCK] * 2


@pytest.mark.parametrize(
    ("spread_ms", "latch"), [(HELD_WITHIN_MS - 500, Latch.LEFT_STUCK), (HELD_WITHIN_MS + 500, Latch.NONE)]
)
def test_but_not_in_more_than_a_minute(robot: SpeedBench, spread_ms: int, latch: Latch) -> None:
    robot.begin()
    times: list[int] = []
    for number in range(HELD_TIMES):
        wait = times[0] + spread_ms * number // (HELD_TIMES - 1) - 500 - robot.now_ms if times else 0
        robot.run(wait)
        robot.go(0.0, 0.0, 40)
        robot.go(0.3, 0.3, 500 - 40 - 80)
        hold(robot, "left")
        held_ms(robot, 0.3, 0.3)
        times.append(robot.now_ms)
        assert robot.wheels().drive_state in (DriveState.HELD, DriveState.LATCHED)
        robot.hands = [None, None]
    assert times[-1] - times[0] == pytest.approx(spread_ms, abs=200)
    assert robot.wheels().latch == latch


def test_a_host_that_asks_for_less_lets_a_wheel_get_slower(robot: SpeedBench) -> None:
    robot.begin(0.5, 0.5)
    for asked in (0.2, 0.1, 0.03, 0.3, 0.1, -0.1, -0.5, 0.5, 0.0, -0.3, -0.1, 0.1):
        robot.go(asked, asked, 700)
        assert robot.wheels().drive_state == DriveState.ACTIVE, asked


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_asked_in_turn_no_free_wheel_is_held(robot: SpeedBench, seed: int) -> None:
    chance = random.Random(seed)
    robot.strength = [chance.uniform(0.85, 1.0), chance.uniform(0.85, 1.0)]
    robot.volts(chance.uniform(20.4, 26.0))
    robot.begin()
    for _ in range(60):
        if chance.random() < 0.5:
            asked = [chance.uniform(-0.6, 0.6), chance.uniform(-0.6, 0.6)]
        else:
            asked = [chance.choice((-0.5, -0.1, 0.0, 0.1, 0.5))] * 2
        robot.go(asked[0], asked[1], 20 * chance.choice((1, 2, 5, 20, 50)))
        told = robot.wheels()
        assert (told.drive_state, told.latch) == (DriveState.ACTIVE, Latch.NONE), asked

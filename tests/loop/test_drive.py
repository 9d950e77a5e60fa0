"""Tilt in the hand to PWM in the firmware, through every policy, in simulated time."""

from collections import Counter

import pytest

from giraff_sim.board import Implementation
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.world.world import STEP_US
from tests.loop.loops import FULL_TILT, SOURCE_CURVE, arm, closed_loop, hold
from tests.sim.robots import proving_room


def pwm_counts(loop: ClosedLoop) -> tuple[int, int]:
    wheels = loop.newest["wheels"]
    return wheels.left_pwm_counts, wheels.right_pwm_counts


@pytest.mark.parametrize("implementation", [*Implementation], ids=str)
def test_seven_forward_is_thirty_five_on_both_wheels(implementation: Implementation) -> None:
    with closed_loop(proving_room(), SOURCE_CURVE, implementation, step_us=STEP_US) as loop:
        arm(loop)
        hold(loop, x=7.0)
        loop.run(1.0)
        given: Counter[tuple[int, int]] = Counter()
        for _ in range(10):
            loop.run(0.1)
            given[pwm_counts(loop)] += 1
        # The hand that holds it trembles: a level more or less now and then, and two in one moment of sixty.
        assert given.most_common(1)[0][0] == (35, 35)
        assert sum(count for pair, count in given.items() if max(abs(level - 35) for level in pair) <= 1) >= 9
        assert all(abs(level - 35) <= 2 for pair in given for level in pair)
        assert loop.simulation.world.plant.pose.x > 0.2


@pytest.mark.parametrize(("tilt", "signs"), [(7.0, (-1, 1)), (-7.0, (1, -1))])
def test_sideways_turns_in_place(tilt: float, signs: tuple[int, int]) -> None:
    with closed_loop(proving_room(), SOURCE_CURVE, step_us=STEP_US) as loop:
        arm(loop)
        hold(loop, y=tilt)
        loop.run(2.0)
        left, right = pwm_counts(loop)
        # The hand that holds it trembles: a level more or less.
        assert abs(left - 35 * signs[0]) <= 1
        assert abs(right - 35 * signs[1]) <= 1
        pose = loop.simulation.world.plant.pose
        assert abs(pose.x) < 0.05
        assert abs(pose.y) < 0.05


def test_a_start_is_ramped_and_a_stop_is_immediate() -> None:
    with closed_loop(proving_room()) as loop:
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(0.4)
        assert 0.1 < loop.newest["wheels"].left_velocity < 0.4
        loop.run(1.6)
        assert loop.newest["wheels"].left_velocity == pytest.approx(0.6, rel=0.02)
        hold(loop)
        begin = loop.simulation.now_us
        while pwm_counts(loop) != (0, 0):
            loop.step()
        # Hand to board: 8 ms sensor, 20 ms frame, 5 ms on its wire, 2 ms on the base board's; 10 ms to its next report.
        assert loop.simulation.now_us - begin < 45_000


def test_nothing_moves_before_a_neutral_hand() -> None:
    with closed_loop(proving_room()) as loop:
        hold(loop, x=FULL_TILT)
        loop.run(3.0)
        assert loop.simulation.record.window(0, loop.simulation.now_us).driven_ms == 0
        assert "hold the hand level" in str(loop.newest["base"].reason)
        arm(loop)
        hold(loop, x=FULL_TILT)
        loop.run(1.0)
        assert pwm_counts(loop)[0] > 0

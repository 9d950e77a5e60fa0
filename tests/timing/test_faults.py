"""The quick rows of the fault campaign: real processes, the real firmware, one fault or two, one robot for all."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.support.process_robot import FULL_TILT
from tests.timing.faults import Scenario
from tests.timing.scenarios import SCENARIOS
from tests.timing.trials import Stand, stand

QUICK = [scenario for scenario in SCENARIOS if scenario.quick]


@pytest.fixture(scope="module")
def robots(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stand]:
    with stand(tmp_path_factory.mktemp("robots")) as made:
        yield made


@pytest.mark.parametrize("scenario", QUICK, ids=lambda scenario: scenario.name)
def test_a_fault_stops_the_robot_and_only_a_level_hand_starts_it_again(scenario: Scenario, robots: Stand) -> None:
    robots.tried(scenario)


def test_a_second_joystick_of_the_same_name_moves_nothing(robots: Stand) -> None:
    robot = robots.robot()
    robot.arm()
    since_us = robot.simulator.now()
    with robot.start_second_hand() as other:
        other.tilt(FULL_TILT, 0.0)
        robot.run(2.5)
        assert robot.simulator.record(since_us).driven_ms == 0
        refusals = [message for message in robot.messages("second joystick") if "held by joystick" in message]
        assert refusals, "the second is told who holds the lease"
    robot.stop("second joystick")
    robot.stop("second simulator")
    robot.drive_forward()

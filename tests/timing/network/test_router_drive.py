"""Driving a robot at another site: the real services on host boards, with nothing but a router between the sites."""

import time
from collections.abc import Iterator

import pytest

from giraff_schemas.topics import ODOM, key_of
from tests.support.remote_robot import AWAY, ROBOT, Stage, remote_stage
from tests.support.waiting import wait
from tests.timing.stalled import by_the_wall

OPERATORS_BOUND = 0.45
"""s from the loss of the operator's link to PWM 0."""
BACK_WITHIN = 5.0  # s


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    with remote_stage(tmp_path_factory.mktemp("stage")) as made:
        yield made


@pytest.mark.parametrize("fault", ["the router is killed", "the operator's cable is pulled"])
def test_driven_and_watched_through_the_router(stage: Stage, fault: str) -> None:
    begin, end = stage.faults[fault]
    robot, desk = stage.robot, stage.behind.join("desk", AWAY, ROBOT)
    desk.ask("subscribe", key_of(ROBOT, ODOM))
    took = robot.drive(30.0)
    robot.run(1.0)
    while not robot.drives():  # a machine that stalls for 0.2 s stops the joystick, which then wants a level hand
        took += robot.drive(30.0 - took)
        robot.run(1.0)
    assert len(desk.ask("heard")) > 50, "odometry does not come at its rate"

    begin_ns, begun_us = time.monotonic_ns(), robot.simulator.now()
    begin()
    robot.run(5.0)
    driven_until = ((robot.simulator.record(begun_us).last_driven_us or begun_us) - begun_us) * 1e-6
    desk.ask("heard")
    end()
    watched = wait(lambda: bool(desk.ask("heard")), 60.0)
    ended_us = robot.simulator.now()
    robot.run(3.0)
    assert robot.simulator.record(ended_us).driven_ms == 0, "the hand was tilted all the time: only a level one arms"
    again = robot.drive(30.0)
    robot.tilt(0.0)
    print(
        f"drove after {took:.1f} s; {fault}: PWM 0 after {driven_until:.2f} s; "
        f"mended: watched after {watched:.2f} s, drove {again:.1f} s after a level hand"
    )
    with by_the_wall(begin_ns):
        assert driven_until <= OPERATORS_BOUND
        assert watched <= BACK_WITHIN

"""Driving a robot at another site: the real services on host boards, with nothing but a router between the sites."""

from pathlib import Path

from giraff_schemas.topics import ODOM, key_of
from tests.support.process_robot import PATIENCE
from tests.support.remote_robot import AWAY, ROBOT, remote_stage
from tests.support.waiting import wait


def test_driven_and_watched_through_the_router_which_is_lost_and_comes_back(tmp_path: Path) -> None:
    with remote_stage(tmp_path) as stage:
        robot, desk = stage.robot, stage.behind.join("desk", AWAY, ROBOT)
        desk.ask("subscribe", key_of(ROBOT, ODOM))
        robot.drive()
        wait(lambda: bool(desk.ask("heard")), PATIENCE, what="odometry at the desk")
        stage.behind.kill_router()
        robot.wait("standing", lambda: not robot.drives())
        robot.run(0.5)  # a lease that is not renewed lasts 0.3 s
        lost_us = robot.simulator.now()
        desk.ask("heard")
        robot.run(1.0)
        assert not desk.ask("heard"), "the desk has another way than the router"
        stage.behind.start_router()
        wait(lambda: bool(desk.ask("heard")), PATIENCE, what="odometry at the desk again")
        robot.run(1.5)
        assert robot.simulator.record(lost_us).driven_ms == 0, "the hand was tilted all the time: only a level one arms"
        robot.drive()
        robot.tilt(0.0)

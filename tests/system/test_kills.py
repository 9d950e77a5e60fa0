"""SIGKILL of each service while the real robot drives: the board's own record says when the motors stopped."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

from tests.system.robot import ProcessRobot, process_robot
from tests.system.stalls import without_stall

BOUNDS = {"base": 0.35, "guard": 0.35, "joystick": 0.45, "ranger": 0.45}
"""s from the end of the service to PWM zero, beside the longest gap between accepted frames before it."""


def stop_time(robot: ProcessRobot, service: str) -> tuple[float, float]:
    """Drive, kill: s until the last PWM, and the longest gap between accepted frames before the kill."""
    robot.drive_forward()
    killed_us = robot.simulator.now()
    before = robot.simulator.record(killed_us - 1_000_000, killed_us)
    robot.kill(service)
    robot.run(1.5)
    after = robot.simulator.record(killed_us, killed_us + 1_500_000)
    last_us = after.last_driven_us or killed_us
    return (last_us - killed_us) * 1e-6, before.longest_accept_gap_us * 1e-6


@pytest.mark.parametrize("service", BOUNDS)
def test_a_killed_service_stops_the_robot(service: str, tmp_path: Path) -> None:
    with process_robot(tmp_path) as robot:

        def kill_and_restart() -> tuple[float, float]:
            figures = stop_time(robot, service)
            restarted_us = robot.simulator.now()
            robot.start(service)
            robot.run(2.5)
            # The hand is still tilted: a reset permits motion and never causes it.
            assert robot.simulator.record(restarted_us).driven_ms == 0, "the robot moved before a neutral hand"
            return figures

        took, gap = without_stall(kill_and_restart)
        print(f"{service}: PWM 0 after {took:.3f} s; longest gap before {gap:.3f} s")
        assert took <= BOUNDS[service] + gap
        robot.drive_forward()  # no other service was restarted


def test_without_odometry_the_robot_drives_on(tmp_path: Path) -> None:
    with process_robot(tmp_path) as robot:
        robot.drive_forward()
        robot.kill("odometry")
        killed_us = robot.simulator.now()
        robot.run(1.0)
        verdict = robot.simulator.record(killed_us)
        assert verdict.driven_ms * 1000 >= verdict.until_us - verdict.since_us - 10_000
        robot.start("odometry")
        robot.wait("odometry", lambda: "robot sim-test" in robot.log("odometry"), 5.0)


def test_a_suspended_base_drives_on_nothing_old(tmp_path: Path) -> None:
    with process_robot(tmp_path) as robot:
        robot.drive_forward()
        robot.signal("base", signal.SIGSTOP)
        stopped_us = robot.simulator.now()
        robot.run(3.0)
        robot.signal("base", signal.SIGCONT)
        robot.run(3.0)
        verdict = robot.simulator.record(stopped_us)
        assert verdict.last_driven_us is not None
        assert (verdict.last_driven_us - stopped_us) * 1e-6 <= 0.35
        robot.drive_forward()

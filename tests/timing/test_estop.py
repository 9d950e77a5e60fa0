"""How soon the motors are off when base has confirmed an emergency stop from another machine."""

import time
from pathlib import Path

from tests.support.elsewhere import giraff
from tests.support.process_robot import ProcessRobot, process_robot
from tests.timing.stalled import by_the_wall


def stop_time(robot: ProcessRobot) -> float:
    """Engage while the robot drives: s from base's word to PWM zero, negative when it was zero before."""
    robot.drive_forward()
    began_us = robot.simulator.now()
    told = giraff(robot, "estop", "engage", "--reason", "a cat")
    confirmed_us = robot.simulator.now()
    assert (told.returncode, told.stderr) == (0, "")
    assert told.stdout.startswith("sim-test: STOPPED, latch ")
    robot.run(0.5)
    last_us = robot.simulator.record(began_us).last_driven_us
    assert last_us is not None
    return (last_us - confirmed_us) * 1e-6


def test_the_motors_are_off_when_base_says_so(tmp_path: Path) -> None:
    with process_robot(tmp_path) as robot:
        begin_ns = time.monotonic_ns()
        took = stop_time(robot)
        print(f"PWM 0 {took:+.3f} s after base's word")
        with by_the_wall(begin_ns):
            assert took <= 0.05

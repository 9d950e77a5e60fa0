"""How soon the robot stops when a key, a keyboard or its process is let go."""

import time
from collections.abc import Iterator

import pytest

from tests.support.keyboard_user import ARMED, hold, keyboard, take
from tests.support.process_robot import ProcessRobot, process_robot
from tests.timing.stalled import by_the_wall

STOPS_WITHIN = 0.45
"""s from the last press to PWM zero."""


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("robot"), boards="host") as made:
        made.stop("joystick")
        yield made


def stop_time(robot: ProcessRobot, since_us: int) -> float:
    robot.run(1.0)
    last = robot.simulator.record(since_us).last_driven_us
    return ((last or since_us) - since_us) * 1e-6


def test_a_key_let_go_the_space_bar_and_ctrl_c_stop_it_in_time(robot: ProcessRobot) -> None:
    with keyboard(robot) as shown:
        take(shown)
        with by_the_wall():
            hold(shown, b"w", 1.0)
            assert robot.drives()
            took = stop_time(robot, robot.simulator.now())
            print(f"key let go: PWM 0 after {took:.3f} s")
            assert took <= STOPS_WITHIN

        with by_the_wall():
            hold(shown, b"\x1b[D", 1.0)
            says = robot.simulator.state().base
            assert says is not None
            assert says.left_pwm_counts != 0
        assert says.left_pwm_counts < 0 < says.right_pwm_counts
        shown.forget()
        begin_ns, pressed_us = time.monotonic_ns(), robot.simulator.now()
        shown.type(b" ")
        shown.wait_for("STOPPED: base has confirmed")
        took = stop_time(robot, pressed_us)
        print(f"space bar: PWM 0 after {took:.3f} s")
        with by_the_wall(begin_ns):
            assert took <= 0.35
        shown.wait_for("base has confirmed. By keyboard@")
        hold(shown, b"w", 1.0)
        assert robot.simulator.record(pressed_us + 500_000).driven_ms == 0

        assert robot.giraff("estop", "reset") == 0
        shown.forget()
        shown.wait_for(ARMED)
        with by_the_wall():
            hold(shown, b"s", 1.0)
            assert robot.drives()
        shown.type(b"\x03")
        assert shown.process.wait(10.0) == 0
        assert shown.is_restored()
        with by_the_wall():
            ended_us = robot.simulator.now()
            assert stop_time(robot, ended_us) <= STOPS_WITHIN


def test_killed_it_drives_nothing_in_time(robot: ProcessRobot) -> None:
    with keyboard(robot) as shown:
        take(shown)
        with by_the_wall():
            hold(shown, b"w", 1.0)
            assert robot.drives()
            shown.process.kill()
            took = stop_time(robot, robot.simulator.now())
            print(f"SIGKILL: PWM 0 after {took:.3f} s")
            assert took <= STOPS_WITHIN

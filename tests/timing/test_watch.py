"""What `giraff watch` costs, how often it tells, and how soon it ends."""

import signal
import time
from collections.abc import Iterator
from itertools import pairwise

import msgspec
import psutil
import pytest

from tests.support.elsewhere import GIRAFF, end, line_that, watching
from tests.support.process_robot import ProcessRobot, process_robot
from tests.support.terminals import screen
from tests.timing.stalled import by_the_wall


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("robot"), boards="host") as made:
        yield made


def test_ctrl_c_gives_the_terminal_back_at_once(robot: ProcessRobot) -> None:
    environment = robot.environment | {"TERM": "xterm-256color"}
    with screen([str(GIRAFF), "watch"], robot.directory / "watch.err", environment) as shown:
        shown.wait_for("at rest", 20.0)
        began_ns = time.monotonic_ns()
        shown.type(b"\x03")
        assert shown.process.wait(10.0) == 0
        with by_the_wall(began_ns):
            assert time.monotonic_ns() - began_ns < 1_000_000_000


def test_an_object_comes_each_second_and_nothing_of_odometry_is_lost(robot: ProcessRobot) -> None:
    robot.drive_forward()
    with watching(robot, "--json") as process, by_the_wall():
        assert process.stdout is not None
        told = [msgspec.json.decode(process.stdout.readline()) for _ in range(4)]
        assert [round(later["elapsed"] - before["elapsed"]) for before, later in pairwise(told[1:])] == [1, 1]
        assert told[-1]["topics"]["odom"]["lost"] == 0


def test_silence_is_told_each_second(robot: ProcessRobot) -> None:
    with watching(robot) as process:
        line_that(process, lambda line: "base " in line)
        with by_the_wall():
            for service in ("base", "guard", "joystick", "ranger", "odometry"):
                robot.kill(service)
            line_that(process, lambda line: line.endswith("| sim-test silent since 2 s\n"), 30)
            line_that(process, lambda line: line.endswith("| sim-test silent since 3 s\n"), 1)
        for service in ("base", "guard", "joystick", "ranger", "odometry"):
            robot.start(service)
        robot.wait_until_it_can_drive()
        with by_the_wall():
            assert end(process, signal.SIGTERM) < 1.0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_paused_reader_does_not_hold_up_its_end(robot: ProcessRobot, number: signal.Signals) -> None:
    with watching(robot, "--json", pipesize=4096) as process:  # takes one object
        line_that(process, lambda line: '"base"' in line)
        time.sleep(3.0)
        with by_the_wall():
            assert end(process, number) < 1.0


def test_a_watch_costs_little(robot: ProcessRobot) -> None:
    """Of a core that runs the robot and other tests, too: the bound is twice what docs/watch.md tells."""
    robot.drive_forward()
    with watching(robot) as process:
        line_that(process, lambda line: "base" in line)
        watched = psutil.Process(process.pid)
        before, began = sum(watched.cpu_times()[:2]), time.monotonic()
        time.sleep(8.0)
        share = (sum(watched.cpu_times()[:2]) - before) / (time.monotonic() - began)
        assert share < 0.10
        end(process, signal.SIGINT)

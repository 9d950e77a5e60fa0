"""`giraff watch` beside the real robot: on a terminal and into a pipe, while the robot drives, dies and comes back."""

from __future__ import annotations

import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec
import psutil

from tests.support.elsewhere import GIRAFF
from tests.support.process_robot import SERVICES, ProcessRobot, process_robot
from tests.support.terminals import screen
from tests.timing.stalled import by_the_wall


@contextmanager
def watching(robot: ProcessRobot, *words: str, **popen: Any) -> Iterator[subprocess.Popen[str]]:
    """A watch of the robot, into a pipe."""
    streams: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    command = [str(GIRAFF), "watch", *words]
    with subprocess.Popen(command, env=robot.environment, cwd=robot.directory, **streams | popen) as process:
        try:
            yield process
        finally:
            process.kill()


def line_that(process: subprocess.Popen[str], told: Callable[[str], bool], most: int = 30) -> str:
    """The next line, one a second, of which that is so."""
    assert process.stdout is not None
    lines = []
    for line in process.stdout:
        lines.append(line)
        if told(line):
            return line
        if len(lines) == most:
            break
    raise AssertionError("".join(lines))


def end(process: subprocess.Popen[str], number: signal.Signals) -> float:
    """How long it took to end well, s."""
    began = time.monotonic()
    process.send_signal(number)
    assert process.wait(10.0) == 0
    assert process.stderr is not None
    assert process.stderr.read() == ""
    return time.monotonic() - began


def test_a_terminal_shows_the_robot_and_is_given_back(tmp_path: Path) -> None:
    with process_robot(tmp_path, boards="host") as robot:
        robot.arm()
        environment = robot.environment | {"TERM": "xterm-256color"}
        with screen([str(GIRAFF), "watch"], tmp_path / "watch.err", environment) as shown:
            shown.wait_for("armed, at rest", 20.0)
            robot.drive_forward()
            shown.wait_for("driving", 20.0)
            at = robot.simulator.state()
            robot.simulator.add_wall("wall", [(at.x + 1.2, -2.0), (at.x + 1.2, 2.0)])
            shown.wait_for("blocked", 20.0)
            assert robot.giraff("estop", "engage", "--reason", "a cat") == 0
            shown.wait_for("a cat", 10.0)
            began_ns = time.monotonic_ns()
            shown.type(b"\x03")
            assert shown.process.wait(10.0) == 0
            with by_the_wall(began_ns):
                assert time.monotonic_ns() - began_ns < 1_000_000_000
            assert shown.is_restored()
            text = shown.read()
        assert (tmp_path / "watch.err").read_text() == ""
        assert text.index("\x1b[?1049h") < text.index("GUARD") < text.rindex("\x1b[?1049l")
        for service in SERVICES:
            assert service in text


def test_lines_go_on_while_the_robot_dies_and_comes_back(tmp_path: Path) -> None:
    with process_robot(tmp_path, boards="host") as robot, watching(robot) as process:
        robot.arm()
        line_that(process, lambda line: "base armed, at rest" in line and "holder joystick" in line)
        robot.drive_forward()
        driving = line_that(process, lambda line: "base driving" in line)
        assert re.search(r"path +\d+\.\d\d m \| +0\.\d\d m/s +-?0\.\d\d rad/s \| ranges ", driving)
        for service in SERVICES:
            robot.kill(service)
        line_that(process, lambda line: line.endswith("| sim-test silent since 2 s\n"))
        line_that(process, lambda line: line.endswith("| sim-test silent since 3 s\n"))
        for service in SERVICES:
            robot.start(service)
        line_that(process, lambda line: "base not armed" in line and "not there" not in line)
        robot.arm(20.0)
        line_that(process, lambda line: "base armed, at rest" in line)
        robot.kill("odometry")
        line_that(process, lambda line: "| not there: odometry" in line and "|  0.00 m/s     - rad/s |" in line)
        assert end(process, signal.SIGTERM) < 1.0


def test_a_script_reads_objects_and_may_go_when_it_likes(tmp_path: Path) -> None:
    with process_robot(tmp_path, boards="host") as robot, watching(robot, "--json") as process:
        robot.drive_forward()
        assert process.stdout is not None
        told = [msgspec.json.decode(process.stdout.readline()) for _ in range(4)]
        assert [round(later["elapsed"] - before["elapsed"]) for before, later in pairwise(told[1:])] == [1, 1]
        newest = told[-1]
        assert (newest["robot"], newest["missing"], newest["estop"]["engaged"]) == ("sim-test", [], False)
        assert newest["services"] == dict.fromkeys(SERVICES, 1)
        assert set(newest["ranges"]) == {"front_left", "front_right", "rear"}
        assert newest["topics"]["odom"]["lost"] == 0
        assert "cmd_vel" not in newest["topics"]
        process.stdout.close()
        assert process.wait(5.0) == 0
        assert process.stderr is not None
        assert process.stderr.read() == ""


def test_a_full_disk_is_named_and_a_paused_reader_holds_nothing_up(tmp_path: Path) -> None:
    with process_robot(tmp_path, boards="host") as robot:
        with Path("/dev/full").open("w") as full, watching(robot, stdout=full) as process:
            assert process.wait(20.0) == 1
            assert process.stderr is not None
            assert process.stderr.read() == "giraff: cannot write to standard output: No space left on device\n"
        with watching(robot, "--json", pipesize=4096) as process:  # takes one object
            line_that(process, lambda line: '"base"' in line)
            time.sleep(3.0)
            assert end(process, signal.SIGINT) < 1.0


def test_a_watch_costs_little(tmp_path: Path) -> None:
    """Of a core that runs the robot and other tests, too: the bound is twice what docs/watch.md tells."""
    with process_robot(tmp_path, boards="host") as robot:
        robot.drive_forward()
        with watching(robot) as process:
            line_that(process, lambda line: "base" in line)
            watched = psutil.Process(process.pid)
            before, began = sum(watched.cpu_times()[:2]), time.monotonic()
            time.sleep(8.0)
            share = (sum(watched.cpu_times()[:2]) - before) / (time.monotonic() - began)
            assert share < 0.10
            end(process, signal.SIGINT)

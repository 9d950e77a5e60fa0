"""`giraff watch` beside the real robot: on a terminal and into a pipe, while the robot drives, dies and comes back."""

import fcntl
import re
import signal
import struct
import subprocess
import termios
from collections.abc import Callable
from pathlib import Path

import msgspec

from tests.support.elsewhere import GIRAFF, end, line_that, watching
from tests.support.process_robot import BRIEF, PATIENCE, SERVICES, ProcessRobot
from tests.support.terminals import Screen, screen
from tests.support.waiting import wait

PIPE = 4096
"""Bytes. An object is about as long, and may be longer."""


def wait_for(shown: Screen, text: str, act: Callable[[], object]) -> None:
    """Do it again until that is shown: a busy machine has stopped the robot before it was."""

    def is_shown() -> bool:
        act()
        return text in shown.read()

    wait(is_shown, PATIENCE, what=lambda: f"{text!r} is not shown: {shown.text[-2000:]}", every=0.2)


def line_of(process: subprocess.Popen[str], words: str, act: Callable[[], object]) -> str:
    """The next line that has these words. Do it again after each other one."""

    def has_them(line: str) -> bool:
        if words not in line:
            act()
        return words in line

    act()
    return line_that(process, has_them)


def drive(robot: ProcessRobot) -> None:
    """Drive forward from the middle of the room."""
    robot.simulator.place(0.0, 0.0)
    robot.drive_forward(BRIEF)


def test_a_terminal_shows_the_robot_and_is_given_back(robot: ProcessRobot) -> None:
    environment = robot.environment | {"TERM": "xterm-256color"}
    log = robot.directory / "watch.err"
    with screen([str(GIRAFF), "watch"], log, environment) as shown:
        wait_for(shown, "armed, at rest", robot.arm)
        wait_for(shown, "driving", lambda: drive(robot))
        robot.put_up_wall("wall", ahead=1.2, half_width=2.0)
        shown.wait_for("blocked", PATIENCE)
        assert robot.giraff("estop", "engage", "--timeout", "60", "--reason", "a cat") == 0
        shown.wait_for("a cat", PATIENCE)
        shown.type(b"\x03")
        assert shown.ended(PATIENCE) == 0
        assert shown.is_restored()
        text = shown.read()
    assert log.read_text() == ""
    assert text.index("\x1b[?1049h") < text.index("GUARD") < text.rindex("\x1b[?1049l")
    for service in SERVICES:
        assert service in text
    robot.simulator.remove_wall("wall")
    robot.simulator.place(0.0, 0.0)
    assert robot.giraff("estop", "reset", "--timeout", "60") == 0


def test_lines_go_on_while_the_robot_dies_and_comes_back(robot: ProcessRobot) -> None:
    with watching(robot) as process:
        line_of(process, "holder joystick | base armed, at rest", robot.arm)
        driving = line_of(process, "base driving", lambda: drive(robot))
        assert re.search(r"path +\d+\.\d\d m \| +[+-]?\d\.\d\d m/s +[+-]?\d\.\d\d rad/s \| ranges ", driving)
        for service in SERVICES:
            robot.kill(service)
        line_that(process, lambda line: re.search(r"\| sim-test silent since \d+ s\n$", line) is not None)
        for service in SERVICES:
            robot.start(service)
        line_of(process, "base armed, at rest", robot.arm)
        robot.kill("odometry")
        line_that(process, lambda line: "| not there: odometry" in line and "|  0.00 m/s     - rad/s |" in line)
        robot.start("odometry")
        end(process, signal.SIGTERM)


def test_a_script_reads_objects_and_may_go_when_it_likes(robot: ProcessRobot) -> None:
    def is_whole(line: str) -> bool:
        told = msgspec.json.decode(line)
        is_there = not told["missing"] and told["services"] == dict.fromkeys(SERVICES, 1)
        return bool(is_there and "odom" in told["topics"])  # which a busy machine may hold up for a while

    with watching(robot, "--json") as process:
        newest = msgspec.json.decode(line_that(process, is_whole))
        assert (newest["robot"], newest["estop"]["engaged"]) == ("sim-test", False)
        assert set(newest["ranges"]) == {"front_left", "front_right", "rear"}
        assert "cmd_vel" not in newest["topics"]
        assert process.stdout is not None
        process.stdout.close()
        assert process.wait(PATIENCE) == 0
        assert process.stderr is not None
        assert process.stderr.read() == ""


def test_a_full_disk_is_named_and_a_paused_reader_holds_nothing_up(robot: ProcessRobot) -> None:
    with Path("/dev/full").open("w", encoding="utf-8") as full, watching(robot, stdout=full) as process:
        assert process.wait(PATIENCE) == 1
        assert process.stderr is not None
        assert process.stderr.read() == "giraff: cannot write to standard output: No space left on device\n"
    with watching(robot, "--json", pipesize=PIPE) as process:
        line = line_that(process, lambda line: '"base"' in line)
        assert process.stdout is not None
        pipe = process.stdout.fileno()

        def is_full() -> bool:
            [unread] = struct.unpack("i", fcntl.ioctl(pipe, termios.FIONREAD, bytes(4)))
            return int(unread) + len(line) > PIPE

        wait(is_full, PATIENCE, what="a pipe that takes no more")
        end(process, signal.SIGINT)

"""`giraff_client` against the simulated robot: the examples as people run them, and a script that hangs or dies."""

from __future__ import annotations

import math
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from giraff_client import EmergencyStopError, NoRobotError, RefusedError, Robot
from giraff_node.session import LEASE as LINK_LEASE
from giraff_schemas.topics import LEASE
from giraff_sim.board import ROOT
from tests.support.process_robot import ProcessRobot, process_robot
from tests.support.waiting import wait
from tests.timing.stalled import by_the_wall

EXAMPLES = ROOT / "examples"
HALL = """
name = "hall"
start = { x = 0.0, y = 0.0, yaw_deg = 4.0 }

[[walls]]
name = "room"
points = [[5.0, 0.85], [-3.0, 0.85], [-3.0, -4.0], [5.0, -4.0]]
closed = true
"""
"""The wall on the left is 0.6 m from the sensors of a robot that faces it."""
STOPS_WITHIN = 0.6
"""s from a script's last word to PWM zero: 0.4 s by the operator's budget, and what a busy machine takes to see it."""


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("hall"), HALL, boards="host") as made:
        made.stop("joystick")
        made.observer.follow(LEASE)
        yield made


@pytest.fixture
def alone(robot: ProcessRobot, monkeypatch: pytest.MonkeyPatch) -> ProcessRobot:
    """The robot that a script of this process finds, at the place from which it starts, driven by nobody."""
    for name, value in robot.environment.items():
        if name.startswith("GIRAFF_"):
            monkeypatch.setenv(name, value)
    robot.wait("nobody who drives", lambda: (lease := robot.observer.newest(LEASE)) is not None and not lease.holder, 5)
    return robot


def example(robot: ProcessRobot, name: str, *words: str) -> str:
    """What an example says."""
    command = [sys.executable, str(EXAMPLES / name), *words]
    done = subprocess.run(
        command, check=False, capture_output=True, text=True, env=robot.environment, cwd=robot.directory, timeout=90.0
    )
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    return done.stdout


def test_it_follows_a_wall_at_half_a_metre(alone: ProcessRobot) -> None:
    """Of the sensors, which are 0.25 m ahead of the robot's centre when it faces the wall."""
    said = example(alone, "follow_wall.py", "3").splitlines()
    assert len(said) == 3
    distances = [float(line.partition(" ")[0]) for line in said]
    print(distances)
    assert distances[-1] == pytest.approx(0.5, abs=0.06), distances
    truth = alone.simulator.state()
    assert truth.x > 0.8
    assert 0.85 - truth.y - 0.25 == pytest.approx(0.5, abs=0.08)


def test_it_patrols_where_the_path_is_free(alone: ProcessRobot) -> None:
    alone.simulator.place(0.0, -2.0)
    said = example(alone, "patrol.py").splitlines()
    assert [line.partition(";")[0] for line in said] == ["at 1, 0", "at 1, 1", "at 0, 1", "at 0, 0"]
    truth = alone.simulator.state()
    assert math.hypot(truth.x, truth.y + 2.0) < 0.3


def test_it_draws_the_path_that_another_drives(alone: ProcessRobot) -> None:
    alone.simulator.place(0.0, -2.0)
    file = alone.directory / "path.svg"
    command = [sys.executable, str(EXAMPLES / "plot_path.py"), "4", str(file)]
    with subprocess.Popen(command, env=alone.environment) as drawing, Robot() as robot:
        for _ in range(60):
            robot.drive(0.2, 0.3)
        assert drawing.wait(20.0) == 0
    points = [point.split(",") for point in file.read_text().split('points="')[1].split('"')[0].split()]
    assert len(points) > 20
    assert math.dist(*[[float(value) for value in point] for point in (points[0], points[-1])]) > 0.15


def test_it_is_one_operator_among_others_and_lets_go_when_it_leaves(alone: ProcessRobot) -> None:
    with Robot(operator="first") as first:
        first.drive(0.0, 0.0)
        with Robot(operator="second") as second, pytest.raises(RefusedError, match="held by first") as refused:
            second.drive(0.2, 0.0)
        assert refused.value.holder == "first"
        first.rest(1.5)  # more than the lease lasts without a word
        first.drive(0.1, 0.0)
    with Robot(operator="second", patience=5.0) as second:
        assert not second.base().armed
        alone.wait("a free robot", lambda: not getattr(alone.observer.newest(LEASE), "holder", ""), 3.0)
        second.drive(0.1, 0.0)
        assert second.base().guard
        assert set(second.ranges()) == {"front_left", "front_right", "rear"}
        for bad in (math.nan, math.inf):
            with pytest.raises(ValueError, match="finite"):
                second.drive(0.1, bad)


def waits_of_links() -> list[int]:
    """For each TCP connection of this process: ms without an acknowledgement after which the kernel ends it."""
    waits = []
    for entry in Path("/proc/self/fd").iterdir():
        with suppress(OSError), socket.socket(fileno=os.dup(int(entry.name))) as link:  # not every one is a connection
            link.getpeername()
            waits.append(link.getsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT))
    return waits


@pytest.mark.usefixtures("alone")
def test_its_links_end_when_they_are_dead() -> None:
    with Robot() as robot:
        robot.rest(1.0)
        waits = waits_of_links()
    assert set(waits) == {LINK_LEASE * 1000}


def test_an_emergency_stop_is_told_and_a_reset_moves_nothing(alone: ProcessRobot) -> None:
    with Robot() as robot:
        robot.drive(0.1, 0.0)
        assert alone.giraff("estop", "engage", "--reason", "a cat") == 0
        with pytest.raises(EmergencyStopError, match="a cat"):
            drive_for(robot, 2.0)
        assert alone.giraff("estop", "reset") == 0
        stopped_us = alone.simulator.now()
        for _ in range(30):
            with pytest.raises(Exception, match=r"robot\.arm"):
                robot.drive(0.1, 0.0)
            robot.stop()
            time.sleep(0.05)
        assert alone.simulator.record(stopped_us).driven_ms == 0
        robot.arm()
        drive_for(robot, 0.5)
        assert alone.drives()


def drive_for(robot: Robot, seconds: float) -> None:
    for _ in range(round(30 * seconds)):  # it keeps its own time
        robot.drive(0.15, 0.0)


SCRIPT = """
import sys, time
from giraff_client import Robot
with Robot() as robot:
    for _ in range(45):
        robot.drive(0.0, 0.6)
    print("driving", flush=True)
    while "{how}" != "hangs":
        robot.drive(0.0, 0.6)
    time.sleep(60.0)
"""


@pytest.mark.parametrize("how", ["hangs", "SIGSTOP", "SIGKILL"])
def test_a_script_that_is_no_more_stops_the_robot(alone: ProcessRobot, how: str) -> None:
    command = [sys.executable, "-c", SCRIPT.format(how=how)]
    with subprocess.Popen(command, env=alone.environment, stdout=subprocess.PIPE, text=True) as script:
        try:
            assert script.stdout is not None
            assert script.stdout.readline() == "driving\n"
            assert alone.drives()
            begin_ns, ended_us = time.monotonic_ns(), alone.simulator.now()
            if how != "hangs":
                os.kill(script.pid, getattr(signal, how))
            alone.run(1.5)
            last = alone.simulator.record(ended_us).last_driven_us
            took = ((last or ended_us) - ended_us) * 1e-6
            print(f"{how}: PWM 0 after {took:.3f} s")
            with by_the_wall(begin_ns):
                assert took <= STOPS_WITHIN
        finally:
            script.kill()


@pytest.mark.usefixtures("alone")
def test_where_there_is_no_robot_it_says_so() -> None:
    with (
        pytest.raises(NoRobotError, match=r"no robot called nobody is heard .*--robot sim-test"),
        Robot("nobody", patience=1.0),
    ):
        pass


def test_guard_stands_between_it_and_the_wall(alone: ProcessRobot) -> None:
    alone.simulator.place(3.6, -2.0)
    with Robot() as robot:

        def at_the_wall() -> bool:
            robot.drive(0.2, 0.0)
            return robot.guard().forward.freedom == "blocked"

        wait(at_the_wall, 40.0, what=alone.why, every=0.0)
        drive_for(robot, 1.0)
    assert alone.simulator.state().x < 5.0 - 0.3

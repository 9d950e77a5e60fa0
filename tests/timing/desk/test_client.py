"""The examples of `giraff_client` to their end, and how soon a script that hangs or dies is no more obeyed."""

import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

from giraff_schemas.topics import LEASE
from tests.support.examples import EXAMPLES, HALL, first_of_the_page
from tests.support.process_robot import ProcessRobot, process_robot
from tests.timing.stalled import by_the_wall

STOPS_WITHIN = 0.6
"""s from a script's last word to PWM zero: 0.4 s by the operator's budget, and what a busy machine takes to see it."""


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("hall"), HALL, boards="host") as made:
        made.stop("joystick")
        made.start("motion")
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
    return output(robot, str(EXAMPLES / name), *words)


def output(robot: ProcessRobot, *words: str) -> str:
    """What a script says that ends by itself."""
    command = [sys.executable, *words]
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


def test_the_first_one_of_its_page_drives_where_the_way_is_free(alone: ProcessRobot) -> None:
    alone.simulator.place(0.0, -2.0)
    said = output(alone, "-c", first_of_the_page())
    assert len(said.splitlines()) == 1, "where it is, and nothing that blocks it"
    assert 0.5 < alone.simulator.state().x < 1.1


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

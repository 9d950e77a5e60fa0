"""`giraff_client` against the simulated robot: the examples as people run them, and a script that hangs or dies.

The robot may be lost at any time, when this machine stands still: then whoever drives arms it again.
"""

import math
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest

from giraff_client import EmergencyStopError, NoRobotError, Robot, RobotError, SilentError, TakenError
from giraff_core.kinematics.pose import Pose
from giraff_core.network import NetworkConfig
from giraff_node.network.session import LEASE as LINK_LEASE
from giraff_node.network.session import close_session, open_session
from giraff_schemas.messages import Odometry
from giraff_schemas.topics import GUARD, LEASE, alive_key
from giraff_tools.network.ports import free_port
from tests.functional.desk.scripts import PATIENCE, example, first_line, is_free
from tests.support.examples import HALL, first_of_the_page
from tests.support.locating import locating
from tests.support.map_poses import LOST
from tests.support.process_robot import ProcessRobot, process_robot
from tests.support.robots import ULTRASONIC
from tests.support.waiting import wait


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ProcessRobot]:
    with process_robot(tmp_path_factory.mktemp("hall"), HALL, boards="host") as made:
        made.stop("joystick")
        made.start("motion")
        made.observer.follow(LEASE)
        yield made


@pytest.fixture(scope="module")
def named(robot: ProcessRobot) -> Iterator[ProcessRobot]:
    """The robot that a script of this process finds."""
    with pytest.MonkeyPatch.context() as patch:
        for name, value in robot.environment.items():
            if name.startswith("GIRAFF_"):
                patch.setenv(name, value)
        yield robot


@pytest.fixture
def alone(named: ProcessRobot) -> ProcessRobot:
    """The same, driven by nobody."""
    named.wait("nobody who drives", lambda: is_free(named), PATIENCE)
    return named


@pytest.fixture(scope="module")
def script(named: ProcessRobot) -> Iterator[Robot]:
    """A script of this process, for the last tests of this file."""
    named.wait("nobody who drives", lambda: is_free(named), PATIENCE)
    with Robot(patience=PATIENCE) as it:
        yield it


def test_where_there_is_no_robot_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another one is there."""
    network = NetworkConfig(rendezvous=f"127.0.0.1:{free_port()}", local=True)
    monkeypatch.setenv("GIRAFF_NETWORK_RENDEZVOUS", network.rendezvous)
    monkeypatch.setenv("GIRAFF_NETWORK_LOCAL", "true")
    session = open_session(network, "sim-test", "door")
    with (
        session.liveliness().declare_token(alive_key("sim-test", "base", "there")),
        pytest.raises(NoRobotError, match=r"no robot called nobody is heard .*--robot sim-test"),
        Robot("nobody", patience=2.0),
    ):
        pass
    assert close_session(session)


def drive_on(robot: Robot, linear_x: float, angular_z: float) -> None:
    """One word of a script that arms the robot again when it has lost it."""
    try:
        robot.drive(linear_x, angular_z)
    except EmergencyStopError:
        raise
    except RobotError:
        time.sleep(0.05)  # one that is not heard is not asked without end
        with suppress(RobotError):
            robot.arm()


def test_it_follows_a_wall(alone: ProcessRobot) -> None:
    """It turns to the wall, 0.6 m from the sensors, and measures."""
    began_us = alone.simulator.now()
    said = first_line(alone, "follow_wall.py", 0.0, 0.0, "1")
    assert said.endswith(" m from the wall\n")
    assert float(said.partition(" ")[0]) == pytest.approx(0.6, abs=0.1)
    assert alone.simulator.record(began_us).driven_ms > 0


def test_it_patrols_where_the_path_is_free(alone: ProcessRobot) -> None:
    """Where a sensor that this machine held up blocks it for a moment, it says so, and goes on."""
    assert first_line(alone, "patrol.py", 0.0, -2.0, begins="at ").startswith("at 1, 0; the guard says: ")
    truth = alone.simulator.state()
    assert math.hypot(truth.x, truth.y + 2.0) == pytest.approx(1.0, abs=0.3)


def test_it_goes_to_a_place_once_it_is_known_where_the_robot_is(alone: ProcessRobot) -> None:
    """Half a metre ahead, on a map in which `odom` looks along y."""
    rendezvous, name = alone.environment["GIRAFF_NETWORK_RENDEZVOUS"], alone.environment["GIRAFF_ROBOT_NAME"]
    with locating(rendezvous, name, Pose(2.0, 1.0, math.pi / 2.0)) as localization:

        def arrives() -> bool:
            """A machine that stands still may have stopped the robot on its way."""
            alone.wait("nobody who drives", lambda: is_free(alone), PATIENCE)
            alone.simulator.place(0.0, -2.0)
            localization.state = "lost"
            wait(lambda: localization.newest is not None, PATIENCE, what="odometry")
            assert localization.newest is not None
            here = Pose(localization.newest.x, localization.newest.y, localization.newest.yaw)
            goal = here.moved(0.5, 0.0).placed_in(localization.odom)
            with example(alone, "go_to_place.py", f"{goal.x},{goal.y}") as process:
                assert process.stdout is not None
                assert process.stdout.readline() == f"lost: {LOST}\n"
                localization.state = "localized"
                said, why = process.communicate()
            if process.returncode:
                assert why
                return False
            assert said.splitlines()[-1].startswith("at ")
            return True

        alone.wait("go_to_place.py", arrives, PATIENCE)
    truth = alone.simulator.state()
    assert math.hypot(truth.x, truth.y + 2.0) == pytest.approx(0.5, abs=0.1)


def is_blocked(robot: ProcessRobot) -> bool | None:
    """Whether the guard lets nothing through ahead; None: it was not heard yet."""
    state = robot.observer.newest(GUARD)
    return None if state is None else state.forward.clearance == "blocked"


def ends_blocked(robot: ProcessRobot) -> bool:
    """Run the first example of the page until it ends by itself; whether that was by an obstacle.

    Otherwise it has lost the robot, and is to be started again.
    """
    robot.wait("nobody who drives", lambda: is_free(robot), PATIENCE)
    command = [sys.executable, "-c", first_of_the_page()]
    streams: dict[str, Any] = {"capture_output": True, "text": True}
    done = subprocess.run(command, check=False, env=robot.environment, timeout=PATIENCE, **streams)
    assert done.returncode == 0 or "giraff_client.errors." in done.stderr, done.stderr
    return "\nforward blocked: front_" in done.stdout


def test_the_first_example_of_its_page_ends_before_a_wall(alone: ProcessRobot) -> None:
    def drives_and_ends() -> bool:
        alone.simulator.place(4.2, -2.0)
        alone.wait("a free way", lambda: is_blocked(alone) is False, PATIENCE)
        return ends_blocked(alone) and alone.simulator.state().x > 4.25

    alone.wait("its end at the wall", drives_and_ends, PATIENCE)
    assert alone.simulator.state().x < 5.0 - 0.3


def test_it_ends_in_a_corner_and_moves_nothing(alone: ProcessRobot) -> None:
    alone.simulator.place(4.6, -3.6)
    alone.wait("a blocked way", lambda: is_blocked(alone), PATIENCE)
    began_us = alone.simulator.now()
    alone.wait("its end in the corner", lambda: ends_blocked(alone), PATIENCE)
    assert alone.simulator.record(began_us).driven_ms == 0


@contextmanager
def held_by(robot: Robot) -> Iterator[None]:
    """A script goes on meanwhile, and stands still."""
    ended = threading.Event()

    def go_on() -> None:
        while not ended.is_set():
            drive_on(robot, 0.0, 0.0)

    thread = threading.Thread(target=go_on)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def test_it_is_one_operator_among_others_and_lets_go_when_it_leaves(alone: ProcessRobot) -> None:
    def is_refused() -> bool:
        with Robot(operator="second", patience=PATIENCE) as second:
            try:
                second.drive(0.2, 0.0)
            except TakenError as refused:
                return refused.holder == "first" and "held by first" in str(refused)
            except RobotError:
                return False
        return False

    with Robot(operator="first", patience=PATIENCE) as first, held_by(first):
        wait(is_refused, PATIENCE, what="the second is not refused")
    alone.wait("a free robot", lambda: is_free(alone), PATIENCE)
    with Robot(operator="second", patience=PATIENCE) as second:
        second.arm()
        assert second.base().guard
        assert set(second.ranges()) == {"front_left", "front_right", "rear"}
        for bad in (math.nan, math.inf):
            with pytest.raises(ValueError, match="finite"):
                second.drive(0.1, bad)


SCRIPT = """
import signal, time
from giraff_client import Robot, RobotError
signal.signal(signal.SIGUSR1, lambda *_: time.sleep(600.0))
with Robot(patience=60.0) as robot:
    while True:
        try:
            robot.drive(0.0, 0.6)
        except RobotError:
            time.sleep(0.05)
            try:
                robot.arm()
            except RobotError:
                pass
"""
"""Drives as long as it lives; SIGUSR1 makes it hang."""


@pytest.mark.parametrize("how", [signal.SIGUSR1, signal.SIGKILL], ids=["hangs", "dies"])
def test_a_script_that_is_no_more_stops_the_robot(alone: ProcessRobot, how: signal.Signals) -> None:
    with subprocess.Popen([sys.executable, "-c", SCRIPT], env=alone.environment) as script:
        try:
            alone.wait("a script that drives", alone.drives, PATIENCE)
            os.kill(script.pid, how)
            alone.wait("standstill", lambda: not alone.drives(), PATIENCE)
            alone.run(0.5)  # until nothing that it has said is on its way any more
            ended_us = alone.simulator.now()
            alone.run(0.8)
            assert alone.simulator.record(ended_us).driven_ms == 0
        finally:
            script.kill()


def waits_of_links() -> list[int]:
    """For each TCP connection of this process: ms without an acknowledgement after which the kernel ends it."""
    waits = []
    for entry in Path("/proc/self/fd").iterdir():
        with suppress(OSError), socket.socket(fileno=os.dup(int(entry.name))) as link:  # not every one is a connection
            link.getpeername()
            waits.append(link.getsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT))
    return waits


def test_its_links_end_when_they_are_dead(script: Robot) -> None:
    def are_all_tuned() -> bool:
        drive_on(script, 0.0, 0.0)
        return set(waits_of_links()) == {LINK_LEASE * 1000}

    wait(are_all_tuned, PATIENCE, what="a link of another wait")


def test_it_knows_where_a_sensor_was(script: Robot) -> None:
    then = script.odom()
    rear = ULTRASONIC["rear"]
    found = script.wait_for("odom", "range_rear_link", then.tick, timeout=PATIENCE)
    assert (found.parent, found.child, found.tick) == ("odom", "range_rear_link", then.tick)
    assert math.dist((found.x, found.y), (then.x, then.y)) == pytest.approx(-rear.x, abs=0.02)
    assert script.lookup("base_link", "range_rear_link").x == pytest.approx(rear.x)


def test_it_draws_the_path_that_another_drives(named: ProcessRobot, script: Robot) -> None:
    def draws_a_way() -> bool:
        """A machine that stands still may have stopped the robot for all of these seconds."""
        named.simulator.place(3.0, -2.0)  # both sensors at the front hear the wall, as where it comes from
        with example(named, "plot_path.py", "2", "path.svg") as drawing:
            while drawing.poll() is None:
                drive_on(script, 0.2, 0.3)
            assert drawing.returncode == 0, drawing.communicate()
        drawn = (named.directory / "path.svg").read_text().split(' d="M')[1].split('"')[0].split()
        points = [[float(value) for value in point.split(",")] for point in drawn]
        assert len(points) > 1
        return max(math.dist(points[0], point) for point in points) > 0.1

    script.arm()
    wait(draws_a_way, PATIENCE, what="a path that is drawn")


def test_guard_stands_between_it_and_the_wall(named: ProcessRobot, script: Robot) -> None:
    named.simulator.place(3.9, -2.0)

    def at_the_wall() -> bool:
        drive_on(script, 0.2, 0.0)
        with suppress(RobotError):
            return script.guard().forward.clearance == "blocked"
        return False

    wait(at_the_wall, PATIENCE, what=named.why, every=0.0)
    until_us = named.simulator.now() + 1_000_000
    while named.simulator.now() < until_us:
        drive_on(script, 0.2, 0.0)
    assert named.simulator.state().x < 5.0 - 0.3


def test_an_emergency_stop_is_told_and_a_reset_moves_nothing(named: ProcessRobot, script: Robot) -> None:
    named.simulator.place(0.0, -2.0)

    def drives() -> bool:
        drive_on(script, 0.1, 0.0)
        return named.drives()

    def is_told() -> bool:
        try:
            drive_on(script, 0.1, 0.0)
        except EmergencyStopError as told:
            return "a cat" in str(told)
        return False

    wait(drives, PATIENCE, what=named.why)
    assert named.giraff("estop", "engage", "--reason", "a cat") == 0
    wait(is_told, PATIENCE, what="the stop")
    assert named.giraff("estop", "reset") == 0
    stopped_us = named.simulator.now()
    for _ in range(30):
        with pytest.raises(RobotError, match=r"robot\.arm|no tick"):
            script.drive(0.1, 0.0)
        script.stop()
        time.sleep(0.05)
    assert named.simulator.record(stopped_us).driven_ms == 0
    script.arm()
    wait(drives, PATIENCE, what=named.why)


def newest_odom(script: Robot) -> Odometry:
    """What a script reads, once this machine lets it."""
    found: list[Odometry] = []

    def is_heard() -> bool:
        with suppress(SilentError):
            found[:] = [script.odom()]
        return bool(found)

    wait(is_heard, PATIENCE, what="odom")
    return found[0]


def test_odometry_is_told_where_the_robot_is(named: ProcessRobot, script: Robot) -> None:
    """By the command with numbers as they are typed, and by a script, which reads what it has set."""
    script.stop()  # the test before this one leaves it as it begins to drive, which looks like standing
    named.wait("standstill", lambda: abs(newest_odom(script).linear_x) < 0.001, PATIENCE)
    before = newest_odom(script)
    script.set_odom(2.0, -3.0, 7.0, 0.1, 0.2)
    now = newest_odom(script)
    assert now.jumps == before.jumps + 1
    assert (now.x, now.y, now.yaw) == pytest.approx((2.0, -3.0, 7.0 - math.tau), abs=0.01)
    assert now.path >= before.path
    assert (now.covariance[0], now.covariance[5]) == pytest.approx((0.01, 0.04), abs=0.001)

    assert named.giraff("odom", "set", "-1,0,-90deg", "--timeout", "60") == 0
    named.wait("odometry there", lambda: newest_odom(script).jumps == before.jumps + 2, PATIENCE)
    there = newest_odom(script)
    assert (there.x, there.y, there.yaw) == pytest.approx((-1.0, 0.0, -math.pi / 2), abs=0.01)
    assert named.giraff("odom", "set", "1e9,0,0deg", "--timeout", "60") == 1
    assert named.giraff("odom", "reset", "--timeout", "60") == 0
    named.wait("odometry anew", lambda: newest_odom(script).jumps == before.jumps + 3, PATIENCE)
    anew = newest_odom(script)
    assert (anew.x, anew.y, anew.yaw, anew.path) == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=0.01)
    script.reset_odom()
    assert newest_odom(script).jumps == before.jumps + 4


def test_where_no_odometry_runs_it_is_told(named: ProcessRobot) -> None:
    named.kill("odometry")
    assert named.giraff("odom", "reset", "--timeout", "1") == 2
    with Robot(patience=PATIENCE) as robot:
        robot._patience = 1.0  # which was for the robot to be found
        with pytest.raises(RobotError, match=r"check that giraff_odometry runs|no tick of the robot"):
            robot.reset_odom()
    named.start("odometry")

"""The robot in a real ROS 2: rclpy on rmw_zenoh_cpp sees it, reads it, drives it and stops it.

Judged by the simulated world and by the robot's own samples.
"""

import json
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, Final

import pytest

from giraff_schemas.messages import Sample
from giraff_schemas.topics import BASE, BATTERY, ESTOP, ODOM, RANGE, TILT, TRUE_POSE, Topic
from giraff_tools.network.ports import free_port
from tests.campaign.ros2 import prepare
from tests.support.observer import Observer
from tests.support.process_robot import PATIENCE
from tests.support.report import report
from tests.support.runs import SMALL_ROOM, command_in, line_of
from tests.support.waiting import wait

READ: Final = 10.0  # s
ODOMETRY: Final = "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"
"""Hash of nav_msgs/msg/Odometry, as real ROS has it."""
SAID: Final[dict[str, tuple[Topic[Any], float, Callable[[Any], list[float]]]]] = {
    "/odom": (ODOM, 2.0, lambda it: [it.x, it.y, it.linear_x]),  # it is said twice as often
    "/range/front_left": (RANGE.at("front_left"), 1.0, lambda it: [math.inf if it.range is None else it.range]),
    "/battery_state": (BATTERY, 1.0, lambda it: [it.voltage]),
    "/hand/imu": (TILT, 1.0, lambda it: [it.x, it.y, it.z]),
}
"""Topics of ROS: which of ours each one is, how many of ours for each, and the values."""


class Robot:
    """A whole robot in ROS, and a real ROS node."""

    def __init__(self, observer: Observer, node: subprocess.Popen[str]) -> None:
        self.observer, self.node = observer, node
        self.said: dict[str, dict[int, list[float]]] = {name: {} for name in SAID}
        """By topic and stamp."""
        for topic in (BASE, ESTOP, TRUE_POSE):
            observer.follow(topic)
        for name, (own, _, values) in SAID.items():
            observer.listen(own, partial(self._keep, name, values))

    def _keep(self, name: str, values: Callable[[Any], list[float]], sample: Sample) -> None:
        self.said[name][sample.stamp_ns] = values(sample)

    def ros(self, words: str) -> Any:
        """Tell the node something, and return what it says."""
        self.tell(words)
        return self.answer()

    def tell(self, words: str) -> None:
        assert self.node.stdin is not None
        self.node.stdin.write(f"{words}\n")
        self.node.stdin.flush()

    def answer(self) -> Any:
        assert self.node.stdout is not None
        return json.loads(self.node.stdout.readline())

    def way(self, seconds: float) -> float:
        """Return how far the robot is after a time from where it was, or was in between, m."""
        began, most = self.observer.newest(TRUE_POSE), 0.0
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            pose = self.observer.newest(TRUE_POSE)
            assert began is not None
            assert pose is not None
            most = max(most, math.dist((pose.x, pose.y), (began.x, began.y)))
            time.sleep(0.05)
        return most

    def is_armed(self) -> bool:
        base = self.observer.newest(BASE)
        return base is not None and base.armed

    def takes(self) -> None:
        """Take the robot by one message, as a key does, and rest until it is armed."""
        self.ros("drive 0.2 0")
        wait(self.is_armed, PATIENCE, what=lambda: f"armed: {self.observer.newest(BASE)}")


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Robot]:
    try:
        prepare.main(prepare.HERE)
    except (OSError, subprocess.CalledProcessError) as error:
        pytest.fail(f"no real ROS 2 can be made here: {error}")
    directory = tmp_path_factory.mktemp("ros2")
    (directory / "world.toml").write_text(SMALL_ROOM)
    port = free_port()
    options = ("--hand", "none", "--boards", "host", "--world", "world.toml", "--localize", "--camera")
    reach = {"ZENOH_CONFIG_OVERRIDE": f'connect/endpoints=["tcp/127.0.0.1:{port}"]'}
    words = [str(prepare.HERE / "venv" / "bin" / "python"), str(Path(__file__).parent / "ros2" / "node.py")]
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with command_in(directory) as command, command.start(*options, local=False) as run:
        line_of(run, " | ")
        observer = Observer(command.environment)
        given = command.environment | {"GIRAFF_ROS2_ROUTER": f"127.0.0.1:{port}"}
        with (
            (directory / "ros2.log").open("w") as log,
            subprocess.Popen([sys.executable, "-m", "giraff_node", "ros2"], env=given, stderr=log) as bridge,
        ):
            wait(lambda: "in ROS's shell" in (directory / "ros2.log").read_text(), PATIENCE, what="the robot in ROS")
            environment = os.environ | prepare.environment() | reach
            with subprocess.Popen(words, env=environment, **pipes) as node:
                yield Robot(observer, node)
                node.kill()
            bridge.terminate()
        observer.close()
        run.terminate()


def test_it_is_listed_with_types_hash_and_qos(robot: Robot) -> None:
    wait(lambda: "giraff" in robot.ros("graph")["nodes"], PATIENCE)
    graph = robot.ros("graph")
    assert graph["topics"]["/odom"] == ["nav_msgs/msg/Odometry"]
    assert sorted(graph["topics"]["/cmd_vel"]) == ["geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"]
    assert graph["topics"]["/tf"] == graph["topics"]["/tf_static"] == ["tf2_msgs/msg/TFMessage"]
    assert graph["services"]["/giraff/estop"] == ["std_srvs/srv/Trigger"]
    [(node, kind, type_hash, reliability)] = graph["odom"]
    assert (node, kind, type_hash, reliability) == ("giraff", "nav_msgs/msg/Odometry", ODOMETRY, "RELIABLE")


def test_what_is_read_is_what_the_robot_said(robot: Robot) -> None:
    heard = robot.ros(f"read {READ}")
    report("campaign/ros2", {name: len(messages) / READ for name, messages in heard.items()})
    assert all(heard.values()), {name for name, messages in heard.items() if not messages}
    assert "<robot" in heard["/robot_description"][0][2][0]
    assert heard["/giraff/estop_engaged"][0][2] == [False]
    assert heard["/map"][0][2] == [True, 100]
    assert heard["/camera/head/compressed"][0][2] == ["jpeg", 0xFF, 0xD8]
    for name, (_, share, _) in SAID.items():
        for _, stamp, values in heard[name]:
            assert values == pytest.approx(robot.said[name][stamp], rel=1e-6), name
        times, own = [at for at, _, _ in heard[name]], sorted(robot.said[name])
        rate, said = (len(times) - 1) / (times[-1] - times[0]), (len(own) - 1) / (own[-1] - own[0]) * 1e9
        assert rate == pytest.approx(said / share, rel=0.02), name


@pytest.mark.parametrize("hz", [20.0, 3.0])
def test_it_drives_by_a_stream_and_by_single_messages(robot: Robot, hz: float) -> None:
    robot.takes()
    time.sleep(1.5)
    robot.ros(f"drive 0.2 {hz}")
    assert robot.way(2.0) > 0.1
    robot.ros(f"drive -0.2 {hz}")
    assert robot.way(3.0) > 0.1
    robot.ros("drive 0 0")
    time.sleep(1.0)
    assert robot.way(1.0) < 0.002


def test_a_frozen_process_that_wakes_moves_nothing(robot: Robot) -> None:
    robot.takes()
    time.sleep(1.5)
    robot.ros("drive 0.2 20")
    assert robot.way(1.0) > 0.05
    robot.node.send_signal(signal.SIGSTOP)
    time.sleep(5.0)
    assert robot.way(0.5) < 0.002
    robot.node.send_signal(signal.SIGCONT)
    assert robot.way(5.0) < 0.002
    robot.ros("drive 0 0")


def test_a_goal_of_now_is_driven_to_and_one_of_a_frozen_process_is_not(robot: Robot) -> None:
    began = robot.observer.newest(TRUE_POSE)
    assert began is not None
    robot.ros(f"goal {began.x + 0.4}")
    assert robot.way(8.0) > 0.1
    robot.node.send_signal(signal.SIGSTOP)
    robot.tell(f"goal {began.x}")
    time.sleep(5.0)
    robot.node.send_signal(signal.SIGCONT)
    robot.answer()
    before = robot.observer.newest(TRUE_POSE)
    assert robot.way(5.0) < 0.002
    after = robot.observer.newest(TRUE_POSE)
    assert (before is not None and before.yaw) == pytest.approx(after is not None and after.yaw, abs=0.01)


def test_its_emergency_stop_is_called(robot: Robot) -> None:
    success, message = robot.ros("call")
    assert success, message
    wait(lambda: (it := robot.observer.newest(ESTOP)) is not None and it.engaged, PATIENCE, what="the stop")
    wait(lambda: not robot.is_armed(), PATIENCE)
    assert robot.ros("read 1")["/giraff/estop_engaged"][-1][2] == [True]

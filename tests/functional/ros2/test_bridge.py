"""A whole robot in ROS: others' code reads it and stops it, and what a frozen process says when it wakes moves nothing.

Judged by the simulated world.
"""

import json
import math
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from giraff_schemas.messages import TruePose
from giraff_schemas.topics import BASE, ESTOP, TRUE_POSE
from giraff_sim.board import ROOT
from giraff_tools.network.ports import free_port
from tests.support.observer import Observer
from tests.support.process_robot import PATIENCE
from tests.support.runs import SMALL_ROOM, command_in, line_of
from tests.support.waiting import wait

FROZEN_NS = 2_000_000_000
WATCHED_NS = 1_000_000_000
"""More than twice as long as a robot that obeys needs to set off."""
SPEED = 0.2
RIM = 0.3
"""m. Radius of the robot."""
STILL = 0.002
"""m. The robot stands."""


class Ros:
    """A ROS process that obeys the lines it is given."""

    def __init__(self, script: str, port: int) -> None:
        self.process = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name(script)), str(port)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=ROOT,
        )

    def tell(self, line: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n")
        self.process.stdin.flush()

    def read(self) -> str:
        assert self.process.stdout is not None
        return self.process.stdout.readline()

    def sends(self, speed: float, messages: int) -> None:
        """Wait until it has sent that many more of them."""
        for _ in range(messages):
            while float(self.read().split()[1]) != speed:
                pass


@contextmanager
def ros(script: str, port: int) -> Iterator[Ros]:
    made = Ros(script, port)
    try:
        yield made
    finally:
        made.process.kill()
        made.process.communicate()


class Truth:
    """Where the robot is, by the world."""

    def __init__(self, observer: Observer) -> None:
        self._observer = observer
        for topic in (BASE, ESTOP, TRUE_POSE):
            observer.follow(topic)

    def now(self) -> TruePose:
        """Return a pose that is said from now on."""
        before = self._observer.newest(TRUE_POSE)
        wait(lambda: self._observer.newest(TRUE_POSE) is not before, PATIENCE, what="the truth")
        pose = self._observer.newest(TRUE_POSE)
        assert pose is not None
        return pose

    def way(self, robot_ns: int) -> float:
        """Return the way of the robot in that time, m; a turn counts as the way of its rim."""
        began = last = self.now()
        way = 0.0
        while last.tick.robot_ns - began.tick.robot_ns < robot_ns:
            pose = self.now()
            turned = math.remainder(pose.yaw - last.yaw, math.tau)
            way += math.dist((pose.x, pose.y), (last.x, last.y)) + abs(turned) * RIM
            last = pose
        return way


def goals(truth: Truth, rviz: Ros) -> None:
    """Let it give a goal that it held back while it was frozen, which moves nothing, and one of now."""
    rviz.tell("silent")
    truth.way(FROZEN_NS)
    os.kill(rviz.process.pid, signal.SIGSTOP)
    rviz.tell(f"goal {truth.now().x - 1.0}")
    truth.way(WATCHED_NS)
    os.kill(rviz.process.pid, signal.SIGCONT)
    assert truth.way(WATCHED_NS) < STILL

    def goes() -> bool:
        rviz.tell(f"goal {truth.now().x - 1.0}")
        return truth.way(3 * WATCHED_NS // 2) > 0.1

    wait(goes, PATIENCE, what="a goal of now")


def test_ros_sees_it_drives_it_and_stops_it_and_a_process_that_wakes_moves_nothing(tmp_path: Path) -> None:
    (tmp_path / "world.toml").write_text(SMALL_ROOM)
    port = free_port()
    with command_in(tmp_path) as command, ExitStack() as end:
        options = ("--hand", "none", "--boards", "host", "--world", "world.toml")
        run = end.enter_context(command.start(*options, local=False))
        end.callback(run.terminate)
        line_of(run, " | ")
        observer = Observer(command.environment)
        end.callback(observer.close)
        truth = Truth(observer)
        environment = command.environment | {"GIRAFF_ROS2_ROUTER": f"127.0.0.1:{port}"}
        log = end.enter_context((tmp_path / "ros2.log").open("w"))
        words = [sys.executable, "-m", "giraff_node", "ros2"]
        bridge = end.enter_context(subprocess.Popen(words, env=environment, stderr=log))
        end.callback(bridge.terminate)
        wait(lambda: "in ROS's shell" in (tmp_path / "ros2.log").read_text(), PATIENCE, what="the robot in ROS")

        reader = end.enter_context(ros("reader.py", port))
        (description,) = json.loads(reader.read())["description"]
        assert "<robot" in description
        odometry = json.loads(reader.read())["odometry"]
        assert len(odometry) >= 20
        assert {frame for _, frame, _ in odometry} == {"odom"}

        def state(name: str) -> bool:
            base = observer.newest(BASE)
            return base is not None and bool(getattr(base, name))

        stream = end.enter_context(ros("stream.py", port))

        def drives() -> bool:
            """Take the robot by a message that moves, rest, and drive, as a person does."""
            for speed, messages in ((SPEED, 5), (0.0, 20), (SPEED, 15)):
                stream.tell(str(speed))
                stream.sends(speed, messages)
            return state("armed") and truth.way(400_000_000) > 0.02

        wait(drives, PATIENCE, what=lambda: f"a drive by ROS: {observer.newest(BASE)}")
        os.kill(stream.process.pid, signal.SIGSTOP)
        truth.way(FROZEN_NS)
        assert not state("driving")
        stood = truth.now()
        os.kill(stream.process.pid, signal.SIGCONT)
        stream.sends(SPEED, 20)
        assert truth.way(WATCHED_NS) < STILL
        woke = truth.now()
        assert math.dist((woke.x, woke.y), (stood.x, stood.y)) < STILL
        wait(drives, PATIENCE, what=lambda: f"a drive after the hand has rested: {observer.newest(BASE)}")

        goals(truth, stream)

        reader.tell("")
        answer = json.loads(reader.read())
        assert answer["success"], answer
        estop = observer.newest(ESTOP)
        assert estop is not None
        assert (estop.engaged, "ros2" in estop.by) == (True, True)
        wait(lambda: not state("armed"), PATIENCE, what="the stop")
        assert truth.way(WATCHED_NS) < 0.2
        assert truth.way(WATCHED_NS) < STILL

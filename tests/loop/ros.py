"""ROS around the robot in simulated time: `giraff_ros2` itself, and ROS programs that publish, freeze, wake and end."""

import math
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rosbags.typesys.stores.ros2_kilted import builtin_interfaces__msg__Time as Time
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Point as Point
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Pose as Pose
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__PoseStamped as PoseStamped
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Quaternion as Quaternion
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Twist as Twist
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Vector3 as Vector3
from rosbags.typesys.stores.ros2_kilted import std_msgs__msg__Header as Header

from giraff_core.timer import Timer
from giraff_ros2.answers import Answers
from giraff_ros2.config import Ros2Config
from giraff_ros2.port import Received, Refused, RosPublisher
from giraff_ros2.service import Ros2
from giraff_ros2.topics import CMD_VEL, GOAL_POSE, RosTopic
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_sim.hosts.process import Process
from tests.loop.loops import SeenRobot
from tests.loop.motions import Stage, stage
from tests.support.robots import ROBOT

_AHEAD_NS = 1_700_000_000_000_000_000
"""The clock of ROS programs has nothing to do with the robot's."""


class Answer:
    """A call of the stop, and what it was answered."""

    def __init__(self) -> None:
        self.success: bool | None = None
        self.message = ""

    def answer(self, success: bool, message: str) -> None:
        self.success, self.message = success, message


class Program:
    """A ROS program with one publisher."""

    def __init__(self, name: str, topic: RosTopic = CMD_VEL) -> None:
        self.publisher = RosPublisher(name.ljust(16, "\0").encode(), f"/{name}", name, topic)
        self.answers = Answers()
        self.unanswered: deque[float] = deque()
        """Questions that wait until it runs."""
        self.asks: tuple[float, float] | None = None
        """m/s and rad/s that it publishes 20 times a second; None: nothing."""
        self.is_frozen = False
        self.held: deque[tuple[float, float, float]] = deque()
        """What a frozen one has said and not sent: when, and what."""


class RosDesk:
    """A ROS network as the service sees it, which asks each process, and has each answer 0.15 s later."""

    def __init__(self) -> None:
        self.programs: list[Program] = []
        self.published: dict[str, Any] = {}
        """The newest message of each topic."""
        self.counts: dict[str, int] = {}
        self.called: deque[Answer] = deque()
        self.rviz = Program("rviz", GOAL_POSE)
        self.clicks: deque[tuple[float, float, float]] = deque()
        """m, m and rad of goals that rviz publishes once it runs, with the time of then."""
        self.now = 0.0
        self._heard: deque[Received | Refused] = deque()

    def say(self, program: Program, linear: float, angular: float, sent: float) -> None:
        twist = Twist(Vector3(linear, 0.0, 0.0), Vector3(0.0, 0.0, angular))
        sent_ns = _AHEAD_NS + round(sent * 1e9)
        self._heard.append(Received(CMD_VEL, twist, program.publisher.gid, sent_ns, self.now))

    def say_torn(self, topic: RosTopic) -> None:
        self._heard.append(Refused(topic, Trouble(f"a message on /{topic.name} was refused")))

    def give_goal(self, x: float, y: float, yaw: float, frame: str = "odom", *, held_for: float = 0.0) -> None:
        """Let a goal come. `held_for`: s for which the network has held it."""
        turned = Quaternion(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
        goal = PoseStamped(Header(Time(0, 0), frame), Pose(Point(x, y, 0.0), turned))
        sent_ns = _AHEAD_NS + round((self.now - held_for) * 1e9)
        self._heard.append(Received(GOAL_POSE, goal, self.rviz.publisher.gid, sent_ns, self.now))

    def turn(self, now: float, *, asks: bool) -> None:
        """Let 10 ms pass. `asks`: the programs are asked, and publish."""
        if not self.now:  # rviz has been awake for long enough
            for back in range(30, 0, -1):
                self.rviz.answers.on_question(now - 0.05 * back)
                self.rviz.answers.on_answer(now - 0.05 * back, now - 0.05 * back)
        self.now = now
        for program in (self.rviz, *self.programs):
            if asks:
                program.answers.on_question(now)
                program.unanswered.append(now)
            if program.is_frozen:
                continue
            while program.held:
                sent, linear, angular = program.held.popleft()
                self.say(program, linear, angular, sent)
            while program is self.rviz and self.clicks:
                self.give_goal(*self.clicks.popleft())
            while program.unanswered and program.unanswered[0] <= now - 0.15:
                program.answers.on_answer(program.unanswered.popleft(), now)
            if asks and program.asks is not None:
                self.say(program, *program.asks, now)

    def descriptor(self) -> int | None:
        return None

    def publish(self, topic: RosTopic, message: Any) -> None:
        self.published[topic.name] = message
        self.counts[topic.name] = self.counts.get(topic.name, 0) + 1

    def pop_all(self) -> Iterator[Received | Refused]:
        while self._heard:
            yield self._heard.popleft()

    def calls(self) -> Iterator[Answer]:
        while self.called:
            yield self.called.popleft()

    def publishers(self) -> list[RosPublisher]:
        return [program.publisher for program in (self.rviz, *self.programs)]

    def is_wanted(self, topic: RosTopic) -> bool:
        return not topic

    def answers(self, process: str) -> Answers:
        return next(each.answers for each in (self.rviz, *self.programs) if each.publisher.process == process)

    def wall_ns(self) -> int:
        return _AHEAD_NS + round(self.now * 1e9)

    def trouble(self) -> Trouble:
        return NO_TROUBLE


class _Programs:
    """What lets the ROS programs run."""

    link = None

    def __init__(self, ros: "RosStage") -> None:
        self._ros = ros
        self._fast, self._slow = self.timers = Timer(100.0), Timer(20.0)

    def turn(self, now: float) -> None:
        if self._fast.due(now):
            self._ros.desk.turn(now, asks=self._slow.due(now))
            if "ros2" in self._ros.loop.processes:
                self._ros.loop.processes["ros2"].wake()

    def end(self) -> None:
        """Nothing is left to say."""


class RosStage(SeenRobot):
    """A robot at rest, with giraff_motion, and nobody but ROS to drive it."""

    def __init__(self, on: Stage) -> None:
        super().__init__(on.loop)
        self.stage = on
        self.desk = RosDesk()
        self.start()
        self.loop.launch("programs", lambda _: _Programs(self), self.loop.hosts["operator"])
        self.run(0.3)

    def start(self) -> None:
        """Begin the service, or begin it anew."""
        self.loop.launch("ros2", self._make, self.loop.hosts["operator"])

    def add(self, name: str) -> Program:
        """Begin a program, as long as it takes until it is known."""
        program = Program(name)
        self.desk.programs.append(program)
        self.run(0.2)
        return program

    def press(self, program: Program, linear: float, angular: float = 0.0) -> None:
        """Press a key of teleop_twist_keyboard, and look for as long as it asks for."""
        self.desk.say(program, linear, angular, self.desk.now)
        self.run(0.4)

    def drive(self, program: Program) -> None:
        """Arm the robot as teleop_twist_keyboard does, and drive ahead for 0.6 s."""
        self.press(program, 0.3)
        self.run(0.6)
        assert (self.driver, self.armed) == ("ros2", True), self.why
        program.asks = (0.3, 0.0)
        self.run(0.6)
        assert self.stage.driven_ms(self.now - 0.1) > 90, self.why

    @property
    def why(self) -> str:
        newest = self.loop.newest
        return f"{newest['lease'].reason}; {newest['guard'].reason}; {newest['base'].reason}"

    @property
    def said(self) -> str:
        """Reason of the newest command of ROS's hand."""
        return str(self.loop.newest["cmd_vel/ros2"].reason)

    @property
    def at(self) -> tuple[float, float, float]:
        """Where the robot truly is: m, m, rad."""
        x, y, yaw = self.loop.simulation.world.plant.pose
        return x, y, yaw

    def _make(self, process: Process) -> Ros2:
        return Ros2(process, Ros2Config(), ROBOT, self.desk)


@contextmanager
def ros_stage() -> Iterator[RosStage]:
    with stage() as on:
        yield RosStage(on)

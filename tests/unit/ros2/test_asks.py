"""The emergency stop and goals that ROS asks for, by calling."""

import math
from collections import deque
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest
from rosbags.typesys.stores.ros2_kilted import builtin_interfaces__msg__Time as Time
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Point as Point
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Pose as Pose
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__PoseStamped as PoseStamped
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Quaternion as Quaternion
from rosbags.typesys.stores.ros2_kilted import std_msgs__msg__Header as Header

from giraff_ros2.answers import Answers
from giraff_ros2.goal import Goals
from giraff_ros2.port import Received
from giraff_ros2.service import StopCalls
from giraff_ros2.topics import GOAL_POSE
from giraff_schemas.localization import MapPose, PlanarPose
from giraff_schemas.messages import EStop, Odometry, RobotTime, Sample, Tick
from giraff_schemas.motion import NOWHERE, GoTo, MotionAnswer, MotionCancel, MotionGo, MotionState, Turn
from giraff_schemas.requests import EStopAnswer
from giraff_schemas.topics import Query, Topic
from giraff_schemas.trouble import Trouble


class Asked:
    """A request, which is answered once a test has put an answer here."""

    def __init__(self, key: str, request: msgspec.Struct, settles: Callable[[Any], bool | str]) -> None:
        self.key, self.request, self._settles = key, request, settles
        self.answers: deque[Any] = deque()
        self.fault, self.attempts, self.refusal = "", 0, None

    def poll(self, now: float) -> Any:
        del now
        self.attempts += 1
        while self.answers:
            answer = self.answers.popleft()
            if self._settles(answer) is True:
                return answer
        return None


class Robot:
    """What the service has of its `IO`: what it asks and holds is kept."""

    instance = "me"
    is_open = False

    def __init__(self) -> None:
        self.asked: list[Asked] = []
        self.held: list[Any] = []
        self.held_on: set[str] = set()

    def ask(self, query: Query[Any, Any], request: msgspec.Struct, settles: Callable[[Any], bool | str]) -> Asked:
        self.asked.append(Asked(query.key, request, settles))
        return self.asked[-1]

    def publisher(self, topic: Topic[Any]) -> SimpleNamespace:
        def put(hold: Any) -> None:
            self.held.append(hold)
            self.held_on.add(topic.key)

        return SimpleNamespace(put=put)

    def token(self) -> int:
        return len(self.asked) + 7


class Call:
    def __init__(self) -> None:
        self.answers: list[tuple[bool, str]] = []

    def answer(self, success: bool, message: str) -> None:
        self.answers.append((success, message))


def estop(*, engaged: bool, latch: int = 3) -> EStop:
    return EStop(instance="base", engaged=engaged, id=latch, by="somebody")


@pytest.fixture
def rviz() -> "Rviz":
    return Rviz()


def test_all_calls_that_wait_are_one_stop_and_are_answered_when_base_has_confirmed() -> None:
    robot, calls = Robot(), [Call(), Call()]
    stops = StopCalls(robot, "ros2@desk")  # type: ignore[arg-type]  # what it needs of it
    for call in calls:
        stops.on_call(call, 0.0)
    stops.poll(0.1)
    assert stops.asked
    (request,) = robot.asked
    confirmed = EStopAnswer(done=True, engaged=True, id=3, instance="base")
    request.answers.append(confirmed)
    stops.poll(0.2)
    assert not any(call.answers for call in calls)  # anybody may answer: base itself has not said so
    stops.on_estop(estop(engaged=True))
    request.answers.append(confirmed)
    stops.poll(0.3)
    answers = [answer for call in calls for answer in call.answers]
    assert [success for success, _ in answers] == [True, True]
    assert all("base has confirmed" in message for _, message in answers)


def test_a_call_that_base_does_not_confirm_is_answered_and_the_stop_is_asked_for_all_the_same() -> None:
    robot, call = Robot(), Call()
    stops = StopCalls(robot, "ros2@desk")  # type: ignore[arg-type]  # what it needs of it
    stops.on_call(call, 0.0)
    stops.poll(2.9)
    assert not call.answers
    stops.poll(3.0)
    ((success, message),) = call.answers
    assert not success
    assert "NOT CONFIRMED" in message
    assert stops.asked
    for _ in range(20):
        stops.on_call(call, 4.0)
    assert call.answers[1:] == [(False, "16 calls wait for base's word already")] * 4


def test_a_change_of_the_stop_is_told_once_and_nothing_before_base_was_heard() -> None:
    stops = StopCalls(Robot(), "ros2@desk")  # type: ignore[arg-type]  # what it needs of it
    assert stops.news() is None
    for engaged in (False, True):
        stops.on_estop(estop(engaged=engaged))
        assert stops.news() is engaged
        stops.on_estop(estop(engaged=engaged))
        assert stops.news() is None


class Rviz:
    """A robot at a pose, and whoever gives it goals."""

    def __init__(self, x: float = 1.0, y: float = 0.0, yaw: float = 0.0) -> None:
        self.robot, self.now = Robot(), 0.0
        self.goals = Goals(self.robot, "ros2@desk")  # type: ignore[arg-type]  # what it needs of it
        self.is_heard, self.suspended = True, 0.0
        time = RobotTime(epoch=1, robot_ns=1)
        numbers: dict[str, Any] = dict.fromkeys(("linear_x", "angular_z", "path"), 0.0)
        numbers["covariance"] = (0.0,) * 6
        self.answers, self.is_frozen = Answers(), False
        self.unanswered: list[float] = []
        self.pose: Sample = Odometry(x=x, y=y, yaw=yaw, board_us=0, boot_id=1, tick=time, **numbers)
        self.run(1.2)

    def give(
        self,
        x: float,
        y: float,
        yaw: float = 0.0,
        frame: str = "odom",
        turned: Quaternion | None = None,
        held_for: float = 0.0,
    ) -> None:
        rotation = turned or Quaternion(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
        goal = PoseStamped(Header(Time(0, 0), frame), Pose(Point(x, y, 0.0), rotation))
        sent_ns = round((self.now - held_for) * 1e9)
        self.goals.on_goal(Received(GOAL_POSE, goal, b"rviz", sent_ns, self.now), self.answers, self.now)

    def run(self, seconds: float = 0.1, driver: str = "") -> list[msgspec.Struct]:
        """What was asked meanwhile."""
        before = len(self.robot.asked)
        for _ in range(round(seconds / 0.02)):
            self.now += 0.02
            self.answers.on_question(self.now)
            self.unanswered.append(self.now)
            while self.unanswered and not self.is_frozen:
                self.answers.on_answer(self.unanswered.pop(), self.now)
            self.goals.on_sample(self.pose, self.now)
            if self.is_heard:
                self.goals.on_tick(Tick(epoch=1, robot_ns=round((self.now + self.suspended) * 1e9)), self.now)
            self.goals.turn(self.now, driver)
        return [asked.request for asked in self.robot.asked[before:]]

    def place(self, state: Any) -> None:
        """Say where the robot is in `map`."""
        place: dict[str, Any] = {"x": 1.0, "y": 0.0, "yaw": 0.0, "covariance": (0.0,) * 6, "candidates": ()}
        place |= {"odom": PlanarPose(x=0.0, y=0.0, yaw=0.0), "explained": 1.0, "way": 0.0, "particles": 9}
        self.goals.on_sample(MapPose(state=state, map="home", tick=None, **place), self.now)

    def drive(self) -> MotionGo:
        """Give a goal that is accepted."""
        self.give(2.0, 0.0)
        (request,) = self.run()
        assert isinstance(request, MotionGo)
        self.robot.asked[-1].answers.append(MotionAnswer(accepted=True))
        self.run(0.2)
        return request

    def end(self, request: MotionGo, outcome: str, reason: str = "") -> None:
        zeros = (0.0,) * 6
        fields: dict[str, Any] = {"asked": NOWHERE, "achieved": NOWHERE, "covariance": zeros, "outcome": outcome}
        fields |= {"stage": "ended", "step": 1, "steps": 1, "elapsed": 1.0, "time_limit": 9.0, "sensor": ""}
        state = MotionState(instance="motion", id=request.id, by=request.by, reason=Trouble(reason), **fields)
        self.goals.on_sample(state, self.now)
        self.run()


@pytest.mark.parametrize(
    ("goal", "steps"),
    [
        ((1.0, 2.0, 0.0), (GoTo(x=1.0, y=2.0), Turn(angle=-math.pi / 2))),
        ((3.0, 0.0, math.pi), (GoTo(x=3.0, y=0.0), Turn(angle=math.pi))),
        ((2.0, 0.0, 0.0), (GoTo(x=2.0, y=0.0),)),
        ((1.04, 0.0, -1.0), (Turn(angle=-1.0),)),
    ],
)
def test_a_goal_is_driven_to_and_then_turned_as_it_says(
    rviz: Rviz, goal: tuple[float, float, float], steps: tuple[Any, ...]
) -> None:
    rviz.give(*goal)
    (request,) = rviz.run()
    assert isinstance(request, MotionGo)
    assert len(request.steps) == len(steps)
    for step, expected in zip(request.steps, steps, strict=True):
        if isinstance(step, Turn):
            assert math.remainder(step.angle - expected.angle, math.tau) == pytest.approx(0.0, abs=1e-9)
        else:
            assert step == expected
    assert rviz.goals.is_active


def test_a_goal_of_nobody_who_is_there_is_refused(rviz: Rviz) -> None:
    goal = PoseStamped(Header(Time(0, 0), "odom"), Pose(Point(2.0, 0.0, 0.0), Quaternion(0.0, 0.0, 0.0, 1.0)))
    rviz.goals.on_goal(Received(GOAL_POSE, goal, b"", 0, rviz.now), None, rviz.now)
    assert rviz.run() == []
    assert "no token has the id of its publisher" in str(rviz.goals.trouble)
    assert rviz.goals.trouble.remedy.startswith("drive by a program on rmw_zenoh_cpp")


def test_where_it_is_already_nothing_is_asked(rviz: Rviz) -> None:
    rviz.give(1.0, 0.01)
    assert rviz.run() == []
    assert not rviz.goals.is_active


@pytest.mark.parametrize(
    ("goal", "why"),
    [
        ({"x": math.nan, "y": 0.0}, "a number of it is not finite"),
        ({"x": 0.0, "y": math.inf}, "a number of it is not finite"),
        ({"x": 0.0, "y": 0.0, "yaw": math.nan}, "a number of it is not finite"),
        ({"x": 2.0, "y": -1e5, "frame": "map"}, "beyond 10000 m"),
        ({"x": 2.0, "y": 0.0, "frame": "base_link"}, "'base_link'"),
        ({"x": 2.0, "y": 0.0, "frame": "map"}, "where the robot is in map"),
        ({"x": 2.0, "y": 0.0, "turned": Quaternion(0.0, 0.0, 0.0, 0.0)}, "no turn on the floor"),
        ({"x": 2.0, "y": 0.0, "turned": Quaternion(0.4, 0.0, 0.0, 0.92)}, "no turn on the floor"),
    ],
)
def test_a_goal_that_cannot_be_is_refused(rviz: Rviz, goal: dict[str, Any], why: str) -> None:
    rviz.give(**goal)
    assert rviz.run() == []
    assert not rviz.goals.is_active
    assert why in str(rviz.goals.trouble)


def test_a_goal_waits_until_nobody_drives_and_no_longer_than_3_s(rviz: Rviz) -> None:
    rviz.give(2.0, 0.0)
    assert rviz.run(1.0, driver="ros2") == []
    assert len(rviz.run()) == 1
    rviz = Rviz()
    rviz.give(2.0, 0.0)
    assert rviz.run(3.2, driver="keyboard") == []
    assert not rviz.goals.is_active
    assert "keyboard drives" in str(rviz.goals.trouble)


@pytest.mark.parametrize(
    "moment",
    [
        *("not heard", "frozen before", "frozen while it waits", "frozen while not heard"),
        *("suspended", "suspended while it waits"),
    ],
)
def test_a_goal_of_long_ago_moves_nothing(rviz: Rviz, moment: str) -> None:
    rviz.run()
    rviz.is_heard = "not heard" not in moment
    if moment == "frozen before":  # it has waited in the network
        rviz.now += 0.5
        rviz.goals.on_tick(Tick(epoch=1, robot_ns=round(rviz.now * 1e9)), rviz.now)
    rviz.give(2.0, 0.0)
    if moment == "suspended":  # no monotonic clock counts it
        rviz.suspended = 0.5
    assert rviz.run(0.5, driver="ros2" if "while it waits" in moment else "") == []
    if moment == "not heard":
        assert rviz.run(10.0) == []
    elif moment in ("frozen while it waits", "frozen while not heard"):
        rviz.now += 0.5
    elif moment == "suspended while it waits":
        rviz.suspended = 0.5
    rviz.is_heard = True
    assert rviz.run(1.1) == []
    assert not rviz.goals.is_active
    assert "give it again" in str(rviz.goals.trouble)
    rviz.give(2.0, 0.0)
    assert len(rviz.run()) == 1


def test_a_goal_that_is_later_than_those_before_it_moves_nothing(rviz: Rviz) -> None:
    rviz.give(1.0, 0.0)  # it is there
    for held_for, asks in ((60.0, 0), (0.25, 0), (0.1, 1)):
        rviz.give(2.0, 0.0, held_for=held_for)
        assert len(rviz.run()) == asks
        assert ("older than those before it" in str(rviz.goals.trouble)) is not bool(asks)


@pytest.mark.parametrize("asleep", [0.34, 2.0])
def test_a_goal_counts_of_a_process_alone_that_was_awake_for_a_second_before_it(rviz: Rviz, asleep: float) -> None:
    for _ in range(20):
        rviz.is_frozen = True
        assert rviz.run(asleep) == []
        rviz.is_frozen = False
        rviz.give(2.0, 0.0)  # clicked before, published now, and overtakes the answers
        assert rviz.run(0.9) == []
        rviz.give(2.0, 0.0)
        assert rviz.run(0.04) == []
        assert "not been seen awake for 1 s" in str(rviz.goals.trouble)
    rviz.run(0.1)
    rviz.give(2.0, 0.0)
    assert len(rviz.run()) == 1


def test_a_process_that_nobody_asks_is_not_awake() -> None:
    answers = Answers()
    for asked in (1.0, 1.2, 2.0):
        answers.on_question(asked)
        answers.on_answer(asked, asked)
    assert [answers.prompt_since(now) for now in (2.3, 2.31)] == [2.0, math.inf]


def test_a_goal_of_a_process_that_answers_nothing_is_refused(rviz: Rviz) -> None:
    rviz.answers, rviz.is_frozen = Answers(), True
    rviz.run(2.0)
    rviz.give(2.0, 0.0)
    assert rviz.run() == []
    assert "answers no question" in str(rviz.goals.trouble)


@pytest.mark.parametrize(
    ("state", "silent_s", "asks"), [("localized", 0.9, 1), ("localized", 1.1, 0), ("lost", 0.0, 0)]
)
def test_no_goal_is_begun_by_a_guess_of_where_the_robot_is(rviz: Rviz, state: Any, silent_s: float, asks: int) -> None:
    rviz.place("localized")
    rviz.place(state)
    rviz.run(silent_s)
    rviz.give(1.0, 0.0, 2.0, frame="map")  # a turn alone, which giraff_motion does not judge by localization
    assert len(rviz.run(0.08)) == asks
    assert bool(rviz.goals.trouble) is not bool(asks)


def test_it_is_held_while_it_goes_on_and_its_end_is_told_unless_it_arrived(rviz: Rviz) -> None:
    request = rviz.drive()
    assert rviz.robot.held
    assert {hold.id for hold in rviz.robot.held} == {request.id}
    rviz.end(request, "arrived")
    assert not rviz.goals.is_active
    assert not rviz.goals.trouble
    request = rviz.drive()
    rviz.end(request, "blocked", "front_left blocks the way")
    assert "front_left blocks the way" in str(rviz.goals.trouble)
    held = len(rviz.robot.held)
    rviz.run(1.0)
    assert len(rviz.robot.held) == held
    rviz.run(31.0)
    assert not rviz.goals.trouble


def test_why_motion_refuses_a_goal_is_told(rviz: Rviz) -> None:
    rviz.give(9.0, 9.0)
    rviz.run()
    rviz.robot.asked[-1].answers.append(MotionAnswer(accepted=False, reason=Trouble("(9, 9) is off the map")))
    rviz.run()
    assert not rviz.goals.is_active
    assert "not driven to: (9, 9) is off the map" in str(rviz.goals.trouble)


def test_a_new_goal_takes_the_place_of_the_old_one(rviz: Rviz) -> None:
    old = rviz.drive()
    rviz.give(5.0, 0.0)
    (cancel,) = rviz.robot.asked[-1:]
    assert cancel.request == MotionCancel(by="ros2@desk", id=old.id)
    held = len(rviz.robot.held)
    rviz.run(0.2)
    assert len(rviz.robot.held) == held  # the old one is let go at once
    rviz.end(old, "cancelled")
    (request,) = [each.request for each in rviz.robot.asked if isinstance(each.request, MotionGo)][1:]
    assert request.steps == (GoTo(x=5.0, y=0.0),)

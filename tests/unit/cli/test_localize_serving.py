"""`giraff localize` while it goes on: the service in a terminal with a place to be told, and one that is followed."""

from typing import Any, cast

import pytest

import giraff_cli.localize.serve as serving
from giraff_cli.localize import view
from giraff_cli.localize.serve import ShownLocalization
from giraff_cli.localize.view import Hearing, PoseView
from giraff_core.kinematics.pose import Pose
from giraff_localization.config import LocalizationConfig
from giraff_localization.floor import Floor
from giraff_maps.floor_plan import FloorPlan
from giraff_schemas.localization import LocalizationAnswer, LocalizationSetPose, MapPose
from giraff_schemas.topics import POSE, alive_key
from giraff_schemas.trouble import Trouble
from giraff_tools.terminal.signals import StopSignal
from tests.support.robots import ROBOT
from tests.unit.cli.asked import AskedRobot
from tests.unit.cli.map_poses import map_pose

NAME = "sim-here"
HERE = Pose(1.5, 2.2, 0.0)


class Screen:
    """Remembers; or has nobody before it."""

    def __init__(self) -> None:
        self.views: list[PoseView] = []
        self.is_gone = False

    def show(self, view: PoseView) -> None:
        if self.is_gone:
            raise BrokenPipeError
        self.views.append(view)

    def close(self) -> None:
        """Nothing to restore."""


class Asking:
    """As a request that is answered at the second look."""

    def __init__(self, answer: LocalizationAnswer) -> None:
        self._answer = answer
        self._looks = 0

    def poll(self, now: float) -> LocalizationAnswer | None:
        del now
        self._looks += 1
        return self._answer if self._looks > 1 else None


class Node:
    """What of a node the service in a terminal needs."""

    config = LocalizationConfig()
    robot = ROBOT

    def __init__(self, answer: LocalizationAnswer) -> None:
        self._answer = answer
        self.asked: list[LocalizationSetPose] = []
        self.left = 0

    def monotonic(self) -> float:
        return 0.0

    def leave(self) -> None:
        self.left += 1

    def ask(self, _query: Any, request: LocalizationSetPose, _settles: Any) -> Asking:
        self.asked.append(request)
        return Asking(self._answer)


class Idle:
    """In the place of the service itself."""

    timers = ()
    link = None

    def __init__(self, *_: Any) -> None:
        self.turns = self.ends = 0

    def turn(self, now: float) -> None:
        del now
        self.turns += 1

    def end(self) -> None:
        self.ends += 1


class Here(AskedRobot):
    """One of which localization says something."""

    def __init__(self) -> None:
        super().__init__(NAME)
        self.screen = Screen()
        self.hearing = Hearing(self.connection, self.screen)
        self._seq = 0

    def say(self, pose: MapPose) -> None:
        self._seq += 1
        self.put(POSE, pose, "l", self._seq)


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> Here:
    made = Here()
    made.rule(monkeypatch, view)
    monkeypatch.setattr(view, "robot_now_ns", made.clock.monotonic_ns)
    monkeypatch.setattr("giraff_tools.network.connection.robot_now_ns", made.clock.monotonic_ns)
    monkeypatch.setattr(serving, "Localization", Idle)
    monkeypatch.setattr(serving, "discard_stdout", lambda: None)
    return made


def shown(here: Here, node: Node, place: Pose | None = HERE, seconds: float | None = None) -> ShownLocalization:
    plan = FloorPlan("hall", ((0.0, 0.0, 6.0, 0.0), (6.0, 0.0, 6.0, 5.0), (6.0, 5.0, 0.0, 5.0), (0.0, 5.0, 0.0, 0.0)))
    floor = Floor(plan, LocalizationConfig(), ROBOT)
    return ShownLocalization(cast(Any, node), floor, here.hearing, place, seconds)


def test_a_place_is_told_once_and_not_before_the_map_is_read_and_odometry_heard(here: Here) -> None:
    node = Node(LocalizationAnswer(done=True))
    it = shown(here, node)
    for pose in (map_pose(None, state="no_map"), map_pose(5, state="no_map"), map_pose(None, state="lost")):
        here.say(pose)
        it.turn(0.0)
        it.turn(0.1)
        assert node.asked == []
    for count in range(5):
        here.say(map_pose(count, state="lost"))
        it.turn(1.0)
    [asked] = node.asked
    assert (asked.x, asked.y, asked.yaw) == HERE
    assert (it.refused, node.left) == ("", 0)
    assert [view.pose.sample.state for view in here.screen.views if view.pose][-1] == "lost"


def test_a_place_that_is_refused_ends_it(here: Here) -> None:
    node = Node(LocalizationAnswer(done=False, reason=Trouble("that is in a wall")))
    it = shown(here, node)
    for count in range(4):
        here.say(map_pose(count, state="lost"))
        it.turn(1.0)
    assert it.refused == "--at: that is in a wall"
    assert node.left == 1


def test_it_ends_with_its_time_and_with_its_reader(here: Here) -> None:
    node = Node(LocalizationAnswer(done=True))
    it = shown(here, node, None, 3.0)
    it.turn(2.9)
    assert node.left == 0
    it.turn(3.0)
    assert node.left == 1
    here.screen.is_gone = True
    here.clock.sleep(0.1)
    it.turn(1.0)
    assert node.left == 2
    assert node.asked == []


def test_one_that_falls_silent_is_told_as_such(here: Here) -> None:
    here.hearing.update()
    here.say(map_pose(1))
    here.hearing.update()
    here.clock.sleep(2.5)
    here.hearing.update()
    assert [view.words.partition(" | ")[2][:33] for view in here.screen.views] == [
        "waiting for localization to speak",
        "localized | x 1.50 y 2.20 m, 0.0°",
        "localization is not heard for 2 s",
    ]


def test_one_that_runs_is_followed_for_as_long_as_is_asked(
    here: Here, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def wait(_: Any, seconds: float) -> bool:
        here.clock.sleep(seconds)
        return False

    monkeypatch.setattr(StopSignal, "wait", wait)
    monkeypatch.setattr(view, "run_with_robot", lambda *words: words[2](here.connection))
    end = here.clock.every(0.1, lambda: here.say(map_pose(1)))
    with here.session.declare_token(alive_key(NAME, "localization", "1")):
        assert view.follow(None, (), 2.0, as_json=True) == 0
    end()
    assert 15 < len(capsys.readouterr().out.splitlines()) <= 21

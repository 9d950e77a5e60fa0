"""Frames for a script, in a time that only its own waits let pass."""

import math
from collections.abc import Callable
from typing import Any

import msgspec
import pytest
import zenoh

import giraff_client.frames
from giraff_client import (
    FrameError,
    FutureError,
    GapError,
    PastError,
    RobotError,
    UnconnectedError,
    UnknownFrameError,
    UnlocalizedError,
)
from giraff_client.errors import LostRobotError, SilentError
from giraff_client.frames import FrameFinder
from giraff_core.kinematics.pose import Pose
from giraff_schemas.codec import encode
from giraff_schemas.frames import Transform
from giraff_schemas.localization import LocalizationState
from giraff_schemas.messages import Odometry, RobotTime
from tests.support.map_poses import map_pose
from tests.support.robots import ULTRASONIC
from tests.unit.cli import samples

S = 1_000_000_000
REAR = ULTRASONIC["rear"].transform("rear")
LASER = msgspec.structs.replace(REAR, child="laser", z=0.226)


class Reply:
    """Of Zenoh, that is answered or refused."""

    def __init__(self, payload: bytes | None) -> None:
        self.ok = None if payload is None else self
        self.payload = payload


class Scene:
    """A finder, the session that it asks, and their clock, in which odometry goes on."""

    def __init__(self) -> None:
        self.now = 100.0
        self.asked: list[str] = []
        self.answers: list[Reply] = [Reply(encode(REAR))]
        self.lost = ""
        self.stale = ""
        self.goes_on = True
        self.at_time: dict[float, Callable[[], None]] = {}
        self.finder = FrameFinder(self.read_odom, self.silence)

    def begin(self) -> None:
        session: Any = self
        self.finder.begin(session, "sim-test")

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds
        if self.goes_on:
            self.finder.on_odometry(self.odometry())
        for at in [at for at in self.at_time if at <= self.now]:
            self.at_time.pop(at)()

    def get(
        self, key: str, on_reply: Callable[[Any], None], *, consolidation: Any = zenoh.ConsolidationMode.AUTO, **_: Any
    ) -> None:
        self.asked.append(key)
        is_each = consolidation == zenoh.ConsolidationMode.NONE  # else Zenoh brings the last answer of a key
        for answer in self.answers if is_each else self.answers[-1:]:
            on_reply(answer)

    def read_odom(self) -> None:
        if self.stale:
            raise SilentError(self.stale)

    def silence(self, text: str) -> RobotError:
        return LostRobotError(self.lost) if self.lost else SilentError(text)

    def odometry(self, **changes: Any) -> Odometry:
        sample = samples.odometry(round(self.now * S), self.now - 100.0)
        return msgspec.structs.replace(sample, **{"instance": "one", **changes})


@pytest.fixture
def scene(monkeypatch: pytest.MonkeyPatch) -> Scene:
    made = Scene()
    monkeypatch.setattr(giraff_client.frames, "time", made)
    made.begin()
    return made


def moment(seconds: float) -> RobotTime:
    return samples.at(round(seconds * S))


def test_what_is_fixed_is_asked_for_once(scene: Scene) -> None:
    for _ in range(3):
        assert scene.finder.lookup("base_link", "range_rear_link", None).x == REAR.x
    assert scene.asked == ["giraff/sim-test/frame/*"]
    assert scene.now == pytest.approx(100.01)


def test_it_is_asked_for_again_while_something_is_missing(scene: Scene) -> None:
    scene.at_time[101.0] = lambda: scene.answers.append(Reply(encode(LASER)))
    assert scene.finder.lookup("range_rear_link", "laser", None).z == pytest.approx(0.226)
    assert 101.0 < scene.now < 101.4
    assert len(scene.asked) == pytest.approx(4, abs=1)


def test_a_wrong_name_costs_two_seconds_at_first_and_half_a_second_later(scene: Scene) -> None:
    for seconds in (2.0, 0.5):
        began = scene.now
        with pytest.raises(UnknownFrameError, match=r"no frame is called 'rear'.*: base_link, odom, range_rear_link"):
            scene.finder.lookup("odom", "rear", None)
        assert scene.now - began == pytest.approx(seconds, abs=0.02)


def test_a_look_up_does_not_wait_for_a_moment(scene: Scene) -> None:
    scene.finder.lookup("odom", "range_rear_link", None)
    with pytest.raises(FutureError, match=r"that moment is 0\.\d{3} s ahead of the newest of odometry"):
        scene.finder.lookup("odom", "base_link", moment(scene.now + 0.2))
    assert scene.now < 100.1


def test_a_moment_is_waited_for(scene: Scene) -> None:
    found = scene.finder.wait_for("odom", "range_rear_link", moment(100.5), 2.0)
    assert found.x == pytest.approx(0.5 + REAR.x)
    assert found.tick == moment(100.5)
    assert scene.now == pytest.approx(100.5, abs=0.02), "it waits no longer than it must"


@pytest.mark.parametrize(
    ("target", "at", "kind"),
    [("nowhere", None, UnknownFrameError), ("odom", moment(200.0), FutureError), ("door", None, UnconnectedError)],
)
def test_a_wait_ends_as_asked_and_says_why(
    scene: Scene, target: str, at: RobotTime | None, kind: type[FrameError]
) -> None:
    scene.answers.append(Reply(encode(msgspec.structs.replace(REAR, parent="map", child="door"))))
    with pytest.raises(kind):
        scene.finder.wait_for(target, "range_rear_link", at, 3.0)
    assert scene.now == pytest.approx(103.0, abs=0.02)
    with pytest.raises(kind):
        scene.finder.wait_for(target, "range_rear_link", at, 0.0)
    assert scene.now == pytest.approx(103.0, abs=0.02)


def test_what_no_wait_mends_is_told_at_once(scene: Scene) -> None:
    scene.finder.wait_for("odom", "range_rear_link", None, 1.0)
    scene.sleep(0.1)
    set_between = moment(scene.now + 0.05)
    scene.now += 0.1
    scene.finder.on_odometry(scene.odometry(jumps=1))
    scene.goes_on = False
    began = scene.now
    with pytest.raises(GapError, match="odometry was set"):
        scene.finder.wait_for("odom", "base_link", set_between, 5.0)
    with pytest.raises(PastError, match="before the first that is remembered"):
        scene.finder.wait_for("odom", "base_link", moment(1.0), 5.0)
    assert scene.now == began


def test_a_pose_of_now_takes_an_odometry_of_now(scene: Scene) -> None:
    scene.finder.lookup("odom", "range_rear_link", None)
    scene.stale = "odom is silent for 1.2 s"
    with pytest.raises(SilentError, match=r"silent for 1\.2 s"):
        scene.finder.lookup("odom", "range_rear_link", None)
    assert scene.finder.lookup("base_link", "range_rear_link", None).fixed
    with pytest.raises(SilentError):
        scene.finder.wait_for("odom", "base_link", None, 1.0)
    scene.at_time[scene.now + 0.5] = lambda: setattr(scene, "stale", "")
    assert not scene.finder.wait_for("odom", "base_link", None, 1.0).fixed


def test_a_lost_robot_explains_what_is_missing(scene: Scene) -> None:
    scene.lost = "no tick of the robot for 0.6 s"
    with pytest.raises(LostRobotError, match="no tick"):
        scene.finder.lookup("odom", "nowhere", None)


def test_an_answer_that_is_none_is_left_out(scene: Scene) -> None:
    moving = Transform(parent="map", child="odom", x=1.0, y=0.0, yaw=0.0, fixed=False)
    scene.answers = [Reply(None), Reply(b"\xc1"), Reply(b"\x81\xa1a\x01"), Reply(encode(moving)), Reply(encode(REAR))]
    scene.finder.lookup("odom", "range_rear_link", None)
    with pytest.raises(UnknownFrameError):
        scene.finder.lookup("map", "odom", None)


@pytest.mark.parametrize("timeout", [math.nan, math.inf])
def test_what_is_no_time_is_refused(scene: Scene, timeout: float) -> None:
    with pytest.raises(ValueError, match="finite numbers, s"):
        scene.finder.wait_for("odom", "base_link", None, timeout)
    seconds: Any = 12.5
    said = r"at is 12\.5: it must be a tick of the robot, such as robot\.odom\(\)\.tick"
    with pytest.raises(ValueError, match=said):
        scene.finder.lookup("odom", "base_link", seconds)
    with pytest.raises(ValueError, match=said):
        scene.finder.wait_for("odom", "base_link", seconds, 1.0)


def located(scene: Scene, state: LocalizationState = "localized", ahead: float = 0.0) -> None:
    """It is told where `odom` is in `map`."""
    pose = map_pose(Pose(4.0, 1.0, math.pi / 2.0), Pose(0.0, 0.0, 0.0), moment(scene.now + ahead), state)
    scene.finder.hear_pose(pose)


def test_the_robot_is_found_in_the_map_while_it_is_localized(scene: Scene) -> None:
    scene.sleep(0.5)
    then = moment(scene.now - 0.2)
    scene.finder.on_odometry(scene.odometry())
    scene.sleep(0.5)
    located(scene)
    began = scene.now
    found = scene.finder.lookup("map", "base_link", None)
    assert (found.x, found.y, found.yaw) == pytest.approx((4.0, 2.0, math.pi / 2.0))
    located(scene, "lost")
    for _ in range(2):
        with pytest.raises(UnlocalizedError, match="it is lost; drive it"):
            scene.finder.lookup("map", "base_link", None)
    assert scene.now == began, "a script that drives is not kept waiting"
    assert scene.finder.lookup("odom", "base_link", None).x == pytest.approx(1.0)
    with pytest.raises(PastError):
        scene.finder.lookup("odom", "base_link", then)


def test_a_pose_that_is_silent_or_of_another_origin_places_nothing(scene: Scene) -> None:
    scene.sleep(0.1)
    scene.sleep(0.1)
    located(scene)
    assert scene.finder.lookup("map", "odom", None).x == 4.0
    scene.finder.on_odometry(scene.odometry(jumps=1))
    with pytest.raises(UnlocalizedError, match="from before odometry was set"):
        scene.finder.lookup("map", "base_link", None)
    located(scene, ahead=0.02)
    assert scene.finder.lookup("map", "odom", None).x == 4.0
    scene.goes_on = False
    scene.sleep(1.1)
    with pytest.raises(UnlocalizedError, match=r"silent for 1\.1 s; check giraff_localization"):
        scene.finder.lookup("map", "odom", None)


def test_where_no_localization_was_ever_heard_its_error_says_so(scene: Scene) -> None:
    with pytest.raises(UnknownFrameError, match="check that giraff_localization runs"):
        scene.finder.lookup("map", "base_link", None)


def test_it_is_waited_for_until_it_is_known(scene: Scene) -> None:
    scene.sleep(0.1)
    located(scene, "ambiguous")
    scene.at_time[scene.now + 0.5] = lambda: located(scene)
    began = scene.now
    assert scene.finder.wait_for("map", "odom", None, 2.0).y == 1.0
    assert scene.now - began == pytest.approx(0.5, abs=0.02)


def test_each_of_these_errors_is_a_robot_error() -> None:
    for kind in (UnknownFrameError, UnconnectedError, UnlocalizedError, PastError, FutureError, GapError):
        assert issubclass(kind, FrameError)
    assert issubclass(FrameError, RobotError)

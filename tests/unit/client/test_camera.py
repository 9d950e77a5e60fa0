"""`Robot.picture`: asked for, waited for, and let go."""

from collections.abc import Callable
from typing import Any

import pytest

import giraff_client.camera
from giraff_client import Robot, SilentError
from giraff_schemas.camera import Picture
from giraff_schemas.topics import CAMERA_STATE
from giraff_schemas.trouble import Trouble
from tests.support.picture_source import Source
from tests.unit.cli import samples
from tests.unit.client.test_robot import Network, network, robot

__all__ = ["network", "robot"]  # fixtures


class Client(Source):
    """Pictures come as `plan` has it, by s since it began; then none."""

    def __init__(self, clock: Callable[[], float], plan: dict[float, int]) -> None:
        super().__init__()
        self._clock, self._began = clock, clock()
        self._plan = dict(plan)

    def next_picture(self) -> Picture | None:
        now = self._clock()
        for at in [at for at in self._plan if now - self._began >= at]:
            width, old_ns = self._plan.pop(at), round(0.1e9)
            tick = samples.at(round(now * 1e9) - old_ns)
            return Picture(camera="head", jpeg=b"jpeg", width=width, height=width * 3 // 4, tick=tick)
        return None


class Cameras:
    """Whom a script has asked."""

    def __init__(self, network: Network, *plans: dict[float, int]) -> None:
        self._network, self._plans = network, list(plans)
        self.clients: list[Client] = []
        self.asked: list[tuple[str, str]] = []

    def open(self, _config: Any, robot: str, camera: str, _by: str) -> Client:
        self.asked.append((robot, camera))
        self.clients.append(Client(self._network.monotonic, self._plans.pop(0)))
        return self.clients[-1]


def cameras(network: Network, monkeypatch: pytest.MonkeyPatch, *plans: dict[float, int]) -> Cameras:
    made = Cameras(network, *plans)
    monkeypatch.setattr(giraff_client.camera, "PictureClient", made.open)
    monkeypatch.setattr(giraff_client.camera, "time", network)
    return made


def test_a_picture_is_a_full_one_with_its_age_and_a_loop_asks_once(
    network: Network, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = cameras(network, monkeypatch, {0.3: 160, 0.6: 320, 0.7: 320}, {0.2: 320})
    network.say(CAMERA_STATE, samples.camera(), name="head")
    seen = robot.picture()
    assert (seen.camera, seen.jpeg, seen.width, seen.height) == ("head", b"jpeg", 320, 240)
    assert seen.age == pytest.approx(0.1, abs=0.01)
    assert robot.picture().width == 320
    assert asked.asked == [("sim-test", "head")]
    network.pass_time(1.0)
    assert robot.picture("head", timeout=1.0).width == 320
    assert [client.closed for client in asked.clients] == [True, False]


def test_on_a_slow_link_a_small_one_is_taken(network: Network, robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    cameras(network, monkeypatch, {0.3: 160, 2.5: 160})
    assert [robot.picture("head").width, robot.picture("head").width] == [160, 160]


def test_without_a_picture_it_says_why_and_looks_no_longer(
    network: Network, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = cameras(network, monkeypatch, {}, {0.1: 320})
    with pytest.raises(SilentError, match="no camera is heard; check that giraff_camera runs"):
        robot.picture()
    with pytest.raises(SilentError, match="no picture of the camera head came in 2 s"):
        robot.picture("head", timeout=2.0)
    assert asked.clients[0].closed
    assert robot.picture("head").width == 320, "the next call is a wish of its own"
    asked.clients[1].trouble = Trouble("the camera has started again", "ask for its picture again")
    with pytest.raises(SilentError, match="the camera has started again; ask"):
        robot.picture("head")


def test_of_several_cameras_one_is_named(network: Network, robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    cameras(network, monkeypatch)
    for name in ("rear", "head"):
        network.say(CAMERA_STATE, samples.camera(), name=name)
    with pytest.raises(ValueError, match="the cameras head, rear: name one"):
        robot.picture()

"""`giraff map make` while somebody drives: the plan that grows, and what ends it."""

import math
from collections.abc import Callable, Sequence
from itertools import count
from typing import Any, cast

import msgspec
import pytest

from giraff_core.io import Inbox
from giraff_schemas.localization import MapPose, MapWalls
from giraff_schemas.messages import Odometry
from giraff_schemas.scan import LaserScan
from giraff_schemas.topics import MAP, POSE, SCAN, Topic
from giraff_schemas.trouble import Trouble
from giraff_setup.map.make.drive import Drive
from giraff_setup.map.make.live import PlanMaking
from giraff_setup.map.make.view import ChangedLines, GrowingPlan
from giraff_tools.terminal.screen import View
from tests.unit.localization.rooms import odometry
from tests.unit.setup.test_map_make import MAPPED, ROUND, SCANS


class Host:
    """As the `IO` of a service that nobody else hears."""

    def __init__(self) -> None:
        self.now = 100.0
        self.scans: Inbox[LaserScan] = Inbox(200)
        self.odometry: Inbox[Odometry] = Inbox(200)
        self.said: dict[str, list[Any]] = {}
        self.notices: dict[str, Trouble] = {}
        self.left = False
        self.frames: dict[str, Callable[[], Any]] = {}

    def monotonic(self) -> float:
        return self.now

    def inbox(self, topic: Topic[Any], *, wakes: bool = True) -> Inbox[Any]:
        assert wakes is (topic is SCAN)
        return self.scans if topic is SCAN else self.odometry

    def frame(self, child: str, where: Callable[[], Any]) -> None:
        self.frames[child] = where

    def publisher(self, topic: Topic[Any]) -> Any:
        said = self.said[topic.key] = []

        class Said:
            put = staticmethod(said.append)

        return Said()

    def set_notice(self, name: str, trouble: Trouble) -> None:
        self.notices[name] = trouble

    def leave(self) -> None:
        self.left = True


class Remembering(ChangedLines):
    """A screen that keeps each view, or is gone."""

    def __init__(self) -> None:
        super().__init__(15.0)
        self.views: list[GrowingPlan] = []
        self.is_gone = False

    def show(self, view: View) -> None:
        if self.is_gone:
            raise BrokenPipeError
        assert isinstance(view, GrowingPlan)
        self.views.append(view)
        super().show(view)


def test_the_plan_grows_while_somebody_drives_and_is_kept_when_the_robot_is_lost(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("giraff_setup.map.make.live.discard_stdout", lambda: None)
    host, screen, made = Host(), Remembering(), Drive(MAPPED)
    service = PlanMaking(cast(Any, host), "robie", made, "home", screen, None, as_json=False)

    def turns(scans: Sequence[LaserScan], seconds: float = 0.0) -> None:
        for scan, _ in zip(scans or count(), range(len(scans) or round(seconds * 10)), strict=False):
            if isinstance(scan, LaserScan):
                host.scans.accept(scan)
            for _ in range(2):
                host.now += 0.05
                service.turn(host.now)

    turns([], 2.0)
    assert host.said[POSE.key][-1].state == "no_map"
    assert host.notices["scan"].what == screen.views[-1].pose.reason.what == "no scan is heard"
    turns(SCANS[:ROUND])
    pose: MapPose = host.said[POSE.key][-1]
    walls: list[MapWalls] = [each for each in host.said[MAP.key] if each.walls]
    assert (pose.state, pose.map, pose.tick) == ("localized", "home", SCANS[ROUND - 1].tick)
    assert len({each.walls for each in walls}) > 1
    assert (walls[-1].map, walls[-1].free) == ("home", None)
    odom, told = host.frames["odom"](), SCANS[ROUND - 1].odom
    assert told is not None
    assert (odom.x, odom.y, odom.yaw) == (pose.odom.x, pose.odom.y, pose.odom.yaw)
    assert made.way > 3.0
    assert pose.tick is not None
    later = odometry(pose.tick.robot_ns * 1e-9 + 0.2, told[0] + 0.05, told[1], told[2])
    for epoch, moved in ((pose.tick.epoch, 0.05), (pose.tick.epoch + 1, 0.0)):
        tick = msgspec.structs.replace(later.tick, epoch=epoch)
        host.odometry.accept(msgspec.structs.replace(later, tick=tick))
        turns([], 0.2)
        since = host.said[POSE.key][-1]
        assert math.dist((since.x, since.y), (pose.x, pose.y)) == pytest.approx(moved, abs=1e-6)
    assert "loop" in screen.views[-1].words
    turns([], 2.0)
    pose = host.said[POSE.key][-1]
    assert (pose.state, pose.reason.what) == ("lost", "no scan is heard")
    assert screen.views[-1].words.endswith("; what was driven is kept")
    assert not host.left
    lines = capsys.readouterr().out.splitlines()
    assert 3 <= len(lines) <= 5
    screen.is_gone = True
    turns([], 0.2)
    assert host.left


def test_where_no_scan_is_heard_or_the_time_is_over_it_ends() -> None:
    for seconds, until in ((None, 10.2), (1.0, 1.2)):
        host = Host()
        service = PlanMaking(cast(Any, host), "robie", Drive(MAPPED), "home", Remembering(), seconds, as_json=True)
        host.now += until - 0.4
        service.turn(host.now)
        assert not host.left
        host.now += 0.4
        service.turn(host.now)
        assert host.left

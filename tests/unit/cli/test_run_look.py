"""What a run does each time that it looks: the key of the code, and localization told its place."""

from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import pytest

from giraff_cli.run import runner
from giraff_cli.run.page import Page
from giraff_cli.run.runner import Run
from giraff_cli.run.telemetry import RunTelemetry
from giraff_core.kinematics.pose import Pose
from giraff_schemas import topics
from giraff_schemas.localization import LocalizationAnswer, LocalizationSetPose, LocalizationState
from giraff_schemas.trouble import Trouble
from tests.unit.cli.map_poses import map_pose
from tests.unit.cli.samples import MS, START, Network, ten_seconds, truth
from tests.unit.cli.test_plan import typed
from tests.unit.cli.test_shown import FRAME, SECOND, rendered

NOW_NS = 10_000 * MS
THERE = LocalizationAnswer(done=True)
IN_A_WALL = LocalizationAnswer(done=False, reason=Trouble("in a wall"))


class Looks:
    """A run whose processes, network and screen are none."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, page: Page | None = None, *, localize: bool = False) -> None:
        self.x = 4.0
        """m from its start."""
        monkeypatch.setattr(runner, "robot_now_ns", lambda: NOW_NS)
        monkeypatch.setattr(runner, "QueryClient", self._client)
        robot = MagicMock(page=page, ended={})
        robot.reap.return_value = []
        robot.truth.side_effect = lambda: truth(NOW_NS, x=self.x)
        services = ("web",) * (page is not None) + ("localization",) * localize
        plan = MagicMock(options=typed(), services=services, camera="", boards="host")
        plan.robot.name = "sim-here"
        self.telemetry: RunTelemetry = ten_seconds()
        self.run = Run(plan, robot, MagicMock(), MagicMock(), hints=("drive it: giraff drive",), look="")
        self.shows = MagicMock()
        self.run._screen = MagicMock(show=self.shows)
        self.told: list[tuple[str, float]] = []
        self.answer: LocalizationAnswer | None = None

    def look(self) -> Any:
        """Return what is shown."""
        self.run._update(self.telemetry)
        return self.shows.call_args.args[0]

    def says(self, state: LocalizationState) -> None:
        Network(self.telemetry).send(topics.POSE, map_pose(NOW_NS, Pose(0.0, 0.0, 0.0), state), NOW_NS)

    def _client(self, session: object, robot: str, query: object, request: LocalizationSetPose) -> MagicMock:
        del session, robot
        assert query is topics.LOCALIZATION_SET_POSE
        self.told.append((request.by, request.x - START.x))
        return MagicMock(poll=lambda _: self.answer)


def test_the_key_puts_the_code_on_the_screen_and_in_no_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    looks = Looks(monkeypatch, Page(tmp_path / "web.log", everywhere=True))
    looks.run._keys = MagicMock(read=lambda: "c")
    shown = looks.look()
    assert shown.render() is shown.code is not None
    assert looks.run._view(looks.telemetry).code is None
    assert looks.look().code is None, "any key goes back"


def test_localization_is_told_once_where_the_robot_is_when_its_map_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    looks = Looks(monkeypatch, localize=True)
    looks.look()
    looks.says("no_map")
    looks.look()
    assert looks.told == []
    looks.says("lost")
    looks.look()
    looks.answer, looks.x = IN_A_WALL, 5.0
    looks.look()
    assert looks.told == [("giraff run", 4.0)]
    looks.answer, looks.x = THERE, 6.0
    looks.look()
    looks.look()
    assert looks.told == [("giraff run", 4.0), ("giraff run", 6.0)], "refused, it is told the place of that moment"


def test_a_run_that_looks_for_nothing_tells_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    looks = Looks(monkeypatch)
    looks.says("lost")
    looks.look()
    assert looks.told == []


def test_a_command_that_is_longer_than_a_row_is_whole_and_a_note_takes_one() -> None:
    long = f"stop it:  {'/somewhere' * 5}/giraff stop --connect 127.0.0.1:29194"
    frame = replace(FRAME, hints=(FRAME.hints[0], long), code_key="c")
    shown = rendered(ten_seconds().snapshot(10 * SECOND), frame)
    assert "".join(shown[2:4]).replace(" ", "") == long.replace(" ", "")
    assert "sim-here · c shows the code" in shown[0]
    assert len(shown) <= 24
    noted = rendered(ten_seconds().snapshot(10 * SECOND), replace(FRAME, note="waits " * 40))
    assert noted[2].rstrip() == FRAME.hints[1]

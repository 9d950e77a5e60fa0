"""`giraff localize`: a place as it is typed, what is shown, and a localization that is asked.

With real processes: tests/functional/robot/test_run_localize.py.
"""

import io
import json
import math
import os
from pathlib import Path
from typing import cast

import msgspec
import pytest
from rich.console import Console

import giraff_cli.localize.serve
from giraff_cli.localize import client
from giraff_cli.localize.client import ask
from giraff_cli.localize.view import ChangedLines, JsonLines, PoseView
from giraff_core.kinematics.pose import Pose
from giraff_core.latest import Latest
from giraff_maps.floor_plan import FloorPlan, MapError
from giraff_node.network.consent import NoRobotError
from giraff_schemas.codec import stamped
from giraff_schemas.localization import LocalizationAnswer, LocalizationSetPose, MapPose
from giraff_schemas.topics import LOCALIZATION_GLOBAL, LOCALIZATION_SET_POSE, alive_key
from giraff_schemas.trouble import Trouble
from giraff_tools.network.localization import require_none
from tests.unit.cli.asked import AskedRobot
from tests.unit.cli.map_poses import map_pose
from tests.unit.cli.quiet_network import meet
from tests.unit.cli.typed import Giraff

NAME = "sim-here"
HERE = Pose(1.5, -2.2, math.pi / 2)


@pytest.mark.parametrize("more", [(), ("--from", "drive.mcap")])
def test_a_map_that_cannot_be_used_is_told_before_anybody_is_asked(
    more: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    def torn(path: Path) -> None:
        raise MapError(f"{path}: torn; copy it again")

    monkeypatch.setattr(giraff_cli.localize.serve, "read_map", torn)
    monkeypatch.setattr("giraff_cli.localize.offline.read_map", torn)
    network = meet(monkeypatch)
    done = giraff("localize", "--map", "hall.toml", *more)
    assert done == (2, "", "giraff: hall.toml: torn; copy it again\n")
    assert network.opened == 0


def seen(pose: MapPose | None, elapsed: float = 0.0, age: float = 0.0) -> PoseView:
    return PoseView(NAME, elapsed, None if pose is None else Latest(pose, age))


def test_a_line_comes_when_the_state_changes_and_else_once_a_second(capsys: pytest.CaptureFixture[str]) -> None:
    screen = ChangedLines()
    for count in range(25):
        screen.show(seen(map_pose(0, Pose(0.1 * count, 0.0, 0.0), "lost", "drive on"), 0.1 * count))
    screen.show(seen(map_pose(0, Pose(2.5, 0.0, 0.0)), 2.5))
    for count in range(26, 100):
        screen.show(seen(map_pose(0, Pose(2.5, 0.0, 0.0)), 0.1 * count))
    screen.show(seen(map_pose(0, Pose(2.5, 0.0, 0.0)), 12.0, age=2.0))
    told = capsys.readouterr().out.splitlines()
    assert [line.split(" | ")[2] for line in told] == [
        *("lost", "lost", "lost", "localized"),
        "localization is not heard for 2 s; check that giraff_localization runs",
    ]
    assert told[0].startswith("   0.0 s | sim-here | lost | perhaps x 0.00 y 0.00 m, 0.0° | ")


def test_a_figure_in_a_reason_is_no_change_of_the_state(capsys: pytest.CaptureFixture[str]) -> None:
    screen = ChangedLines()
    for count in range(20):
        screen.show(seen(map_pose(None, state="no_map", reason=f"the map is being read: {5 * count}%"), 0.05 * count))
    assert len(capsys.readouterr().out.splitlines()) == 1


def test_before_anything_is_heard_it_waits(capsys: pytest.CaptureFixture[str]) -> None:
    screen = ChangedLines()
    for _ in range(3):
        screen.show(seen(None))
    assert capsys.readouterr().out == "   0.0 s | sim-here | waiting for localization to speak\n"


def test_a_terminal_shows_the_floor_plan_with_the_robot_and_the_words_below(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.get_terminal_size", lambda: os.terminal_size((80, 24)))
    plan = FloorPlan("hall", ((0.0, 0.0, 6.0, 0.0), (6.0, 0.0, 6.0, 5.0), (6.0, 5.0, 0.0, 5.0), (0.0, 5.0, 0.0, 0.0)))
    pose = map_pose(0, Pose(3.0, 2.0, math.pi / 2.0), "told", "drive on")
    console = Console(file=io.StringIO(), width=80)
    console.print(PoseView(NAME, 0.0, Latest(pose, 0.0), plan).render())
    lines = cast(io.StringIO, console.file).getvalue().splitlines()
    assert max(map(len, lines)) <= 80
    assert len(lines) <= 24
    assert sum(line.count("↑") + line.count("^") for line in lines) == 1
    assert lines[-2].startswith("sim-here | told | about x 3.00 y 2.00 m, 90.0° | ")


def test_what_the_network_says_does_not_steer_the_terminal() -> None:
    assert "\x1b" not in seen(map_pose(0, state="lost", reason="\x1b[2J")).line()


def test_programs_get_each_pose_once(capsys: pytest.CaptureFixture[str]) -> None:
    screen = JsonLines()
    screen.show(seen(None))
    for seq in (0, 0, 1):
        screen.show(seen(stamped(map_pose(5), seq, 0, "one")))
    first, second = map(json.loads, capsys.readouterr().out.splitlines())
    assert (first["seq"], second["seq"], first["robot"]) == (0, 1, NAME)
    assert first["standard_deviations"] == {"x": 0.03, "y": 0.04, "yaw": 0.02}
    assert (first["state"], first["map"], first["tick"]["robot_ns"]) == ("localized", "hall", 5)


class Network(AskedRobot):
    """One that has a localization."""

    asked: list[msgspec.Struct]

    def answered(self, answer: LocalizationAnswer | None) -> None:
        self.asked = []

        def say(request: msgspec.Struct) -> LocalizationAnswer | None:
            self.asked.append(request)
            return answer

        self.answer((LOCALIZATION_SET_POSE, LOCALIZATION_GLOBAL), say)


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> Network:
    made = Network(NAME)
    made.rule(monkeypatch, client)
    return made


TOKEN = alive_key(NAME, "localization", "1")


def test_it_is_told_where_the_robot_is(network: Network) -> None:
    network.answered(LocalizationAnswer(done=True))
    with network.session.declare_token(TOKEN):
        code, text = ask(network.connection, HERE, 3.0)
        assert (code, text.partition(";")[0]) == (
            0,
            "sim-here is taken to be at about x 1.50 y -2.20 m, 90.0°, ± 0.42 m, 11°",
        )
        assert ask(network.connection, None, 3.0) == (0, "sim-here is looked for anywhere on the map")
    first = network.asked[0]
    assert isinstance(first, LocalizationSetPose)
    assert (first.x, first.y, first.yaw) == HERE
    assert "@" in first.by


def test_its_refusal_is_told_with_the_reason(network: Network) -> None:
    network.answered(LocalizationAnswer(done=False, reason=Trouble("that is in a wall")))
    with network.session.declare_token(TOKEN):
        assert ask(network.connection, HERE, 3.0) == (1, "localization of sim-here refuses: that is in a wall")


def test_one_that_hangs_is_named(network: Network) -> None:
    network.answered(None)
    with network.session.declare_token(TOKEN):
        code, text = ask(network.connection, HERE, 3.0)
    assert code == 2
    assert text.startswith("NOT CONFIRMED after 3 s: nobody answered giraff/sim-here/localization/set_pose; check that")


def test_where_none_runs_the_way_to_one_is_told(network: Network) -> None:
    with network.session.declare_token(alive_key(NAME, "base", "1")):
        with pytest.raises(NoRobotError, match=r"^no localization of sim-here runs .* `giraff localize --map FILE`"):
            ask(network.connection, HERE, 3.0)
        require_none(network.connection, "end it")
    with pytest.raises(NoRobotError, match=r"^no robot called sim-here is heard"):
        ask(network.connection, None, 3.0)


def test_a_second_one_is_not_started(network: Network) -> None:
    with (
        network.session.declare_token(TOKEN),
        pytest.raises(NoRobotError, match="runs on the network already; end it"),
    ):
        require_none(network.connection, "end it")

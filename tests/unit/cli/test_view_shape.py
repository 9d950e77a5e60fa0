"""The shape by which `giraff view` draws a robot: the robot's own, or the picture says whose."""

import math
import tomllib
from pathlib import Path
from shutil import copy
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest
import zenoh

from giraff_core.robot import RobotConfig
from giraff_mcap.raw_sample import RawSample
from giraff_mcap.writing import RecordingWriter
from giraff_schemas.codec import encode, encoding_of, stamped
from giraff_schemas.params import Param, ParamAnswer
from giraff_schemas.topics import ODOM, alive_key, key_of
from giraff_viewer import show
from giraff_viewer.scene import Scene, stock
from tests.rules.repository import ROOT
from tests.unit.cli.quiet_network import alone, meet
from tests.unit.cli.samples import odometry
from tests.unit.cli.typed import Giraff
from tests.unit.mcap.recordings import ABOUT

OWN = msgspec.structs.replace(stock("sim-test"), footprint_radius=0.2)
ANSWER = ParamAnswer(
    service="base",
    instance="1",
    host="pi",
    done=True,
    params=tuple(
        Param(name=f"robot.{name}", value=value, filed=value, saved=True, kind="", live="fixed", doc="")
        for name, value in msgspec.to_builtins(OWN).items()
    ),
)
FILED = tomllib.loads((ROOT / "deploy" / "robot.toml").read_text())["robot"]
STOCK_NOTE = (0.3, "drawn as a stock Giraff")
TOLD = (0.2, "")


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[tuple[float, str]]:
    """Radius and note of each scene that a view begins, on a host that knows of no robot."""
    alone(monkeypatch, tmp_path)
    found: list[tuple[float, str]] = []

    class Noted(Scene):
        def __init__(self, robot: RobotConfig, note: str = "") -> None:
            found.append((robot.footprint_radius, note))
            super().__init__(robot, note)

    monkeypatch.setattr(show, "Scene", Noted)
    return found


@pytest.mark.parametrize(("unanswered", "expected"), [(0, [TOLD]), (20, [STOCK_NOTE, TOLD]), (math.inf, [STOCK_NOTE])])
def test_a_live_robot_is_asked_and_another_shape_is_named(
    monkeypatch: pytest.MonkeyPatch,
    giraff: Giraff,
    drawn: list[tuple[float, str]],
    unanswered: float,
    expected: list[tuple[float, str]],
) -> None:
    """`unanswered`: questions, each 0.2 s after the one before, until base answers."""
    asked = 0

    def answer(key: str, handler: Any, **_: Any) -> None:
        nonlocal asked
        if "param" in key:
            asked += 1
            if asked > unanswered:
                handler(SimpleNamespace(ok=SimpleNamespace(payload=encode(ANSWER))))
        elif isinstance(handler, zenoh.handlers.Callback) and handler.drop is not None:
            handler.drop()

    network = meet(monkeypatch, alive_key("sim-test", "base", "1"))
    opened = network.open

    def open_(config: Any) -> Any:
        session = opened(config)
        session.get.side_effect = answer
        return session

    monkeypatch.setattr(zenoh, "open", open_)
    giraff("view", "--robot", "sim-test", "--save", "out.rrd", "--for", "8")
    assert drawn == expected


@pytest.mark.parametrize(
    ("tables", "expected"),
    [
        ({"robot": FILED | {"footprint_radius": 0.2}}, TOLD),
        ({}, STOCK_NOTE),
        ({"robot": {"track_width": "wide"}}, STOCK_NOTE),
    ],
)
def test_a_recording_is_drawn_by_its_own_tables_and_another_shape_is_named(
    giraff: Giraff, drawn: list[tuple[float, str]], tables: dict[str, Any], expected: tuple[float, str]
) -> None:
    said = stamped(odometry(1, 0.0), 0, 1, "1")
    with RecordingWriter(Path("drive.mcap"), ABOUT | {"tables": msgspec.json.encode(tables).decode()}) as writer:
        writer.add([RawSample(1, key_of("sim-test", ODOM), encode(said), encoding_of(type(said)))])
        writer.close("test")
    assert giraff("view", "drive.mcap", "--save", "out.rrd")[0] == 0
    assert drawn == [expected]


def test_a_robot_file_counts_for_its_own_robot_alone(
    monkeypatch: pytest.MonkeyPatch, giraff: Giraff, drawn: list[tuple[float, str]]
) -> None:
    copy(ROOT / "deploy" / "robot.toml", "robot.toml")
    monkeypatch.setenv("GIRAFF_CONFIG", "robot.toml")
    meet(monkeypatch)
    for robot in ("sim-test", "giraff"):
        giraff("view", "--robot", robot, "--save", "out.rrd", "--for", "2")
    assert [note for _, note in drawn] == [STOCK_NOTE[1], "drawn by the file robot.toml"]

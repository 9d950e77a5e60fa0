"""`giraff commission`: the order of the steps, and what a robot file tells of each."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import tomlkit

from giraff_cli.commission.steps import STEPS
from giraff_core.robot import WIRING
from giraff_sim.board import ROOT
from tests.unit.cli.typed import typed

STOCK = (ROOT / "deploy" / "robot.toml").read_text(encoding="utf-8")
TITLES = [step.title for step in STEPS]


def standings(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, dict[str, str]]:
    code, out, err = typed(monkeypatch, capsys, "commission", "--file", str(path), "--json")
    assert not err
    told = json.loads(out)
    assert told["robot_file"] == str(path)
    return code, {row["step"]: row["standing"] for row in told["steps"]}


def test_the_page_has_the_steps_in_their_order() -> None:
    page = (ROOT / "docs" / "commissioning.md").read_text(encoding="utf-8")
    headings = re.findall(r"^## (\d+\. .*)$", page, re.MULTILINE)
    assert headings == [f"{number}. {title}" for number, title in enumerate(TITLES, 1)]


def test_what_is_left_is_told_until_the_file_has_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "robot.toml"
    path.write_text(STOCK, encoding="utf-8")
    code, told = standings(path, monkeypatch, capsys)
    assert (code, list(told)) == (1, TITLES)
    assert [title for title, standing in told.items() if standing == "done"] == ["Boards and ports"]
    _, out, _ = typed(monkeypatch, capsys, "commission", "--file", str(path))
    assert f"{path}: 8 left. Next: how the wheels are wired, by giraff check wheels." in " ".join(out.split())

    document = tomlkit.parse(STOCK)
    drive = {**dict.fromkeys(WIRING, False), "battery_volts_per_count": 0.03, "wheel_control": "speed"}
    document["base"]["drive"].update(drive)
    document["base"]["drive"]["speed_control"]["speed_p"] = 160.0
    document["robot"]["calibration"] = {"date": "2026-11-28"}
    for sensor in document["robot"]["sensors"].values():
        sensor["distortion" if sensor.get("type") == "camera" else "scale"] = 1.0
    document["joystick"]["mount_yaw"] = 0.0
    document["guard"]["deceleration"] = 0.8
    path.write_text(tomlkit.dumps(document), encoding="utf-8")
    code, told = standings(path, monkeypatch, capsys)
    assert (code, set(told.values())) == (0, {"done", "look"})


def test_a_robot_that_balances_has_no_steps_of_wheels(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    _, told = standings(ROOT / "deploy" / "robots" / "balancer.toml", monkeypatch, capsys)
    assert not {"What the encoders give", "Speeds that are held"} & told.keys()
    assert told["The battery"] == "done"


def test_a_file_that_is_none_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "robot.toml"
    for text in ("[robot\n", None):
        path.unlink(missing_ok=True)
        if text is not None:
            path.write_text(text, encoding="utf-8")
        code, out, err = typed(monkeypatch, capsys, "commission", "--file", str(path))
        assert (code, out) == (2, "")
        assert str(path) in err

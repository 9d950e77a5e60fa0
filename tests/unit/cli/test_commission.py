"""`giraff commission`: the order of the steps, and what a robot file tells of each."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
import tomlkit

from giraff_core.robot import WIRING
from giraff_setup.commission.steps import STEPS
from giraff_sim.board import ROOT
from tests.unit.cli.typed import Giraff

STOCK = (ROOT / "deploy" / "robot.toml").read_text(encoding="utf-8")
BUILT = "docs/build-on-two-wheels.md"
TITLES = [step.title for step in STEPS]


def statuses(path: Path, giraff: Giraff) -> tuple[int, dict[str, str], dict[str, dict[str, str]]]:
    code, out, err = giraff("commission", "--file", str(path), "--json")
    assert not err
    told = json.loads(out)
    assert told["robot_file"] == str(path)
    rows = {row["step"]: row for row in told["steps"]}
    return code, {title: row["status"] for title, row in rows.items()}, rows


def done() -> tomlkit.TOMLDocument:
    """Return the file of a robot that has gone through all steps."""
    document = tomlkit.parse(STOCK)
    drive = {**dict.fromkeys(WIRING, False), "battery_volts_per_count": 0.03, "wheel_control": "speed"}
    document["base"]["drive"].update(drive)
    document["base"]["drive"]["speed_control"]["speed_p"] = 160.0
    document["base"].update(battery_low=22.0, battery_cutoff=20.0)
    document["robot"]["calibration"] = {"date": "2026-11-28"}
    for sensor in document["robot"]["sensors"].values():
        sensor.update({"distortion": [0.0] * 5} if sensor.get("type") == "camera" else {"scale": 1.0})
    document["joystick"]["mount_yaw"] = 0.0
    document["guard"]["deceleration"] = 0.8
    return document


def test_the_page_has_the_steps_in_their_order() -> None:
    page = (ROOT / "docs" / "commissioning.md").read_text(encoding="utf-8")
    headings = re.findall(r"^## (\d+\. .*)$", page, re.MULTILINE)
    assert headings == [f"{number}. {title}" for number, title in enumerate(TITLES, 1)]


def test_what_is_left_is_told_until_the_file_has_it(tmp_path: Path, giraff: Giraff) -> None:
    path = tmp_path / "robot.toml"
    path.write_text(STOCK, encoding="utf-8")
    code, told, _ = statuses(path, giraff)
    assert (code, list(told)) == (1, TITLES)
    assert "done" not in told.values()
    _, out, _ = giraff("commission", "--file", str(path))
    assert f"{path}: 8 left. Next: before the motors have power, by docs/commissioning.md." in " ".join(out.split())

    path.write_text(tomlkit.dumps(done()), encoding="utf-8")
    code, told, rows = statuses(path, giraff)
    assert (code, set(told.values())) == (0, {"done", "look"})
    assert told["Before the motors have power"] == "done"
    assert "ticks_per_metre is 2002.0594: is that 2 * pulses" in rows["Boards and ports"]["why"]


def test_a_robot_that_balances_has_no_steps_of_wheels(giraff: Giraff) -> None:
    _, told, rows = statuses(ROOT / "deploy" / "robots" / "balancer.toml", giraff)
    assert not {"What the encoders give", "Speeds that are held"} & told.keys()
    assert told["The battery"] == "done"
    assert rows["How the wheels are wired"]["how"] == "docs/build-a-balancer.md"
    assert rows["The battery"]["number"] == "8", "as on the page"
    assert told["Before the motors have power"] == "done"
    assert "ticks_per_metre" not in rows["Boards and ports"]["why"]


@pytest.mark.parametrize(
    ("name", "page"), [("ardros", "docs/commissioning.md"), ("mega_l298n", BUILT), ("mega_bts7960", BUILT)]
)
def test_a_board_whose_lines_float_in_reset_needs_pull_downs(giraff: Giraff, name: str, page: str) -> None:
    _, told, rows = statuses(ROOT / "deploy" / "robots" / f"{name}.toml", giraff)
    row = rows["Before the motors have power"]
    assert (row["status"], row["how"]) == ("look", page)
    assert "V: your battery's? 10 kohm to ground" in row["why"]
    assert "What the encoders give" not in told, "its channel B raises no interrupt"


def test_a_board_that_is_a_process_alone_opens_its_controllers_port(giraff: Giraff) -> None:
    why = statuses(ROOT / "deploy" / "robots" / "roboclaw.toml", giraff)[2]["Boards and ports"]["why"]
    assert "made by giraff-board@roboclaw, which alone opens" in why
    assert "is that 4 * pulses" in why, "a RoboClaw counts the edges of both channels"


def test_a_battery_that_the_file_only_half_tells_is_left(tmp_path: Path, giraff: Giraff) -> None:
    path = tmp_path / "robot.toml"
    document = done()
    del document["base"]["battery_cutoff"]
    path.write_text(tomlkit.dumps(document), encoding="utf-8")
    _, told, rows = statuses(path, giraff)
    assert [title for title, status in told.items() if status == "left"] == ["Before the motors have power"]
    assert "[base] has no battery_cutoff: the defaults" in rows["Before the motors have power"]["why"]


@pytest.mark.parametrize(
    ("fields", "steps", "why"),
    [
        (
            {"base.drive.invert_left_motor": "maybe"},
            ("Boards and ports", "How the wheels are wired", "What the encoders give", "The battery"),
            "[base]: drive.invert_left_motor must be true or false or none, and is text",
        ),
        ({"base.drive.battery_volts_per_count": "lots"}, ("The battery",), "battery_volts_per_count must be a number"),
        ({"base.drive.type": "weels"}, ("What the encoders give", "Speeds that are held"), "did you mean 'wheels'?"),
        (
            {"base.drive.board": "ardros", "robot.max_wheel_speed": 5.0, "robot.ticks_per_metre": 2e5},
            ("Boards and ports",),
            "the board ardros counts",
        ),
        ({"guard.deceleration": float("nan")}, ("How well it brakes",), "deceleration is nan: it must be within"),
        ({"robot.name": ["x"]}, ("Boards and ports", "Odometry", "Sensors by a wall"), "name must be text"),
        ({"robot.sensors": 3}, ("Sensors by a wall", "The camera"), "sensors"),
        ({"joystick.mount_yaw": 90.0}, ("The joystick's level and axes",), "are these degrees?"),
        ({"ranger.port": 3}, ("Boards and ports",), "port must be text"),
        ({"rangr": {}}, ("Boards and ports",), "unknown table [rangr]; did you mean 'ranger'?"),
    ],
)
def test_what_the_services_refuse_is_left_with_the_reason(
    tmp_path: Path, giraff: Giraff, fields: dict[str, Any], steps: tuple[str, ...], why: str
) -> None:
    path = tmp_path / "robot.toml"
    document = done()
    for place, value in fields.items():
        *tables, name = place.split(".")
        within: Any = document
        for table in tables:
            within = within[table]
        within[name] = value
    path.write_text(tomlkit.dumps(document), encoding="utf-8")
    code, _, rows = statuses(path, giraff)
    left = {title: row["why"] for title, row in rows.items() if row["status"] == "left"}
    assert code == 1
    assert left.keys() >= set(steps)
    assert all(why in left[title] for title in steps), left


@pytest.mark.parametrize(
    ("text", "why"), [("", "[base]: `port` is missing"), ('[base]\nport = "x"', "there is no [base.drive]")]
)
def test_a_file_that_says_nothing_of_the_drive_hides_no_step(
    tmp_path: Path, giraff: Giraff, text: str, why: str
) -> None:
    path = tmp_path / "robot.toml"
    path.write_text(text, encoding="utf-8")
    _, told, rows = statuses(path, giraff)
    assert list(told) == TITLES
    assert why in rows["How the wheels are wired"]["why"]
    look = ["The joystick's level and axes", "First start", "Before it is left to others"]
    assert [title for title, status in told.items() if status == "look"] == look
    assert "done" not in told.values()


def test_a_file_that_is_none_is_named(tmp_path: Path, giraff: Giraff) -> None:
    path = tmp_path / "robot.toml"
    for text in ("[robot\n", None):
        path.unlink(missing_ok=True)
        if text is not None:
            path.write_text(text, encoding="utf-8")
        code, out, err = giraff("commission", "--file", str(path))
        assert (code, out) == (2, "")
        assert str(path) in err

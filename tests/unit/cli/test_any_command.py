"""What holds of every `giraff` command: no robot, two robots, another robot, a key that is not there."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import typer.main

from giraff_cli.main import app
from giraff_node.network import tokens
from giraff_schemas.topics import alive_key
from tests.rules.repository import ROOT
from tests.unit.cli.quiet_network import alone, meet
from tests.unit.cli.typed import Giraff

Words = tuple[str, ...]
DRIVE = ROOT / "tests" / "unit" / "replay" / "data" / "drive.mcap"
SERVICES = ("base", "guard", "joystick", "odometry", "ranger")

STOPS = ("stop", "estop engage")
ASKING: dict[str, Words] = {
    "why": (),
    "watch": ("--for", "3"),
    "drive": (),
    "web": (),
    "ros2": (),
    "localize": (),
    "map make": ("FILE", "--for", "4"),
    "place add": ("kitchen", "-1,0,-1.57rad"),
    "place list": (),
    "place remove": ("kitchen",),
    "place forbid": ("-1,0", "-1,2"),
    "estop status": (),
    "estop reset": (),
    "stop": (),
    "estop engage": (),
    "topic list": (),
    "topic info": ("odom",),
    "topic echo": ("odom", "--for", "3"),
    "topic hz": ("odom", "--for", "1"),
    "topic bw": ("--for", "1"),
    "node list": (),
    "node info": ("base",),
    "graph": (),
    "frames": (),
    "top": ("--for", "3"),
    "param list": ("odometry",),
    "param get": ("guard.margin",),
    "param describe": ("guard.margin",),
    "param set": ("guard.margin", "0.25"),
    "param save": ("guard.margin",),
    "odom reset": (),
    "odom set": ("-1,0,-1.57rad",),
    "move": ("-1.0",),
    "turn": ("-90deg",),
    "arc": ("1", "90deg"),
    "go": (str(ROOT / "deploy" / "patterns" / "square.toml"),),
    "camera list": (),
    "camera view": ("--save", "FILE"),
    "doctor": (),
    "record": ("--for", "4", "-o", "FILE"),
    "view": ("--for", "4", "--save", "FILE", "--json"),
}
"""Every command that asks a robot, with what it needs to be of use, and to end by itself.

FILE is one that is not there yet.
"""
NO_SUCH_TOPIC = "nobody publishes odmo on sim-test; did you mean odom? published there: "
NO_SUCH_SERVICE = "no such service is heard of sim-test; did you mean guard? there are base, guard, "
ELSEWHERE = "tests/functional/desk/test_param.py: the robot tells what it has"
UNKNOWN: Mapping[str, tuple[Words, str]] = {
    "topic info": (("odmo",), NO_SUCH_TOPIC),
    "topic echo": (("odmo",), NO_SUCH_TOPIC),
    "topic hz": (("odmo",), NO_SUCH_TOPIC),
    "topic bw": (("odmo",), NO_SUCH_TOPIC),
    "topic pub": (("odmo", "{}", "--robot", "sim-test"), "nobody listens to it; did you mean odom?"),
    "node info": (("gard",), "no service 'gard' on the network; did you mean guard? there are: base, guard, "),
    "camera view": (("eye", "--save", "FILE"), "no camera of sim-test is heard; check that giraff_camera runs"),
    "param set": (("gaurd.margin", "0.5", "--robot", "sim-test"), NO_SUCH_SERVICE),
    "param save": (("gaurd.margin", "--robot", "sim-test"), NO_SUCH_SERVICE),
    "record": (("--topics", "odmo"), "no such topic; did you mean odom? there are tick, "),
    "play": ((str(DRIVE), "--topics", "odmo"), "has no such key; did you mean odom? it has base, "),
}
"""Commands that take a key or a name of something the robot has, with one that it has not, and what they say."""
UNKNOWN_ELSEWHERE: Mapping[str, str] = {"param list": ELSEWHERE, "param get": ELSEWHERE, "param describe": ELSEWHERE}
ROBOTLESS: Mapping[str, str] = {
    "topic pub": "functional/one_robot/test_topics.py: it speaks for a robot that is not there, and has to be named",
    "play": "functional/one_robot/test_recordings.py: likewise",
    "replay": "unit/replay: it asks a file",
    "logs": "functional/cli/test_logs.py: it asks this host",
    "vision": "unit/cli/test_vision.py: likewise",
    "run": "functional/robot/test_run.py: it brings its robot along",
    "dst": "dst: likewise",
    "check wheels": "unit/setup/test_check_wheels.py: it asks a board, and whoever stands beside it",
    "check encoders": "unit/setup/test_check_encoders.py: likewise",
    "completion": "functional/cli/test_shells.py: it asks nobody",
    "calibrate camera": "unit/setup/test_camera.py: likewise",
    "calibrate joystick": "unit/setup/test_joystick.py: likewise",
    "calibrate ranger": "unit/setup/test_ranger.py: likewise",
    "calibrate scan": "unit/setup/test_scan.py: likewise",
    "commission": "unit/cli/test_commission.py: it asks a file",
    "camera board": "unit/setup/test_camera.py: it asks nobody",
    "encoder disk": "unit/cli/test_encoder_disk.py: it asks nobody",
    "calibrate odometry": "unit/setup: it asks files, or goes through it with whoever drives",
    "keys init": "unit/keys: it asks a folder",
    "keys host": "likewise",
    "keys list": "likewise",
    "map show": "unit/maps: it asks a file",
    "map convert": "likewise",
    "tune balance": "unit/cli/test_gains.py: likewise",
    "tune speed": "unit/cli/test_tune_speed.py: it goes through it with whoever stands beside the robot",
}
"""Those that ask no robot, and where below tests/ they are tried."""
WAITING = {"watch", "record", "view", "drive", "web", "ros2", "map make"}
"""They say so while they wait, and in the end."""


def whole_commands() -> dict[str, Any]:
    """Of the whole command line."""
    found: dict[str, Any] = {}

    def walk(command: Any, words: Words) -> None:
        for name, inner in getattr(command, "commands", {}).items():
            walk(inner, (*words, name))
        if not hasattr(command, "commands"):
            found[" ".join(words)] = command

    walk(typer.main.get_command(app), ())
    return found


def test_no_command_is_left_out() -> None:
    assert set(whole_commands()) == set(ASKING) | set(ROBOTLESS)
    naming = {"key", "topics", "name", "names", "service"}
    takers = {path for path, it in whole_commands().items() if naming & {parameter.name for parameter in it.params}}
    assert {path for path in takers if not path.startswith("keys ")} == set(UNKNOWN) | set(UNKNOWN_ELSEWHERE)


@pytest.fixture
def say(monkeypatch: pytest.MonkeyPatch, giraff: Giraff, tmp_path: Path) -> Giraff:
    """Types a command on a host that knows of no robot: exit code, output and complaint."""
    alone(monkeypatch, tmp_path)

    def say(path: str, words: Words, *more: str) -> tuple[int, str, str]:
        given = (str(tmp_path / "new") if word == "FILE" else word for word in words)
        return giraff(*path.split(), *given, *more)

    return say


def told(path: str, done: tuple[int, str, str]) -> str:
    """What a command that could do nothing says, in one line on standard error; the first of one that waits."""
    code, out, complaint = done
    if path == "doctor":  # to whom that is a finding like others
        assert (code, complaint) == (1, "")
        return out
    assert code == 2
    first, *more = complaint.splitlines()
    if path in WAITING:
        return next(line for line in (first, *more) if line.startswith("giraff: "))
    assert (more, out) == ([], "")
    return first


@pytest.mark.parametrize("path", ASKING)
def test_with_no_robot_it_says_so(path: str, say: Giraff, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    network = meet(monkeypatch)
    said = told(path, say(path, ASKING[path]))
    assert network.opened == 1
    assert "no robot is heard" in said
    assert "give --connect " in said or path == "doctor"
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("path", [path for path in ASKING if path not in STOPS])
def test_with_two_robots_it_lists_them(path: str, say: Giraff, monkeypatch: pytest.MonkeyPatch) -> None:
    """And leaves out names that no robot can have, which a stranger may declare."""
    monkeypatch.setattr(tokens, "_told", set())
    two = (alive_key("sim-other", "base", "1"), alive_key("sim-test", "base", "2"))
    meet(monkeypatch, "giraff/a b/alive/base/x", *two, "giraff/**", "giraff/\x1b]0;x\a/alive/base/x")
    code, out, complaint = say(path, ASKING[path])
    *left_out, said = complaint.splitlines()
    options = "--robot sim-other, --robot sim-test"
    assert said == f"giraff: several robots are on the network; name one: {options} (or GIRAFF_ROBOT_NAME)"
    assert [line.partition(", left out: ")[2] for line in left_out] == [
        "'giraff/a b/alive/base/x'",
        "'giraff/**'",
        r"'giraff/\x1b]0;x\x07/alive/base/x'",
    ]
    assert (code, out) == (2, "")


@pytest.mark.parametrize("path", [path for path in ASKING if path not in STOPS])
def test_a_robot_that_is_not_there_is_named_with_those_that_are(
    path: str, say: Giraff, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    meet(monkeypatch, alive_key("sim-test", "base", "1"))
    said = told(path, say(path, ASKING[path], "--robot", "otto"))
    assert "otto" in said
    assert "--robot sim-test" in said or path == "doctor"
    assert not (tmp_path / "new").exists() or path == "view"


@pytest.mark.parametrize("path", UNKNOWN)
def test_what_the_robot_has_not_is_told_with_what_it_has(
    path: str, say: Giraff, monkeypatch: pytest.MonkeyPatch
) -> None:
    meet(monkeypatch, *(alive_key("sim-test", service, service) for service in SERVICES))
    words, expected = UNKNOWN[path]
    code, out, complaint = say(path, words)
    assert (code, out) == (2, "")
    [line] = complaint.splitlines()
    assert expected in line


def test_a_mistyped_robot_is_told_with_the_one_that_was_meant(say: Giraff, monkeypatch: pytest.MonkeyPatch) -> None:
    meet(monkeypatch, alive_key("sim-test", "base", "1"))
    said = told("why", say("why", (), "--robot", "sim-tset"))
    assert "did you mean sim-test? on the network: --robot sim-test" in said

"""Where robot file or environment cannot tell the network or the robot, no command opens a session: it is refused.

A session of another kind than the robot's meets whoever else is there, and a stranger's robot of the same name would
obey, and confirm, in its place.
"""

from __future__ import annotations

import gc
from pathlib import Path
from typing import Any, Never

import pytest
import typer.main
import zenoh

import giraff_cli.record
from giraff_cli.main import app
from giraff_client import NoRobotError, Robot
from tests.rules.repository import ROOT
from tests.unit.cli.typed import typed

DRIVE = str(ROOT / "tests" / "desk" / "data" / "drive.mcap")
WORDS: dict[str, tuple[str, ...]] = {
    "topic info": ("odom",),
    "topic echo": ("odom",),
    "topic pub": ("battery", '{"voltage": 24.1}'),
    "node info": ("base",),
    "param get": ("guard.margin",),
    "param describe": ("guard.margin",),
    "param set": ("guard.margin", "0.25"),
    "param save": ("guard.margin",),
    "play": (DRIVE,),
    "view": ("--for", "1", "--save", "FILE", "--json"),
    "run": ("--local", "--for", "1", "--boards", "host"),
}
"""What a command must be given besides its name."""
SESSIONLESS = {"check wheels", "dst", "keys init", "keys host", "keys list", "replay"}
"""Those that open no session."""
GOES_ON = "doctor"
"""It is asked what is wrong."""

FAULTS: dict[str, tuple[str | None, dict[str, str], str]] = {
    "a mode of the environment": (
        "",
        {"GIRAFF_NETWORK_MODE": "secure"},
        "GIRAFF_NETWORK_MODE of the environment): Invalid enum value 'secure' - at `$.mode`; did you mean 'secured'?",
    ),
    "a mode of the environment, and no file": (
        None,
        {"GIRAFF_NETWORK_MODE": "secure"},
        "environment: table [network] (with GIRAFF_NETWORK_MODE of the environment): Invalid enum value 'secure'",
    ),
    "a mode of the file": ('[network]\nmode = "secure"', {}, "robot.toml: table [network]: Invalid enum value"),
    "a secured network without access": ('[network]\nmode = "secured"', {}, "[network.access] names no host"),
    "a field that is none": ('[network]\nmod = "secured"', {}, "unknown field `mod`; did you mean 'mode'?"),
    "a variable that is none": ("", {"GIRAFF_NETWORK_MDOE": "secured"}, "did you mean 'mode'?"),
    "a value for a table": ("network = 3", {}, "network is a value where the table [network] belongs"),
    "a table of another name": (
        '[netwrok]\nmode = "secured"',
        {},
        "unknown table [netwrok]; did you mean 'network'?",
    ),
    "a table in capitals": ('[NETWORK]\nmode = "secured"', {}, "unknown table [NETWORK]"),
    "a table of a field of it": ('[lan]\nmode = "secured"', {}, "unknown table [lan]"),
    "a field in no table": ('mode = "secured"', {}, "unknown table [mode]"),
    "a table of a variable": ("", {"GIRAFF_NETWROK_MODE": "secured"}, "GIRAFF_NETWROK_MODE: names no field"),
    "a variable without its table": ("", {"GIRAFF_MODE": "secured"}, "GIRAFF_MODE: names no field"),
    "a variable without its field": ("", {"GIRAFF_NETWORK": "secured"}, "GIRAFF_NETWORK: names no field"),
    "a list that is none": ("", {"GIRAFF_NETWORK_CONNECT": '["a"'}, "GIRAFF_NETWORK_CONNECT: not a list"),
    "the syntax": ("[network", {}, "robot.toml: not TOML"),
    "a file that is not there": (None, {"GIRAFF_CONFIG": "nowhere.toml"}, "no robot file at"),
    "a folder": (None, {"GIRAFF_CONFIG": "."}, "no robot file at"),
    "a name of the environment": ("", {"GIRAFF_ROBOT_NAME": "a/b"}, "'a/b' cannot be part of a key"),
    "no name of the environment": ("", {"GIRAFF_ROBOT_NAME": ""}, "'' cannot be part of a key"),
    "a name of the file": ('[robot]\nname = "a/b"', {}, "robot.toml: table [robot]: name: 'a/b' cannot be part of a"),
    "a name that is a number": ("[robot]\nname = 3", {}, "robot.toml: table [robot]: name: give a text, not 3"),
    "a name by another name": ('[robot]\nnmae = "x"', {}, "unknown field `nmae`; did you mean 'name'?"),
    "a variable of a name by another name": ("", {"GIRAFF_ROBOT_NMAE": "x"}, "GIRAFF_ROBOT_NMAE of the environment"),
}
"""By what is wrong: the robot file (None: there is none), the environment, and what is told."""


@pytest.fixture
def opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The sessions that are opened; none comes about."""
    found: list[str] = []

    def refuse(config: Any) -> Never:
        found.append(str(config))
        raise zenoh.ZError("none is opened here")

    monkeypatch.setattr(zenoh, "open", refuse)
    monkeypatch.setattr(giraff_cli.record, "step_back", lambda: None)  # it is for the whole process
    monkeypatch.setattr(gc, "freeze", lambda: None)
    monkeypatch.chdir(tmp_path)
    for name in ("GIRAFF_CONFIG", "GIRAFF_ROBOT_NAME"):
        monkeypatch.delenv(name, raising=False)
    return found


def settle(monkeypatch: pytest.MonkeyPatch, directory: Path, fault: str) -> str:
    """Make that wrong; what is told of it."""
    text, variables, told = FAULTS[fault]
    if text is not None:
        path = directory / "robot.toml"
        path.write_text(text)
        monkeypatch.setenv("GIRAFF_CONFIG", str(path))
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    return told


def all_commands() -> list[str]:
    """Of the whole command line."""
    found: list[str] = []

    def walk(command: Any, words: tuple[str, ...]) -> None:
        for name, inner in getattr(command, "commands", {}).items():
            walk(inner, (*words, name))
        if not hasattr(command, "commands"):
            found.append(" ".join(words))

    walk(typer.main.get_command(app), ())
    return found


def with_session() -> list[str]:
    everything = all_commands()
    assert set(everything) >= {*WORDS, *SESSIONLESS, GOES_ON}
    return sorted({*everything} - SESSIONLESS)


@pytest.mark.parametrize("command", with_session())
def test_each_of_them_opens_one_where_all_is_sound(
    command: str, tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """So that the next test can fail."""
    words = [str(tmp_path / "new") if word == "FILE" else word for word in WORDS.get(command, ())]
    monkeypatch.setenv("GIRAFF_NETWORK_LOCAL", "true")
    monkeypatch.setenv("GIRAFF_ROBOT_NAME", "sim-test")
    typed(monkeypatch, capsys, *command.split(), *words)
    assert len(opened) == 1


@pytest.mark.parametrize("fault", ["a mode of the environment", "the syntax"])
@pytest.mark.parametrize("command", [each for each in with_session() if each != GOES_ON])
def test_no_command_opens_a_session(
    command: str,
    fault: str,
    tmp_path: Path,
    opened: list[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    told = settle(monkeypatch, tmp_path, fault)
    words = [str(tmp_path / "new") if word == "FILE" else word for word in WORDS.get(command, ())]
    code, out, err = typed(monkeypatch, capsys, *command.split(), *words)
    assert (code, out, opened) == (2, "", [])
    [line] = err.splitlines()
    assert line.startswith("giraff")
    assert told in line or command == "run"  # which reads all of the robot first


@pytest.mark.parametrize("fault", FAULTS)
def test_no_fault_of_network_or_name_lets_a_stop_go_astray(
    fault: str, tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    told = settle(monkeypatch, tmp_path, fault)
    code, out, err = typed(monkeypatch, capsys, "estop", "engage")
    assert (code, out, opened) == (2, "", [])
    [line] = err.splitlines()
    assert told in line
    assert "NOTHING IS STOPPED: use the battery switch, or " in line
    assert "GIRAFF_CONFIG=/dev/null" in line


@pytest.mark.parametrize("fault", FAULTS)
def test_nor_lets_it_a_script(fault: str, tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    told = settle(monkeypatch, tmp_path, fault)
    with pytest.raises(NoRobotError) as refused, Robot():
        pass
    assert told in str(refused.value)
    assert "correct it" in str(refused.value)
    assert opened == []


@pytest.mark.parametrize("fault", FAULTS)
def test_doctor_goes_on_and_tells_it(
    fault: str, tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    told = settle(monkeypatch, tmp_path, fault)
    code, out, err = typed(monkeypatch, capsys, "doctor")
    assert (code, err, opened) == (1, "", [])
    lines = out.splitlines()
    [number] = [number for number, line in enumerate(lines) if line.startswith("FAULT    robot file: ")]
    assert told in lines[number] + "; " + lines[number + 1].removeprefix("         -> ")
    assert any(line.startswith("FAULT    network: no robot is heard: ") for line in lines)


@pytest.mark.parametrize(
    ("text", "variables", "told"),
    [
        ("[gaurd]\nmargin = 1.0", {}, "unknown table [gaurd]; did you mean 'guard'?"),
        ("guard = 3", {}, "guard is a value where the table [guard] belongs"),
        ("", {"GIRAFF_SPEED": "1"}, "GIRAFF_SPEED: names no field"),
        ("", {"GIRAFF_GUARD_PRIORITIES": "{ joystick }"}, "GIRAFF_GUARD_PRIORITIES: not a table"),
    ],
)
def test_what_is_wrong_elsewhere_stops_nobody_from_stopping_a_robot(
    text: str,
    variables: dict[str, str],
    told: str,
    tmp_path: Path,
    opened: list[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / "robot.toml"
    path.write_text(text + '\n[network]\nrendezvous = "127.0.0.1:9"\n')
    for name, value in {"GIRAFF_CONFIG": str(path), **variables}.items():
        monkeypatch.setenv(name, value)
    _, _, err = typed(monkeypatch, capsys, "estop", "engage", "--robot", "anne")
    [warning, _] = err.splitlines()
    assert warning.startswith("giraff: not everything of robot file and environment counts: ")
    assert told in warning
    [session] = opened
    assert "127.0.0.1:9" in session, "what is sound of the file counts"


@pytest.mark.parametrize("fault", ["a name of the environment", "a name of the file", "a name by another name"])
def test_a_name_that_does_not_count_is_no_reason(
    fault: str, tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    settle(monkeypatch, tmp_path, fault)
    typed(monkeypatch, capsys, "estop", "engage", "--robot", "anne")
    assert len(opened) == 1

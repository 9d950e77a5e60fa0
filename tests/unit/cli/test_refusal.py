"""Where robot file or environment cannot tell the network or the robot, no command opens a session: it is refused.

A session of another kind than the robot's meets whoever else is there, and a stranger's robot of the same name would
obey, and confirm, in its place.
"""

from pathlib import Path
from typing import Any, Never

import pytest
import zenoh

from giraff_client import NoRobotError, Robot
from giraff_node.config.robot_file import ConfigError
from giraff_node.network.discovery import resolve_target
from giraff_schemas.services import ROBOT_TABLES
from tests.rules.repository import ROOT
from tests.unit.cli.quiet_network import alone
from tests.unit.cli.test_any_command import ASKING, DRIVE, ROBOTLESS, whole_commands
from tests.unit.cli.typed import Giraff

WORDS: dict[str, tuple[str, ...]] = {
    **ASKING,
    "topic pub": ("battery", '{"voltage": 24.1}'),
    "play": (str(DRIVE),),
    "run": ("--local", "--for", "1", "--boards", "host"),
}
"""What a command must be given besides its name."""
WITH_SESSION = {
    *("topic pub", "play", "run", "tune speed"),
    *("calibrate camera", "calibrate odometry", "calibrate ranger", "calibrate scan"),
}
"""Those of ROBOTLESS that open one."""
GOES_ON = "doctor"
"""It is asked what is wrong."""

FAULTS: dict[str, tuple[str | None, dict[str, str], str]] = {
    "a mode of the environment": (
        "",
        {"GIRAFF_NETWORK_MODE": "secure"},
        "GIRAFF_NETWORK_MODE of the environment): mode cannot be 'secure'; did you mean 'secured'?",
    ),
    "a mode of the environment, and no file": (
        None,
        {"GIRAFF_NETWORK_MODE": "secure"},
        "environment: table [network] (with GIRAFF_NETWORK_MODE of the environment): mode cannot be 'secure'",
    ),
    "a mode of the file": ('[network]\nmode = "secure"', {}, "robot.toml: table [network]: mode cannot be"),
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
    "a name by another name": ('[robot]\nnmae = "x"', {}, "unknown field `nmae`; did you mean 'name' of [robot]?"),
    "a variable of a name by another name": ("", {"GIRAFF_ROBOT_NMAE": "x"}, "GIRAFF_ROBOT_NMAE of the environment"),
    "a number without end": (f"[guard]\nmargin = {'9' * 5000}", {}, "robot.toml: not TOML: it has a number that no"),
    "a number of 65 bits": (
        f"[network]\nmode = 0x1{'0' * 16}",
        {},
        "robot.toml: not TOML: 18446744073709551616 is beyond 64",
    ),
    "lists without end": (f"x = {'[' * 2000}", {}, "robot.toml: not TOML: it is nested too deeply"),
    "tables without end": (f"x = {'{a=' * 2000}", {}, "robot.toml: not TOML: it is nested too deeply"),
    "a header without end": (f"[guard{'.a' * 2000}]", {}, "robot.toml: not TOML: it is nested too deeply"),
    "a variable without end": ("", {"GIRAFF_NETWORK_CONNECT": "[" * 2000}, "not a list as TOML has it: it is nested"),
    "a number without end in a variable": ("", {"GIRAFF_NETWORK_CONNECT": f"[{'9' * 5000}]"}, "CONNECT: not a list"),
    "a variable with more behind": ("", {"GIRAFF_NETWORK_ACCESS": "{}\nx = 3"}, "one value, and nothing behind it"),
    "a mode above its table": (
        '[robot.sensors.rear]\nindex = 2\nmode = "secured"\n[network]',
        {},
        "robot.toml: table [robot]: unknown field `sensors.rear.mode`; did you mean 'mode' of [network]?",
    ),
    "a mode of the robot": ('[robot]\nmode = "secured"', {}, "unknown field `mode`; did you mean 'mode' of [network]?"),
    "a mode of a service": ('[guard]\nmode = "secured"', {}, "table [guard]: unknown field `mode`"),
    "a mode among the priorities": ('[guard.priorities]\ncarer = 2\nmode = "secured"', {}, "`priorities.mode`"),
    "a table among the priorities": ('[guard.priorities.network]\nmode = "secured"', {}, "`priorities.network`"),
    "a mistyped mode of a service": ('[base]\nmdoe = "secured"', {}, "`mdoe`; did you mean 'mode' of [network]?"),
    "a mode in a list": ('[[sim.rooms]]\nmode = "secured"', {}, "`rooms.mode`"),
    "a network of the robot": ("[robot.network]", {}, "unknown field `network`; did you mean the table [network]?"),
    "a network of a service": ("[base.network]", {}, "table [base]: unknown field `network`"),
    "a network of the simulation": ("[sim.network]", {}, "table [sim]: unknown field `network`"),
    "a network without its header": ('[sim.truth]\nrendezvous = "127.0.0.1:9"', {}, "`truth.rendezvous`"),
    "a variable of another table": ("", {"GIRAFF_BASE_MODE": "secured"}, "GIRAFF_BASE_MODE of the environment"),
    "a variable of a table too many": ("", {"GIRAFF_ROBOT_NETWORK_MODE": "secured"}, "unknown field `network_mode`"),
    "a truth of another table": ("[security]\nsecured = true", {}, "unknown table [security]"),
    "a variable of a truth": ("", {"GIRAFF_SECURED": "1"}, "GIRAFF_SECURED: names no field"),
    "a robot's name": ('[robot]\nrobot_name = "kitchen"', {}, "unknown field `robot_name`; did you mean 'name' of"),
    "an id": ('[robot]\nid = "kitchen"', {}, "unknown field `id`; did you mean 'name' of [robot]?"),
    "a name of a service": ('[guard]\nname = "kitchen"', {}, "table [guard]: unknown field `name`"),
    "a name in no table": ('name = "kitchen"', {}, "unknown table [name]"),
    "a variable of an id": ("", {"GIRAFF_ROBOT_ID": "kitchen"}, "GIRAFF_ROBOT_ID of the environment"),
    "a variable of a name alone": ("", {"GIRAFF_NAME": "kitchen"}, "GIRAFF_NAME: names no field"),
    "a variable of the file": ("", {"GIRAFF_CONFIG_FILE": "x"}, "GIRAFF_CONFIG_FILE: names no field"),
    "a variable of the file in full": ("", {"GIRAFF_CONFIGURATION": "x"}, "GIRAFF_CONFIGURATION: names no field"),
    "a variable of files": ("", {"GIRAFF_CONFIGS": "x"}, "GIRAFF_CONFIGS: names no field"),
    "a variable of the robot's file": ("", {"GIRAFF_ROBOT_FILE": "x"}, "`file`; did you mean GIRAFF_CONFIG?"),
    "an animal": ("", {"GIRAFFE_NETWORK_MODE": "secured"}, "did you mean GIRAFF_NETWORK_MODE?"),
    "an animal with a name": ("", {"GIRAFFE_ROBOT_NAME": "x"}, "nobody reads it; did you mean GIRAFF_ROBOT_NAME?"),
    "half an animal": ("", {"GIRAF_ROBOT_NAME": "x"}, "GIRAF_ROBOT_NAME: nobody reads it"),
    "a variable in small letters": ("", {"giraff_network_mode": "secured"}, "giraff_network_mode: nobody reads it"),
    "a variable without a gap": ("", {"GIRAFFCONFIG": "x"}, "did you mean GIRAFF_CONFIG?"),
}
"""By what is wrong: the robot file (None: there is none), the environment, and what is told."""
SOME_FAULTS = ["a mode above its table", "a mode of the environment", "an animal", "the syntax"]
"""For what refuses by code of its own. All other commands are refused in one place, by the same text."""

LOOK_SECURED = ["a number of 65 bits", "a variable with more behind"]
"""By a mode that is none of an open network, and by rules: without the word."""


@pytest.fixture
def opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The sessions that are opened; none comes about."""
    found: list[str] = []

    def refuse(config: Any) -> Never:
        found.append(str(config))
        raise ConfigError("none is opened here")  # ZError: nobody is there, who may come yet

    monkeypatch.setattr(zenoh, "open", refuse)
    alone(monkeypatch, tmp_path)
    monkeypatch.delenv("GIRAFF_NETWORK_LOCAL")
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


def with_session() -> list[str]:
    return sorted({*whole_commands()} - ({*ROBOTLESS} - WITH_SESSION))


@pytest.mark.parametrize("command", with_session())
def test_each_of_them_opens_one_where_all_is_sound(
    command: str, tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    """So that the next test can fail."""
    words = [str(tmp_path / "new") if word == "FILE" else word for word in WORDS.get(command, ())]
    monkeypatch.setenv("GIRAFF_NETWORK_LOCAL", "true")
    monkeypatch.setenv("GIRAFF_ROBOT_NAME", "sim-test")
    giraff(*command.split(), *words)
    assert len(opened) == 1


@pytest.mark.parametrize(
    ("command", "fault"),
    [
        *((each, "a mode above its table") for each in with_session() if each != GOES_ON),
        *(("run", fault) for fault in SOME_FAULTS[1:]),
    ],
)
def test_no_command_opens_a_session(
    command: str, fault: str, tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    told = settle(monkeypatch, tmp_path, fault)
    words = [str(tmp_path / "new") if word == "FILE" else word for word in WORDS.get(command, ())]
    code, out, err = giraff(*command.split(), *words)
    assert (code, out, opened) == (2, "", [])
    [line] = err.splitlines()
    assert line.startswith("giraff")
    assert told in line or command == "run"  # which reads all of the robot first


def test_a_stop_is_tried_first_and_never_over_an_open_session_where_the_network_looks_secured(
    tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    """What it says of who answers: tests/unit/cli/test_estop.py. Which network is tried: test_stop_plan.py."""
    for fault in FAULTS:
        opened.clear()
        with monkeypatch.context() as patch:
            told = settle(patch, tmp_path, fault)
            code, out, err = giraff("estop", "engage")
        assert (code, out) == (2, ""), fault
        *_, line = err.splitlines()
        assert told in line, fault
        assert "use the battery switch, or without the file: " in line, fault
        assert "GIRAFF_CONFIG=/dev/null" in line, fault
        assert "NOTHING IS STOPPED: use the battery switch" in err, fault
        assert bool(opened) != (fault in LOOK_SECURED or "secur" in str(FAULTS[fault][:2]).lower()), fault


def test_nor_lets_it_a_script(tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    for fault in FAULTS:
        with monkeypatch.context() as patch:
            told = settle(patch, tmp_path, fault)
            with pytest.raises(NoRobotError) as refused, Robot():
                pass
            assert told in str(refused.value)
            assert "correct it" in str(refused.value), fault
            assert opened == [], fault


@pytest.mark.parametrize("fault", SOME_FAULTS)
def test_doctor_goes_on_and_tells_it(
    fault: str, tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    told = settle(monkeypatch, tmp_path, fault)
    code, out, err = giraff("doctor")
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
        ("", {"GIRAFF_ROBOT_SENSORS": "{a=" * 2000}, "GIRAFF_ROBOT_SENSORS: not a table"),
        ('[gateawy]\nname = "left"', {}, "unknown table [gateawy]; did you mean 'gateway'?"),
    ],
)
def test_what_is_wrong_elsewhere_stops_nobody_from_stopping_a_robot(
    text: str,
    variables: dict[str, str],
    told: str,
    tmp_path: Path,
    opened: list[str],
    monkeypatch: pytest.MonkeyPatch,
    giraff: Giraff,
) -> None:
    path = tmp_path / "robot.toml"
    path.write_text(text + '\n[network]\nrendezvous = "127.0.0.1:9"\n')
    for name, value in {"GIRAFF_CONFIG": str(path), **variables}.items():
        monkeypatch.setenv(name, value)
    _, _, err = giraff("estop", "engage", "--robot", "anne")
    *_, warning = err.splitlines()
    assert warning.startswith("giraff: not everything of robot file and environment counts: ")
    assert told in warning
    assert "127.0.0.1:9" in opened[0], "what is sound of the file counts"


def test_a_folder_that_is_gone_keeps_nobody_from_stopping_a_robot(
    tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    monkeypatch.setenv("GIRAFF_CONFIG", "robot.toml")
    code, out, err = giraff("estop", "engage")
    assert (code, out, len(opened)) == (2, "", 1)
    assert "robot.toml: cannot be read: No such file or directory; NOTHING IS STOPPED FOR SURE" in err


@pytest.mark.parametrize(
    ("text", "variables"),
    [
        ('[gateway]\nname = "left"\n[router]\nmode = "fixed"\nkeys = "/keys"', {}),
        ("[guard.priorities]\nmode = 1\nlocal = 2", {}),
        ("[guard]\nmargn = 1\nprioritis = 2\n[base]\nprot = 3\nmax_age = 5\nnoise = 6", {}),
        ('[robot.sensors.router]\nindex = 0\n[router.robots.network]\nrobot = ["pi"]', {}),
        (
            "",
            {"GIRAFF_GUARD_PRIORITIES": "{ local = 1 }", "GIRAFF_GATEWAY_NAME": "left", "GIRAFF_ROUTER_KEYS": "/keys"},
        ),
        ("", {"GIRAFFE_HOME": "/", "GRAFANA_NAME": "x", "TRAFFIC_MODE": "x", "ROBOT_NAME": "x", "NETWORK_MODE": "x"}),
        ("", {"CONFIG": "x", "GIRAFF_": "x"}),
    ],
)
def test_what_is_meant_for_nothing_else_raises_no_alarm(text: str, variables: dict[str, str], tmp_path: Path) -> None:
    path = tmp_path / "robot.toml"
    path.write_text(text)
    resolve_target(None, (), {"GIRAFF_CONFIG": str(path), **variables})


def test_nor_does_what_this_repository_brings() -> None:
    for path in (ROOT / "deploy" / "robot.toml", ROOT / "deploy" / "router" / "robot.toml"):
        for settings in (*(ROOT / "deploy" / "env").glob("*.env"), ROOT / "deploy" / "systemd" / "giraff.env"):
            lines = [line.removeprefix("#") for line in settings.read_text().splitlines()]
            variables = dict(line.split("=", 1) for line in lines if line.startswith("GIRAFF_") and "<" not in line)
            assert resolve_target(None, (), {"GIRAFF_CONFIG": str(path), **variables}).warning == ""


@pytest.mark.parametrize("table", sorted({*ROBOT_TABLES} - {"network", "router"}))
def test_no_table_takes_a_mode_that_is_not_its_own(table: str) -> None:
    with pytest.raises(ConfigError, match=rf"\[{table}\] .*: unknown field `mode`; did you mean 'mode' of \[network\]"):
        resolve_target("anne", (), {f"GIRAFF_{table.upper()}_MODE": "secured"})


@pytest.mark.parametrize(
    "fault",
    [
        "a name of the environment",
        "a name of the file",
        "a name by another name",
        "a robot's name",
        "a name of a service",
        "a name in no table",
        "a variable of a name alone",
    ],
)
def test_a_name_that_does_not_count_is_no_reason(
    fault: str, tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch, giraff: Giraff
) -> None:
    settle(monkeypatch, tmp_path, fault)
    giraff("estop", "engage", "--robot", "anne")
    assert len(opened) == 1

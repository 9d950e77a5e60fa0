"""Which robot a command takes where it was typed so: for those that look, those that move, and those that stop."""

import contextlib
import io
import socket
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple, Never

import pytest

from giraff_client import NoRobotError, Robot
from giraff_node.network import consent
from giraff_node.network.discovery import Target, simulated_name
from giraff_node.network.tokens import Token, robots_of
from giraff_schemas.topics import alive_key
from tests.unit.cli.quiet_network import alone, meet
from tests.unit.cli.test_refusal import WORDS, with_session
from tests.unit.cli.typed import typed

OWN = simulated_name(socket.gethostname())
OTHER = "sim-elsewhere"
REAL = "giraff"
FILE = "deploy/robot.toml"

LOOKS = ("estop", "status")
MOVES = ("estop", "reset")
STOPS = ("estop", "engage")


class Host:
    """Where somebody types: what is on the network, what is in the folder, and whether anybody can be asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], folder: Path) -> None:
        self._monkeypatch = monkeypatch
        self._capsys = capsys
        self._folder = folder

    def beside(self, *robots: str) -> "Host":
        meet(self._monkeypatch, *(alive_key(robot, "base", "1") for robot in robots))
        return self

    def with_file(self, robot: str) -> "Host":
        (self._folder / "deploy").mkdir()
        (self._folder / FILE).write_text(f'[robot]\nname = "{robot}"\n')
        return self

    def at_a_terminal(self, answers: str) -> "Host":
        self._monkeypatch.setattr(consent, "_is_terminal", lambda: True)
        self._monkeypatch.setattr(sys, "stdin", io.StringIO(answers))
        return self

    def types(self, *words: str) -> "Said":
        return Said(*typed(self._monkeypatch, self._capsys, *words))


class Said(NamedTuple):
    """Nothing answers on this network: what a command says shows only whom it asks."""

    code: int
    out: str
    complaint: str

    @property
    def asked(self) -> str:
        """The robots whose emergency stop was listened to or asked for."""
        return " ".join(word.split("/")[1] for word in self.complaint.split() if word.startswith("giraff/"))


@pytest.fixture
def host(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Host:
    """In an empty folder, without a terminal."""
    alone(monkeypatch, tmp_path)
    return Host(monkeypatch, capsys, tmp_path)


NOBODY: tuple[str, ...] = ()


@pytest.mark.parametrize(
    ("verb", "there", "file", "asked", "told"),
    [
        (LOOKS, NOBODY, "", "", "no robot is heard on the network"),
        (LOOKS, NOBODY, REAL, "", f"{FILE} names {REAL}"),
        (LOOKS, (OWN,), "", OWN, ""),
        (LOOKS, (OWN,), REAL, OWN, f"{REAL}, which {FILE} names, is not heard; this is {OWN}"),
        (LOOKS, (OTHER,), "", OTHER, ""),
        (LOOKS, (REAL,), "", REAL, ""),
        (LOOKS, (OWN, OTHER), REAL, "", f"{REAL}, which {FILE} names, is not heard\n"),
        (LOOKS, (REAL,), REAL, REAL, ""),
        (LOOKS, (OWN, REAL), REAL, REAL, ""),
        (LOOKS, (OWN, REAL), "", "", f"name one: --robot {REAL}, --robot {OWN} (or GIRAFF_ROBOT_NAME)"),
        (LOOKS, (OWN, REAL), OTHER, "", f"name one: --robot {REAL}, --robot {OWN} (or GIRAFF_ROBOT_NAME)"),
        (MOVES, NOBODY, "", "", "no robot is heard on the network"),
        (MOVES, (OWN,), "", OWN, ""),
        (MOVES, (OWN,), REAL, OWN, f"{REAL}, which {FILE} names, is not heard; this is {OWN}"),
        (MOVES, (OTHER,), "", "", f"{OTHER}, on an unknown host, is not the simulation of this host"),
        (MOVES, (REAL,), "", "", f"if it is meant: giraff estop reset --robot {REAL}"),
        (MOVES, (REAL,), REAL, "", f"if it is meant: giraff estop reset --robot {REAL}"),
        (MOVES, (OWN, REAL), REAL, "", f"if it is meant: giraff estop reset --robot {REAL}"),
        (MOVES, (OWN, REAL), "", "", "several robots are on the network"),
        (STOPS, NOBODY, "", "", "NOTHING IS STOPPED: no robot is heard; use the battery switch"),
        (STOPS, NOBODY, REAL, "", f"{REAL}, which {FILE} names, is NOT HEARD and was not stopped"),
        (STOPS, (OWN,), REAL, OWN, f"{REAL}, which {FILE} names, is NOT HEARD and was not stopped"),
        (STOPS, (REAL, OTHER, OWN), REAL, f"{REAL} {OTHER} {OWN}", f"{OTHER}: NOT CONFIRMED"),
    ],
)
def test_what_looks_takes_who_is_there_what_moves_this_hosts_simulation_and_a_stop_goes_to_every_robot(
    host: Host,
    monkeypatch: pytest.MonkeyPatch,
    verb: tuple[str, ...],
    there: tuple[str, ...],
    file: str,
    asked: str,
    told: str,
) -> None:
    """By itself, as nobody has named one."""
    monkeypatch.setattr("shutil.which", lambda name: name)  # it is on the path
    if file:
        host.with_file(file)
    said = host.beside(*there).types(*verb)
    assert (said.code, sorted(said.asked.split())) == (2, sorted(asked.split()))
    assert told in said.complaint


@pytest.mark.parametrize(
    "verb", [MOVES, ("drive",), ("param", "set", "guard.margin", "0.3"), ("param", "save", "guard")]
)
def test_nothing_is_moved_released_or_set_of_a_robot_that_nobody_has_named(host: Host, verb: tuple[str, ...]) -> None:
    said = host.beside(OTHER).types(*verb)
    assert said.code == 2
    assert "nobody has named it" in said.complaint


def test_the_line_to_paste_is_one_that_names_the_robot(host: Host, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda name: name)
    said = host.beside(REAL).types("param", "set", "--", "guard.margin", "0.3")
    assert f"if it is meant: giraff param set --robot {REAL} -- guard.margin 0.3" in said.complaint


@pytest.mark.parametrize("named_by", ["option", "environment", "file"])
def test_a_robot_that_is_named_is_meant(
    host: Host, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, named_by: str
) -> None:
    words: tuple[str, ...] = ()
    if named_by == "option":
        words = ("--robot", REAL)
    elif named_by == "environment":
        monkeypatch.setenv("GIRAFF_ROBOT_NAME", REAL)
    else:
        (tmp_path / "mine.toml").write_text(f'[robot]\nname = "{REAL}"\n')
        monkeypatch.setenv("GIRAFF_CONFIG", "mine.toml")
    host.beside(OWN, REAL)
    for verb in (LOOKS, MOVES, STOPS):
        assert host.types(*verb, *words).asked == REAL


@pytest.mark.parametrize(
    ("there", "environment", "robot"),
    [
        ((OWN, OTHER), {}, OWN),
        ((OWN, REAL), {}, REAL),
        ((OTHER,), {}, REAL),
        ((OWN,), {"GIRAFF_ROBOT_NAME": REAL}, REAL),
        ((OWN,), {"GIRAFF_NETWORK_MODE": "secured", "GIRAFF_NETWORK_ACCESS": '{ robot = ["pi"] }'}, REAL),
    ],
)
def test_the_simulation_of_this_host_does_for_a_robot_that_only_a_file_names_and_that_is_not_heard(
    host: Host, monkeypatch: pytest.MonkeyPatch, there: tuple[str, ...], environment: dict[str, str], robot: str
) -> None:
    monkeypatch.setattr("giraff_node.network.session.certificates", lambda _: {})
    Path("mine.toml").write_text(f'[robot]\nname = "{REAL}"\n', encoding="utf-8")
    for name, value in {"GIRAFF_CONFIG": "mine.toml", **environment}.items():
        monkeypatch.setenv(name, value)
    told = f"giraff: {REAL}, which mine.toml names, is not heard; this is {OWN}\n"
    assert host.beside(*there).types("param", "list").complaint.count(told) == (robot == OWN)
    assert told not in host.types("param", "list", "--robot", REAL).complaint
    with contextlib.suppress(NoRobotError), (script := Robot(patience=0.1)):
        pass
    assert script.name == robot


@pytest.mark.parametrize("command", sorted({*with_session()} - {"run"}))
def test_no_stop_and_nothing_that_is_for_the_robot_of_the_file_alone_takes_the_simulation(
    host: Host, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    """A page stays until the robot is there, a calibration goes into its file, and doctor judges the robot itself."""
    strict = {
        *("stop", "estop engage", "estop reset", "estop status", "web", "ros2", "doctor", "topic pub", "play"),
        *("calibrate camera", "calibrate odometry", "calibrate ranger", "calibrate scan"),
        *("tune speed", "param set", "param save"),
    }
    asked: list[Target] = []

    def stand_in(_: object, way: Target) -> Never:
        asked.append(way)
        raise consent.NoRobotError

    def visit(_: Target, act: Callable[[Any], int], **__: object) -> int:
        with contextlib.suppress(Exception):  # it finds nothing there to act on
            act(SimpleNamespace(session=None, robot=REAL))
        return 2

    monkeypatch.setattr("giraff_tools.network.command.stand_in", stand_in)
    # The first has it of the second, and is not to keep this one.
    for module in ("giraff_cli.estop.engage", "giraff_tools.network.command"):
        monkeypatch.setattr(f"{module}.visit", visit)
    host.beside(OWN).types(*command.split(), *WORDS.get(command, ()))
    assert bool(asked) == (command not in strict)


@pytest.mark.parametrize(
    ("there", "answers", "asked"),
    [
        ((REAL,), "yes\n", REAL),
        ((REAL,), "y\n", ""),
        ((REAL,), "", ""),
        ((REAL, OWN), "1\nyes\n", REAL),
        ((REAL, OWN), "1\n\n", ""),
        ((REAL, OWN), "2\n", OWN),
        ((REAL, OWN), "3\nyes\n", ""),
        ((REAL, OWN), "-1\nyes\n", ""),
        ((REAL, OWN), "yes\nyes\n", ""),
    ],
)
def test_at_a_terminal_a_person_chooses_and_says_yes(
    host: Host, there: tuple[str, ...], answers: str, asked: str
) -> None:
    assert host.beside(*there).at_a_terminal(answers).types(*MOVES).asked == asked


def test_whoever_only_looks_is_asked_which_one_and_nothing_else(host: Host) -> None:
    assert host.beside(REAL, OWN).at_a_terminal("1\n").types(*LOOKS).asked == REAL


def test_a_person_who_ends_it_at_the_question_has_chosen_nothing(host: Host, monkeypatch: pytest.MonkeyPatch) -> None:
    host.beside(REAL).at_a_terminal("")

    def interrupted() -> str:
        raise KeyboardInterrupt

    monkeypatch.setattr(sys, "stdin", SimpleNamespace(readline=interrupted))
    said = host.types(*MOVES)
    assert (said.code, said.asked) == (2, "")
    assert "nothing was done" in said.complaint


@pytest.mark.parametrize(
    ("verb", "error", "told"),
    [
        (LOOKS, ConnectionRefusedError(111, "Connection refused"), "Connection refused"),
        (MOVES, ConnectionRefusedError(111, "Connection refused"), "Connection refused"),
        (LOOKS, socket.gaierror(-2, "?"), "no such name is known here (DNS, /etc/hosts); give its address"),
    ],
)
def test_an_address_that_does_not_answer_is_an_error(
    host: Host, monkeypatch: pytest.MonkeyPatch, verb: tuple[str, ...], error: OSError, told: str
) -> None:
    def refuse(*_: object) -> None:
        raise error

    monkeypatch.setattr(socket, "create_connection", refuse)
    said = host.beside(OWN).types(*verb, "--connect", "robot.lan")
    assert (said.code, said.asked) == (2, "")
    assert f"--connect robot.lan: {told}; check the address" in said.complaint


@pytest.mark.parametrize(
    ("address", "why"), [("192.168.1.9", "Connection refused"), ("", "is no address"), ("robot host", "is no address")]
)
def test_a_stop_finds_its_way_all_the_same_and_what_was_not_reached_is_not_done(
    host: Host, monkeypatch: pytest.MonkeyPatch, address: str, why: str
) -> None:
    def refuse(*_: object) -> None:
        raise ConnectionRefusedError(111, "Connection refused")

    monkeypatch.setattr(socket, "create_connection", refuse)
    said = host.beside(OWN).types(*STOPS, "--connect", address)
    assert (said.code, said.asked) == (2, OWN)
    assert f"--connect {address}: " in said.complaint
    assert f"{why}" in said.complaint
    assert "NOT REACHED: a robot there was NOT STOPPED" in said.complaint


def test_a_stop_of_no_possible_robot_says_that_nothing_is_stopped(host: Host) -> None:
    said = host.beside(OWN).types(*STOPS, "--robot", "sim vm")
    assert (said.code, said.asked) == (2, "")
    assert "NOTHING IS STOPPED" in said.complaint


@pytest.mark.parametrize("address", ["127.0.0.1:70000", "127.0.0.1:x", "no such host"])
def test_what_is_no_address_is_told(host: Host, address: str) -> None:
    said = host.beside(OWN).types(*LOOKS, "--connect", address)
    assert (said.code, said.asked) == (2, "")
    assert "--connect" in said.complaint


def test_a_keyboard_or_a_recorder_is_no_robot() -> None:
    tokens = [Token(REAL, "keyboard", "1"), Token(OTHER, "recorder", "2")]
    assert robots_of([*tokens, Token(OWN, "guard", "3")]) == [OWN]
    assert robots_of(tokens) == [REAL, OTHER]

"""What holds of every `giraff` command: no robot, two robots, a key that is not there, a reader that has gone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest
import typer.main

from giraff_cli.main import app
from giraff_schemas.topics import alive_key
from tests.rules.repository import ROOT
from tests.support.desk import Desk, Done, run_beside
from tests.support.process_robot import ProcessRobot

pytestmark = pytest.mark.timeout(300.0)  # a fixture runs every command once

Words = tuple[str, ...]
DRIVE = ROOT / "tests" / "unit" / "replay" / "data" / "drive.mcap"

ASKING: dict[str, Words] = {
    "why": (),
    "watch": ("--for", "3"),
    "estop status": (),
    "estop reset": (),
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
    "doctor": (),
    "record": ("--for", "4", "-o", "FILE"),
    "view": ("--for", "4", "--save", "FILE", "--json"),
}
"""Every command that asks a robot, with what it needs to be of use, to end by itself, and to leave things as they are.

FILE is one that is not there yet.
"""
REFUSED_ONLY: dict[str, Words] = {"estop engage": ()}
"""What is only tried where it can do nothing: others stand beside this robot."""
UNKNOWN: Mapping[str, tuple[Words, str]] = {
    "topic info": (("odmo",), "did you mean odom? there are: tick, "),
    "topic echo": (("odmo",), "did you mean odom? there are: tick, "),
    "topic hz": (("odmo",), "did you mean odom? there are: tick, "),
    "topic bw": (("odmo",), "did you mean odom? there are: tick, "),
    "topic pub": (("odmo", "{}"), "did you mean odom? there are: tick, "),
    "node info": (("gard",), "no service 'gard' on the network; there are: base, guard, "),
    "param list": (("guard.marign",), "no such parameter; guard has margin, "),
    "param get": (("guard.marign",), "no such parameter; guard has margin, "),
    "param describe": (("guard.marign",), "no such parameter; guard has margin, "),
    "param set": (("gaurd.margin", "0.5"), "no such service is heard of sim-test; there are base, guard, "),
    "param save": (("gaurd.margin",), "no such service is heard of sim-test; there are base, guard, "),
    "record": (("--topics", "odmo"), "no such topic; there are tick, "),
    "play": ((str(DRIVE), "--topics", "odmo"), "has no such key; it has base, "),
}
"""Every command that takes a key or a name of something the robot has, with one that it has not, and what it says."""
ROBOTLESS: Mapping[str, str] = {
    "topic pub": "test_topics.py: it speaks for a robot that must not be there, and has to be named",
    "play": "test_recordings.py: likewise",
    "replay": "test_process_replay.py: it asks a file",
    "run": "tests/functional/robot/test_run.py: it brings its robot along",
    "dst": "tests/dst: likewise",
    "check wheels": "tests/unit/cli/test_check_wheels.py: it asks a board, and whoever stands beside it",
    "keys init": "tests/unit/keys: it asks a folder",
    "keys host": "likewise",
    "keys list": "likewise",
}
"""Those that ask no robot, and where they are tried."""
PRINTING: dict[str, Words] = {"replay": (str(DRIVE),), "play": (str(DRIVE), "--rate", "100"), "keys list": ()}
"""What of them has something to say to a pipe, and ends by itself."""
WAITING = {"watch", "record", "view"}
"""They say so while they wait, and in the end."""

Ended = Mapping[str, Done]


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
    assert set(whole_commands()) == set(ASKING) | set(REFUSED_ONLY) | set(ROBOTLESS)
    naming = {"key", "topics", "name", "names", "service"}
    takers = {path for path, it in whole_commands().items() if naming & {parameter.name for parameter in it.params}}
    assert {path for path in takers if not path.startswith("keys ")} == set(UNKNOWN)


def command(path: str, words: Words, about: str) -> Words:
    """`about`: for what it is tried."""
    file = f"{path}-{about}"
    return (*path.split(), *(file if word == "FILE" else word for word in words))


def run_all(desk: Desk, about: str) -> Ended:
    """Every command that asks a robot."""
    rows = ASKING | REFUSED_ONLY
    return run_beside(lambda path: desk.run(*command(path, rows[path], about)), rows)


@pytest.fixture(scope="module")
def alone(desk: Desk) -> Ended:
    """On a network without a robot."""
    return run_all(desk.alone(), "alone")


@pytest.fixture(scope="module")
def between_two(robot: ProcessRobot, desk: Desk) -> Ended:
    """With two robots, none of which is named."""
    with robot.observer.session.liveliness().declare_token(alive_key("sim-other", "base", "1")):
        return run_all(desk.unnamed(), "between")


@pytest.fixture(scope="module")
def misled(desk: Desk) -> Ended:
    """For a robot that is not there, where another one is."""
    return run_beside(lambda path: desk.run(*command(path, ASKING[path], "misled"), "--robot", "otto"), ASKING)


@pytest.fixture(scope="module")
def unread(desk: Desk) -> Ended:
    """With a closed pipe for standard output."""
    assert desk.run("keys", "init").returncode == 0  # for `keys list`
    rows = ASKING | PRINTING

    def run(path: str) -> Done:
        words = command(path, rows[path], "unread")
        with desk.running(*words) as process:
            assert process.stdout is not None
            assert process.stderr is not None
            process.stdout.close()
            code = process.wait(60.0)
            return Done(words, code, "", process.stderr.read())

    return run_beside(run, rows)


@pytest.fixture(scope="module")
def asked_in_vain(desk: Desk) -> Ended:
    """For what the robot has not."""
    return run_beside(lambda path: desk.run(*command(path, UNKNOWN[path][0], "vain")), UNKNOWN)


def told(path: str, done: Done) -> str:
    """What a command that could do nothing says, in one line on standard error; the first of one that waits."""
    if path == "doctor":  # to whom that is a finding like others
        assert (done.returncode, done.stderr) == (1, "")
        return done.stdout
    assert done.returncode == 2
    first, *more = done.stderr.splitlines()
    if path in WAITING:
        return next(line for line in (first, *more) if line.startswith("giraff: "))
    assert (more, done.stdout) == ([], "")
    return first


asking = pytest.mark.parametrize("path", ASKING | REFUSED_ONLY)


@asking
def test_with_no_robot_it_says_so(alone: Ended, path: str) -> None:
    said = told(path, alone[path])
    assert "no robot is heard" in said
    assert "give --connect " in said or path == "doctor"


@asking
def test_with_two_robots_it_lists_them(between_two: Ended, path: str) -> None:
    done = between_two[path]
    options = "--robot sim-other, --robot sim-test"
    assert done.stderr == f"giraff: several robots are on the network; name one: {options}\n"
    assert (done.returncode, done.stdout) == (2, "")


@pytest.mark.parametrize("path", ASKING)
def test_a_robot_that_is_not_there_is_named_with_those_that_are(misled: Ended, path: str) -> None:
    said = told(path, misled[path])
    assert "otto" in said
    assert "--robot sim-test" in said or path == "doctor"


@pytest.mark.parametrize("path", UNKNOWN)
def test_what_the_robot_has_not_is_told_with_what_it_has(asked_in_vain: Ended, path: str) -> None:
    done = asked_in_vain[path]
    assert (done.returncode, done.stdout) == (2, "")
    [line] = done.stderr.splitlines()
    assert UNKNOWN[path][1] in line


@pytest.mark.parametrize("path", ASKING | PRINTING)
def test_a_closed_pipe_ends_it_quietly(unread: Ended, path: str) -> None:
    done = unread[path]
    lines = [line for line in done.stderr.splitlines() if not line.startswith("recording sim-test into ")]
    assert lines == []
    assert done.returncode in (0, 1)  # as far as it came, all was well, or not

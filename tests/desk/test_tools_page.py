"""docs/tools.md shows what the commands really say: it is made of a run of them, and held to their words.

`GIRAFF_WRITE_DOCS=1 pytest tests/desk/test_tools_page.py` writes the outputs anew. Otherwise those of the page are
compared in form: numbers, ids and blanks may differ. Each command that it names is tried for its words and options.
"""

from __future__ import annotations

import os
import re
import shlex
from typing import Any

import pytest
import typer.main

from giraff_cli.main import app
from tests.desk.desk import Desk, Done, run_beside
from tests.rules.repository import ROOT
from tests.system.robot import ProcessRobot

PAGE = ROOT / "docs" / "tools.md"
BLOCK = re.compile(r"```console\n\$ (giraff [^\n]*)\n(.*?)```", re.DOTALL)
WRITE = bool(os.environ.get("GIRAFF_WRITE_DOCS"))


def commands() -> list[str]:
    """Those whose output the page shows."""
    return [match[1] for match in BLOCK.finditer(PAGE.read_text())]


def form(output: str) -> list[list[str]]:
    """The first words of each line: numbers and ids change from run to run, and so does what services complain of."""
    named = re.sub(r"\b[0-9a-f]{16}\b", "", output)
    words = (re.findall(r"[A-Za-z_]{2,}[\w/*]*", line) for line in named.splitlines())
    return [line[:2] for line in words if line[:1] != ["notice"]]


@pytest.fixture(scope="module")
def outputs(robot: ProcessRobot, desk: Desk) -> dict[str, str]:
    """What the page's commands say now, without the host's name."""

    def run(command: str) -> Done:
        return desk.run(*shlex.split(command)[1:])

    robot.run(5.0)  # a robot that has just started has no rates yet
    host = re.compile(rf"\b{re.escape(os.uname().nodename)}\b")
    ended = {command: run(command) for command in commands()} if WRITE else run_beside(run, commands())
    return {command: host.sub("pc", done.stdout + done.stderr) for command, done in ended.items()}


def test_the_page_shows_what_the_commands_say(outputs: dict[str, str]) -> None:
    text = PAGE.read_text()
    if WRITE:
        text = BLOCK.sub(lambda match: f"```console\n$ {match[1]}\n{outputs[match[1]]}```", text)
        PAGE.write_text(text)
    shown = {match[1]: match[2] for match in BLOCK.finditer(text)}
    assert shown
    for command, output in shown.items():
        assert form(output) == form(outputs[command]), command


def test_every_command_and_option_of_the_page_exists() -> None:
    root: Any = typer.main.get_command(app)
    found = re.findall(r"`(giraff [^`]+)`|^\$? ?(giraff .+?)(?:  #.*)?$", PAGE.read_text(), re.MULTILINE)
    assert found
    for quoted, line in found:
        said = quoted or line
        words = shlex.split(said.partition(" | ")[0])[1:]
        command = root
        while words and words[0] in getattr(command, "commands", {}):
            command = command.commands[words.pop(0)]
        assert not hasattr(command, "commands"), f"{said!r} is no whole command"
        options = {name for parameter in command.params for name in parameter.opts}
        assert {word for word in words if word.startswith("--")} <= options, said

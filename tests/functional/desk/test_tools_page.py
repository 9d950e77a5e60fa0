"""docs/tools.md shows what the commands really say: it is made of a run of them, and held to their words.

`GIRAFF_WRITE_DOCS=1 pytest tests/functional/desk/test_tools_page.py` writes the outputs anew. Otherwise those of the
page are compared in form: numbers, ids and blanks may differ. Each command that it names is tried for its words and
options.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
from shutil import copy
from typing import Any

import pytest
import typer.main

from giraff_cli.main import app
from tests.rules.repository import ROOT
from tests.support.desk import Desk, run_beside
from tests.support.process_robot import ProcessRobot

PAGE = ROOT / "docs" / "tools.md"
DRIVE = ROOT / "tests" / "unit" / "replay" / "data" / "drive.mcap"
BLOCK = re.compile(r"```console\n\$ (giraff [^\n]*)\n(.*?)```", re.DOTALL)
WRITE = bool(os.environ.get("GIRAFF_WRITE_DOCS"))


def chapters() -> list[tuple[str, ...]]:
    """The commands whose output each chapter shows, in their order: one may need what an earlier one has done."""
    shown = (BLOCK.findall(chapter) for chapter in PAGE.read_text().split("\n## "))
    return [tuple(command for command, _ in blocks) for blocks in shown if blocks]


def form(output: str) -> list[list[str]]:
    """The first words of each line: numbers and ids change from run to run, and so does what services complain of."""
    named = re.sub(r"\b[0-9a-f]{16}\b", "", output)
    words = (re.findall(r"[A-Za-z_]{2,}[\w/*]*", line) for line in named.splitlines())
    return [line[:2] for line in words if line[:1] != ["notice"]]


@pytest.fixture(scope="module")
def outputs(robot: ProcessRobot, desk: Desk) -> list[tuple[str, str]]:
    """What the page's commands say now, without the host's name: one of them may stand there twice."""

    host = re.compile(rf"\b{re.escape(os.uname().nodename)}\b")

    def say(command: str) -> str:
        done = desk.run(*shlex.split(command)[1:], stderr=subprocess.STDOUT)
        return re.sub(r" +$", "", host.sub("pc", done.stdout), flags=re.MULTILINE)

    def run(chapter: tuple[str, ...]) -> list[tuple[str, str]]:
        return [(command, say(command)) for command in chapter]

    copy(DRIVE, desk.directory / DRIVE.name)
    robot.run(5.0)  # a robot that has just started has no rates yet
    said = map(run, chapters()) if WRITE else run_beside(run, chapters()).values()
    return [each for chapter in said for each in chapter]


def test_the_page_shows_what_the_commands_say(outputs: list[tuple[str, str]]) -> None:
    text = PAGE.read_text()
    if WRITE:
        said = iter(outputs)
        text = BLOCK.sub(lambda _: "```console\n$ {}\n{}```".format(*next(said)), text)
        PAGE.write_text(text)
    shown = BLOCK.findall(text)
    assert len(shown) == len(outputs) > 0
    for (command, output), (_, now) in zip(shown, outputs, strict=True):
        assert form(output) == form(now), command


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

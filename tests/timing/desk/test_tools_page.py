"""docs/tools.md shows what the commands really say of a robot that keeps its pace, so it takes a quiet machine.

`GIRAFF_WRITE_DOCS=1 pytest tests/timing/desk/test_tools_page.py` writes the outputs anew. Otherwise those of the page
are compared in form: numbers, ids and blanks may differ. tests/unit/docs/test_blocks.py tries each command that it
names for its words and options.
"""

import os
import re
import shlex
from contextlib import suppress
from pathlib import Path
from shutil import copy
from tempfile import mkdtemp

import pytest

from tests.rules.repository import ROOT
from tests.support.desk import Desk, run_beside
from tests.support.process_robot import ProcessRobot
from tests.support.waiting import wait

PAGE = ROOT / "docs" / "tools.md"
DRIVE = ROOT / "tests" / "unit" / "replay" / "data" / "drive.mcap"
BLOCK = re.compile(r"```console\n\$ (giraff [^\n]*)\n(.*?)```", re.DOTALL)
WRITE = bool(os.environ.get("GIRAFF_WRITE_DOCS"))


Chapter = tuple[tuple[str, str], ...]
"""Commands, and what they say."""


def chapters() -> list[Chapter]:
    """Of each chapter what it shows, in its order: a command may need what an earlier one has done."""
    shown = (BLOCK.findall(chapter) for chapter in PAGE.read_text().split("\n## "))
    return [tuple(blocks) for blocks in shown if blocks]


def form(output: str) -> list[list[str]]:
    """The first words of each line: numbers and ids change from run to run, and so does what services complain of."""
    named = re.sub(r"\b[0-9a-f]{16}\b", "", output)
    words = (re.findall(r"[A-Za-z_]{2,}[\w/*]*", line) for line in named.splitlines())
    return [line[:2] for line in words if line[:1] != ["notice"]]


@pytest.fixture(scope="module")
def outputs(robot: ProcessRobot, desk: Desk) -> list[tuple[str, str]]:
    """What the page's commands say now, without the host's name: one of them may stand there twice."""

    host = re.compile(rf"\b{re.escape(os.uname().nodename)}\b")

    def run(chapter: Chapter) -> list[tuple[str, str]]:
        """In a folder of its own, where nothing is yet but the drive."""
        folder = Path(mkdtemp(dir=desk.directory))
        copy(DRIVE, folder / DRIVE.name)
        own = Desk(folder, desk.rendezvous, "sim-test")

        def say(command: str) -> str:
            done = own.run(*shlex.split(command)[1:])
            return re.sub(r" +$", "", host.sub("pc", done.stdout + done.stderr), flags=re.MULTILINE)

        return [(command, say(command)) for command, _ in chapter]

    def run_until(chapter: Chapter) -> list[tuple[str, str]]:
        """On a busy machine not everybody is met at the first call."""
        said: list[tuple[str, str]] = []

        def is_as_shown() -> bool:
            said[:] = run(chapter)
            return [form(output) for _, output in chapter] == [form(now) for _, now in said]

        with suppress(AssertionError):  # which the test tells better
            wait(is_as_shown, 60.0)
        return said

    robot.run(5.0)  # a robot that has just started has no rates yet
    said = map(run, chapters()) if WRITE else run_beside(run_until, chapters()).values()
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

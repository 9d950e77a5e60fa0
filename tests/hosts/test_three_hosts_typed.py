"""docs/deploy.md, typed line by line on its three hosts."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from contextlib import suppress
from typing import Final

import pytest

from tests.hosts.lab import NUMBERS, Lab
from tests.hosts.machine import BIN, run
from tests.rules.repository import ROOT
from tests.support.terminals import screen

Figure = Callable[[str, float, float, str], None]

pytestmark = pytest.mark.timeout(300)

SECTIONS: Final = {"robot": "The robot", "laptop": "The laptop", "desk": "The desk"}
OTHERWISE: Final = {
    "ls -l /dev/serial/by-id": "these boards are no USB devices",
    "docker-compose build giraff": "images are built on another machine and loaded",
    "docker-compose run --rm giraff check wheels": "tests/functional/robot/test_check.py answers its questions",
}
"""Lines that are not typed here, and why."""
EDIT: Final = "editor .env"
SHOWS: Final = {
    "docker-compose run --rm screen": "OPERATOR",
    "docker-compose logs --follow watch": "path",
}
"""Lines that go on until Ctrl-C, and what they show."""
ON_EACH: Final = "On each machine"
SHOWN_WITHIN: Final = 15.0  # s


def lines(title: str) -> list[str]:
    """What a section of the page has for the shell, without its comments."""
    [section] = re.findall(
        rf"^## {title}[^\n]*\n(.*?)(?=^## |\Z)", (ROOT / "docs" / "deploy.md").read_text(), re.DOTALL | re.MULTILINE
    )
    blocks = re.findall(r"^```sh\n(.*?)^```", section, re.DOTALL | re.MULTILINE)
    return [line.partition("  #")[0].strip() for block in blocks for line in block.splitlines()]


def environment(lab: Lab, host: str) -> dict[str, str]:
    return {"HOME": "/root", "PATH": BIN, "TERM": "xterm", "DOCKER_HOST": lab.machines[host].socket}


def typed(lab: Lab, host: str, line: str) -> str:
    """What the shell in this host's clone says to it."""
    return run(["sh", "-ec", line], 60.0, cwd=lab.clone(host), env=environment(lab, host))


def watched(lab: Lab, host: str, line: str, text: str) -> None:
    """What goes on until Ctrl-C says so within some seconds."""
    command = ["/bin/sh", "-ec", f"cd {lab.clone(host)} && exec {line}"]
    with screen(command, lab.directory / "watched.log", environment(lab, host)) as shown:
        shown.wait_for(text, SHOWN_WITHIN)
        shown.type(b"\x03")
        with suppress(subprocess.TimeoutExpired):  # docker-compose 1.29 does not always end by it
            shown.process.wait(SHOWN_WITHIN)


def test_the_page_is_typed_line_by_line(lab: Lab) -> None:
    lab.down(*NUMBERS)
    lab.load("robot", "laptop")
    lab.hardware.simulator.tilt(0.0, 0.0)
    for host, title in SECTIONS.items():
        (lab.clone(host) / ".env").unlink()
        for line in lines(title):
            if line == EDIT:
                lab.write_env(host)
            elif line in SHOWS:
                watched(lab, host, line, SHOWS[line])
            elif line not in OTHERWISE:
                print(f"{host}$ {line}\n{typed(lab, host, line)}")
        lab.wait_until_healthy(host)
    lab.hardware.drive()


def test_every_line_is_accounted_for() -> None:
    every = [line for title in SECTIONS.values() for line in lines(title)]
    assert {*OTHERWISE, *SHOWS, EDIT} <= set(every)
    assert any("git clone" in line for line in lines(ON_EACH))

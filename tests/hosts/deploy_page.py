"""docs/deploy.md, typed line by line on its three hosts."""

import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Final

from tests.hosts.lab import PATIENCE, Lab
from tests.hosts.machine import BIN, LabError, run
from tests.rules.repository import ROOT
from tests.support.terminals import screen

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
AGAIN: Final = {"docker-compose run --rm giraff why"}
"""Lines that a person types again: the page says so, and a busy machine lets a sensor be silent for a moment."""
TRIES: Final = 5
ON_EACH: Final = "On each machine"
_ENDS_WITHIN: Final = 5.0  # s


def lines(title: str) -> list[str]:
    """What a section of the page has for the shell, without its comments."""
    [section] = re.findall(
        rf"^## {title}[^\n]*\n(.*?)(?=^## |\Z)", (ROOT / "docs" / "deploy.md").read_text(), re.DOTALL | re.MULTILINE
    )
    blocks = re.findall(r"^```sh\n(.*?)^```", section, re.DOTALL | re.MULTILINE)
    return [line.partition("  #")[0].strip() for block in blocks for line in block.splitlines()]


def type_the_page(lab: Lab, edits: Mapping[str, Callable[[], None]]) -> None:
    """On hosts where nothing is up: on the robot, then on the others at once.

    `edits`: what is done to a host's `.env` where that is more than the page says.
    """

    def type_on(host: str) -> None:
        (lab.clone(host) / ".env").unlink()
        for line in lines(SECTIONS[host]):
            if line == EDIT:
                edits.get(host, lambda: lab.write_env(host))()
            elif line in SHOWS:
                _watched(lab, host, line, SHOWS[line])
            elif line not in OTHERWISE:
                print(f"{host}$ {line}\n{_typed(lab, host, line)}")

    lab.hardware.simulator.tilt(0.0, 0.0)
    type_on("robot")
    lab.on_each(SECTIONS.keys() - {"robot"}, type_on)


def _environment(lab: Lab, host: str) -> dict[str, str]:
    return {"HOME": "/root", "PATH": BIN, "TERM": "xterm", "DOCKER_HOST": lab.machines[host].socket}


def _typed(lab: Lab, host: str, line: str) -> str:
    """What the shell in this host's clone says to it."""
    tries = TRIES if line in AGAIN else 1
    while True:
        tries -= 1
        try:
            return run(["sh", "-ec", line], 120.0, cwd=lab.clone(host), env=_environment(lab, host))
        except LabError as error:
            if not tries:
                raise
            print(error)


def _watched(lab: Lab, host: str, line: str, text: str) -> None:
    """What goes on until Ctrl-C says so."""
    command = ["/bin/sh", "-ec", f"cd {lab.clone(host)} && exec {line}"]
    with screen(command, lab.directory / f"watched-{host}.log", _environment(lab, host)) as shown:
        shown.wait_for(text, PATIENCE)
        shown.type(b"\x03")
        with suppress(AssertionError):  # docker-compose 1.29 does not always end by it
            shown.ended(_ENDS_WITHIN)

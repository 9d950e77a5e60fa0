"""Programs of the pages that no test starts: why, and what can be known of their words all the same."""

import importlib.util
import re
import tomllib
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, Final

import yaml

from giraff_ros2 import topics as ros
from giraff_schemas.boards import ALL_BOARDS
from giraff_schemas.services import ROLES, SERVICES
from tests.rules.repository import ROOT

DOCKER: Final = "it needs Docker: tests/hosts types docs/deploy.md on three hosts"
ROOTS: Final = "it needs root: tests/functional/deploy tries the installation"
SHELL: Final = "it is the shell's or Debian's"
_MAKE_VARIABLES: Final = {"ARGS", "BOARD", "PORT", "ROLE", "LOCK", "DESTDIR", "PROGRAMMER"}
_READERS_BOARD: Final = "mine"
"""docs/boards.md has its reader make the folder."""


def _unknown(words: list[str], known: set[str], kind: str) -> str:
    """Return what is wrong with words of which each must be one of these."""
    return "; ".join(f"there is no {kind} {word}" for word in words if word not in known)


def _names(words: tuple[str, ...]) -> list[str]:
    return [word for word in words if not word.startswith("-")]


def _make(words: tuple[str, ...]) -> str:
    """Each target is in the Makefile, and each variable means something to it."""
    folder = ROOT / words[2] if words[1:2] == ("-C",) else ROOT
    given = words[3:] if words[1:2] == ("-C",) else words[1:]
    known = set(re.findall(r"^([a-z-]+(?: [a-z-]+)*):", (folder / "Makefile").read_text(), re.MULTILINE))
    variables = dict(word.split("=", 1) for word in given if "=" in word)
    wrong = [
        _unknown([word for word in given if "=" not in word], {n for each in known for n in each.split()}, "target")
    ]
    wrong.append(_unknown(sorted(variables), _MAKE_VARIABLES, "variable"))
    if role := variables.get("ROLE"):
        wrong.append(_unknown([role], set(ROLES), "role"))
    if lock := variables.get("LOCK"):
        wrong.append(_unknown([lock], {path.stem for path in (ROOT / "requirements").glob("*.lock")}, "lock"))
    if board := variables.get("BOARD"):
        boards = {path.name for path in (ROOT / "firmware" / "boards").iterdir()}
        wrong.append(_unknown([board], boards | {_READERS_BOARD}, "board"))
    return "; ".join(filter(None, wrong))


def _compose(words: tuple[str, ...]) -> str:
    """The action is one of those that the pages use, and each service is in the compose file."""
    action, *rest = words[1:]
    services = _names(tuple(rest))[: 1 if action == "run" else None]
    wrong = _unknown([action], {"build", "run", "up", "ps", "logs", "down"}, "action")
    return wrong or _unknown(services, compose_services(), "service of docker-compose.yml")


@cache
def compose_services() -> set[str]:
    """Return the names of the compose file's services."""
    compose: dict[str, Any] = yaml.safe_load((ROOT / "docker-compose.yml").read_text())
    return set(compose["services"])


def _units(words: tuple[str, ...]) -> str:
    """Each unit is installed by `make install`, and is of a service that there is."""
    units = [word.removesuffix(".service") for word in words if word.startswith("giraff")]
    known = {f"giraff@{service.name}" for service in SERVICES} | {"giraff@*", "giraff.target", "giraff-firewall"}
    known |= {board.unit for board in ALL_BOARDS} | {"giraff-board@*"}
    return _unknown(units, known, "unit")


def _module(words: tuple[str, ...]) -> str:
    """The module is there, and a service that it asks is one."""
    assert words[1] == "-m", words
    if importlib.util.find_spec(words[2]) is None:
        return f"there is no module {words[2]}"
    return _unknown(_names(words[3:]), {service.name for service in SERVICES}, "service")


def _extras(words: tuple[str, ...]) -> str:
    """Each extra of the project is declared."""
    extras = {extra for word in words for found in re.findall(r"\[(.*)\]", word) for extra in found.split(",")}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    return _unknown(sorted(extras), set(project["optional-dependencies"]), "extra")


def _source(words: tuple[str, ...]) -> str:
    """A file that is copied out of the repository is in it."""
    wanted = [word for word in words[1:-1] if word.startswith("deploy/")]
    return "; ".join(f"there is no file {word}" for word in wanted if not (ROOT / word).is_file())


def _ros(words: tuple[str, ...]) -> str:
    """Each topic and service is one of the robot's."""
    rows = (*ros.PUBLISHED, *ros.SUBSCRIBED, ros.ESTOP)
    known = {"/" + row.name.replace("~", ros.NODE) for row in rows}
    return _unknown([word for word in words if word.startswith("/")], known, "topic or service")


def _nothing(_: tuple[str, ...]) -> str:
    return ""


OUTSIDE: Final[Mapping[str, tuple[str, Callable[[tuple[str, ...]], str]]]] = {
    "make": ("it sets up, tests, installs or flashes: the suite itself is run by it", _make),
    "docker-compose": (DOCKER, _compose),
    "systemctl": (ROOTS, _units),
    "journalctl": (ROOTS, _units),
    "python": ("it asks a service that runs: tests/functional/health", _module),
    "/opt/giraff/bin/python": (ROOTS, _module),
    "pip": ("it needs the internet", _extras),
    "cp": (SHELL, _source),
    "build/firmware/roboclaw": ("it needs a controller: tests/functional/robot", _nothing),
    "git": ("it needs the internet", _nothing),
    "scp": ("it needs another machine", _nothing),
    **dict.fromkeys(("apt-get", "adduser", "newgrp", "chown", "groupdel", "install", "mv", "rm"), (ROOTS, _nothing)),
    "ros2": ("it needs ROS 2, which nothing here installs", _ros),
    "udevadm": ("it needs a board on a port", _nothing),
    **dict.fromkeys(("cd", "echo", "editor", "export", "ls", "grep", "tail", "jq"), (SHELL, _nothing)),
}
"""A program, why no test starts it, and what looks at its words."""

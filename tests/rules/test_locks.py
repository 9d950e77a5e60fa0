"""The locks pin everything pyproject.toml asks for, by hash, and say nothing of where it comes from."""

import json
import re
from collections.abc import Iterable
from itertools import chain
from typing import Any

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.rules.repository import ROOT, pyproject

PIN = re.compile(r"(?P<name>[a-z0-9-]+)==(?P<version>[\w.]+)( ; [\w.'<>=! ]+)? \\")
PARTS = {
    "robot": ["serial"],
    "recorder": ["serial", "record"],
    "web": ["serial", "web"],
    "localization": ["serial", "localization"],
    "camera": ["serial", "camera"],
    "ros2": ["serial", "ros2"],
    "laptop": ["serial", "cli", "web", "localization", "camera", "ros2"],
    "sim": ["serial", "cli", "sim", "web", "localization", "camera"],
    "run": ["serial", "cli", "sim", "web", "localization", "record", "keys", "ros2"],
    "viewer": ["viewer"],
}
"""Lock of what a kind of host needs -> the extras that it pins."""
HASH = re.compile(r"    --hash=sha256:[0-9a-f]{64}( \\)?")


def stray_lines(lock: str) -> list[str]:
    """Lines of a lock that are neither pin nor hash nor comment."""
    lines = lock.splitlines()
    return [line for line in lines if not (PIN.fullmatch(line) or HASH.fullmatch(line) or line.lstrip()[:1] == "#")]


def pins(lock: str) -> dict[str, set[str]]:
    """Versions by name; platforms and Python versions may have one each."""
    found: dict[str, set[str]] = {}
    for match in filter(None, map(PIN.fullmatch, lock.splitlines())):
        found.setdefault(match["name"], set()).add(match["version"])
    return found


def unmet(requirements: Iterable[str], pinned: dict[str, set[str]]) -> list[str]:
    """Requirements that the pins do not satisfy."""
    return [
        str(wanted)
        for wanted in map(Requirement, requirements)
        if not any(wanted.specifier.contains(version) for version in pinned.get(canonicalize_name(wanted.name), ()))
    ]


def asked_for(project: dict[str, Any], extras: Iterable[str], groups: Iterable[str]) -> list[str]:
    optional = project["project"]["optional-dependencies"]
    named = chain.from_iterable(project["dependency-groups"][group] for group in groups)
    return [
        *project["project"]["dependencies"],
        *chain.from_iterable(optional[extra] for extra in extras if extra != "desk"),  # which is made of the others
        *(requirement for requirement in named if isinstance(requirement, str)),
    ]


@pytest.mark.parametrize("lock", [*(f"{part}.lock" for part in PARTS), "dev.lock"])
def test_a_lock_holds_pins_and_hashes_only(lock: str) -> None:
    text = (ROOT / "requirements" / lock).read_text()
    assert stray_lines(text) == []
    assert "://" not in text
    assert pins(text)


def test_the_locks_pin_what_the_project_asks_for() -> None:
    project = pyproject()
    everything = pins((ROOT / "requirements" / "dev.lock").read_text())
    extras = project["project"]["optional-dependencies"]
    assert unmet(asked_for(project, extras, ["build", "dev"]), everything) == []
    for part, extras in PARTS.items():
        pinned = pins((ROOT / "requirements" / f"{part}.lock").read_text())
        assert unmet(asked_for(project, extras, ["build"]), pinned) == []
        assert {package: everything[package] for package in pinned} == pinned


def test_there_is_no_lock_beside_these() -> None:
    assert {path.stem for path in (ROOT / "requirements").iterdir()} == {*PARTS, "dev"}


def test_the_robots_lock_stays_small() -> None:
    robot = pins((ROOT / "requirements" / "robot.lock").read_text())
    assert not {"numpy", "rerun-sdk", "typer", "rich", "cffi", "cryptography"} & set(robot)


def test_what_a_run_installs_stays_small() -> None:
    run = pins((ROOT / "requirements" / "run.lock").read_text())
    assert not {"rerun-sdk", "pyarrow", "opencv-python-headless", "playwright", "pyright", "mypy"} & set(run)


def test_what_judges_the_page_is_pinned_by_hash_and_not_by_where_it_is() -> None:
    folder = ROOT / "tests" / "functional" / "desk"
    text = (folder / "package-lock.json").read_text()
    lock, asked = json.loads(text), json.loads((folder / "package.json").read_text())
    packages = {name: package for name, package in lock["packages"].items() if name}
    assert lock["packages"][""]["devDependencies"] == asked["devDependencies"]
    assert {name.removeprefix("node_modules/"): each["version"] for name, each in packages.items()} == asked[
        "devDependencies"
    ]
    assert all(each["integrity"].startswith("sha512-") for each in packages.values())
    assert "://" not in text


@pytest.mark.parametrize(
    "line",
    [
        "--index-url https://packages.example/simple",
        "giraff @ file:///home/me/giraff",
        "numpy>=1.24 \\",
        "numpy==2.0",
    ],
)
def test_a_stray_line_shows(line: str) -> None:
    assert stray_lines(line) == [line]


def test_an_unmet_requirement_shows() -> None:
    assert unmet(["numpy>=1.24", "rich"], {"numpy": {"1.23"}}) == ["numpy>=1.24", "rich"]

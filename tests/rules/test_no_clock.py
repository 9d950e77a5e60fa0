"""What is no test of processes starts none, shares nothing between threads, opens no session and reads no clock.

So it takes as long on a busy machine as it has work, and never fails by that. Real processes have their places: see
CONTRIBUTING.md.
"""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from tests.rules.repository import ROOT, files

REAL = ("functional", "hosts", "timing", "campaign")
"""Folders of tests of real processes."""
FORBIDDEN = ("subprocess", "multiprocessing", "threading", "concurrent", "time", "asyncio")
CALLS = ("open_session", "fork", "forkpty", "system", "posix_spawn")
TOOLS = "tests/support/tools.py"
SUSPECT = re.compile(rf"\b(import|from)\b.*\b({'|'.join(FORBIDDEN)})\b|\b({'|'.join(CALLS)})\(|zenoh\.open\(")
FROM_TESTS = re.compile(r"^[ \t]*((?:import|from) tests\b(?:[^(\n]*\([^)]*\)|.*))$", re.MULTILINE)
"""All that counts of a module without anything suspect; to parse the whole takes 3 ms."""
EXCEPTIONS = {
    "tests/timing/faults.py": "the rows of the fault table, which are read, and not run",
    "tests/support/budget.py": "counts the processes that a test starts",
    TOOLS: "git, compilers, linters and an interpreter that has imported nothing yet: each ends by itself",
}
USERS_OF_TOOLS = (
    *("tests/rules/", "tests/firmware/", "tests/mutants/", "tests/fuzz/boards.py"),
    "tests/unit/web/test_page.py",  # node, which runs the page's own tests
    "tests/loop/test_sense_ring.py",  # an example's own test, in a copy of the tree
)


def seen_in(source: str) -> tuple[list[str], list[str]]:
    """What it imports or calls and should not, and the modules of tests that it imports."""
    breaches, modules = [], []
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Import(names=names):
                modules += [alias.name for alias in names]
            case ast.ImportFrom(module=str(module)):
                modules += [module, *(f"{module}.{alias.name}" for alias in node.names if module.startswith("tests"))]
            case ast.Call(func=ast.Attribute(value=ast.Name(id="zenoh"), attr="open")):
                breaches.append("zenoh.open")
            case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if name in CALLS:
                breaches.append(name)
    breaches += [module for module in modules if module.partition(".")[0] in FORBIDDEN]
    return breaches, [module for module in modules if module.startswith("tests.")]


@cache
def seen(path: Path) -> tuple[list[str], list[Path]]:
    """The same of a file, with the files of the modules."""
    source = path.read_text(encoding="utf-8")
    breaches, modules = seen_in(source if SUSPECT.search(source) else "\n".join(FROM_TESTS.findall(source)))
    others = (ROOT / (module.replace(".", "/") + ".py") for module in modules)
    return breaches, [other for other in others if other.is_file()]


def real_things(path: Path) -> list[str]:
    """What a module does that it should not, or has done for it by another one of tests; with who does it."""
    found, known, waiting = [], {path}, [path]
    while waiting:
        at = waiting.pop()
        name = str(at.relative_to(ROOT))
        if name in EXCEPTIONS:
            continue
        does, others = seen(at)
        found += [f"{name}: {breach}" for breach in does]
        waiting += [other for other in others if other not in known]
        known.update(others)
    return sorted({*found})


def timeless() -> list[Path]:
    """Modules of tests that are to have no clock: tests/support only where one of these imports it."""
    tests = [path.relative_to(ROOT / "tests") for path in files() if path.is_relative_to(ROOT / "tests")]
    return [ROOT / "tests" / path for path in tests if path.suffix == ".py" and path.parts[0] not in (*REAL, "support")]


def test_no_test_without_processes_has_a_clock() -> None:
    found = {str(path.relative_to(ROOT)): real_things(path) for path in timeless()}
    assert {name: things for name, things in found.items() if things} == {}


def test_exceptions_are_few_and_needed() -> None:
    assert len(EXCEPTIONS) <= 5
    assert all(seen(ROOT / name)[0] for name in EXCEPTIONS)


def test_tools_are_for_what_builds_and_checks() -> None:
    users = [
        str(path.relative_to(ROOT))
        for path in files()
        if path.suffix == ".py" and path.is_relative_to(ROOT / "tests") and "tests.support.tools" in path.read_text()
    ]
    assert [name for name in users if not name.startswith(USERS_OF_TOOLS)] == []


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("import time", ["time"]),
        ("def f():\n    from concurrent.futures import Future", ["concurrent.futures"]),
        ("import zenoh\nzenoh.open(c)", ["zenoh.open"]),
        ("import zenoh\nzenoh.KeyExpr('a')", []),
        ("with open_session(a, b) as s: pass", ["open_session"]),
        ("os.fork()", ["fork"]),
        ("from datetime import datetime", []),
    ],
)
def test_what_it_looks_for_shows(source: str, expected: list[str]) -> None:
    assert seen_in(source)[0] == expected

"""A failure is tried again where the machine stood still, once, and nowhere else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.rules.repository import ROOT

CONFTEST = """
from contextlib import contextmanager
from pathlib import Path
import tests.stalled

class Machine:
    def longest(self, since_ns):
        return {stall}

@contextmanager
def seen(folder):
    yield Machine()

tests.stalled._TESTS, tests.stalled.stalls_seen = Path(__file__).parent, seen
"""
FAILING = """
import pytest
tries = []

@pytest.fixture(scope="module")
def robot():
    yield
    print("the robot ends")

@pytest.mark.parametrize("number", range({tests}))
def test_it(number, robot):
    tries.append(number)
    assert tries.count(number) > {fails}, f"try {{tries.count(number)}}"
"""


@pytest.mark.parametrize(
    ("folder", "stall", "fails", "tests", "passed", "again"),
    [
        ("system", 0.06, 1, 1, True, 1),
        ("system", 0.04, 1, 1, False, 0),
        ("unit", 0.06, 1, 1, False, 0),
        ("desk", 0.06, 2, 1, False, 1),
        ("desk", 0.06, 0, 5, True, 0),
        ("system", 0.06, 1, 3, False, 3),
    ],
)
def test_what_is_tried_again(
    tmp_path: Path, folder: str, stall: float, fails: int, tests: int, passed: bool, again: int
) -> None:
    (tmp_path / folder).mkdir()
    (tmp_path / "conftest.py").write_text(CONFTEST.format(stall=stall))
    (tmp_path / folder / "test_it.py").write_text(FAILING.format(fails=fails, tests=tests))
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-c", ROOT / "pyproject.toml", "--rootdir", tmp_path, tmp_path],
        cwd=ROOT,
        check=False,
        capture_output=True,
        text=True,
    )
    assert (done.returncode == 0) == passed, done.stdout + done.stderr
    assert done.stdout.count("test_it.py::") - done.stdout.count("FAILED") == again, done.stdout
    assert ("stood still" in done.stdout) == bool(again)

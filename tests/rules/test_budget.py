"""tests/budget.toml: its rows stay within what was reached, and whoever exceeds one is told plainly."""

import re
import sys
from pathlib import Path
from typing import Final

import pytest

from tests.rules.repository import ROOT, sources
from tests.support.budget import START, Budget, read_budget, told
from tests.support.tools import finished

FOLDERS_TAKE: Final = 454.0
"""Processor seconds of a quiet machine. Nobody raises it: a row of [folders] rises where another one falls."""
RESERVE: Final = 127.0
"""The same for [capabilities]: 27 are taken, 100 are for what is yet to come."""
PROCESSOR_TAKES: Final = 660.0
"""The sum of [processor]: 560 are taken, 100 are for the same capabilities."""
A_CAPABILITY_TAKES: Final = 8.0
A_CAPABILITY_COUNTS: Final = {"simulated": 60, "robots": 1, "processes": 6, "windows": 1, "pictures": 600}
PARTS: Final = {"product": ("firmware", "schemas", "scripts", "services"), "tests": ("tests",)}
WRITTEN: Final = ("", ".S", ".c", ".css", ".h", ".html", ".js", ".mjs", ".mk", ".py", ".sh", ".toml")
"""Suffixes of what somebody wrote and others read. The rest is data."""
NOT_IN_MAKE_TEST: Final = ("campaign", "hosts", "mutants", "timing")

BUDGET: Final = read_budget()


def test_the_rows_are_within_what_was_reached() -> None:
    folders = sum(map(BUDGET.priced, BUDGET.folders.values()))
    capabilities = sum(map(BUDGET.priced, BUDGET.capabilities.values()))
    assert folders <= FOLDERS_TAKE, f"the rows of [folders] take {folders:.0f} s: lower one where you raise another"
    assert capabilities <= RESERVE, f"the rows of [capabilities] take {capabilities:.0f} s of the reserve's {RESERVE:g}"
    assert sum(BUDGET.processor.values()) <= PROCESSOR_TAKES


def test_a_capability_takes_a_small_part_of_the_reserve() -> None:
    for name, row in BUDGET.capabilities.items():
        assert BUDGET.priced(row) <= A_CAPABILITY_TAKES, name
        assert all(row.get(unit, 0) <= most for unit, most in A_CAPABILITY_COUNTS.items()), name
    assert sum(row.get("windows", 0) for row in BUDGET.capabilities.values()) <= 1


def test_each_folder_of_tests_has_a_row_and_each_row_tests() -> None:
    folders = {path.relative_to(ROOT).parts[1] for path in (ROOT / "tests").rglob("test_*.py")}
    rows = {row for row in BUDGET.folders if row.endswith("/")}
    assert rows == {f"tests/{folder}/" for folder in folders.difference(NOT_IN_MAKE_TEST)}
    assert rows | {START} <= set(BUDGET.processor)
    for row in (BUDGET.folders | BUDGET.capabilities | BUDGET.processor).keys() - {START}:
        assert list(ROOT.glob(f"{row}*")), f"no test's path begins with {row}"


@pytest.mark.parametrize("part", PARTS)
def test_the_lines_are_within_their_limit(part: str) -> None:
    lines = sum(path.read_bytes().count(b"\n") for path in sources(*WRITTEN, under=PARTS[part]))
    most = BUDGET.lines[part]
    assert lines <= most, f"{lines} lines, {most} may be: write less, or raise the limit in the commit that needs it"


def test_one_robot_too_many_and_too_much_computing_fail_plainly(tmp_path: Path) -> None:
    """Two tests of one folder start a robot each: once it may have two, once only one and next to no time."""
    (tmp_path / "conftest.py").write_text('pytest_plugins = ["tests.support.budget"]\n')
    (tmp_path / "test_robots.py").write_text(
        "import subprocess, sys\n"
        "def test_one(): subprocess.run([sys.executable, '-c', 'sum(range(2_000_000))', 'giraff_sim'])\n"
        "def test_another(): subprocess.run([sys.executable, '-c', '', 'giraff_sim'])\n"
    )
    budget = tmp_path / "budget.toml"
    command = [sys.executable, "-m", "pytest", "-q", f"--rootdir={tmp_path}", f"--budget={budget}", str(tmp_path)]
    ended = {}
    for robots, processor in ((2, 60), (1, 0.001)):
        budget.write_text(
            f'[prices]\nrobots = 5\nprocesses = 1\n[folders."test_"]\nrobots = {robots}\n'
            f'[processor]\n"test_" = {processor}\n'
        )
        ended[robots] = finished(command, cwd=ROOT)
    assert [done.returncode for done in ended.values()] == [0, 1]
    for words in ("test_: 2 robots, 1 more than its 1. Most is taken by", "2  test_robots.py", "tests/campaign"):
        assert words in ended[1].stdout
    assert re.search(r"test_: 0.\d+ processor s, 0.\d+ more than its 0.001", ended[1].stdout)


def test_the_longest_path_that_fits_has_the_test() -> None:
    unit = "simulated"
    budget = Budget({unit: 1.0}, {"tests/loop/": {unit: 3}}, {"tests/loop/test_camera": {unit: 2}})
    spent = {"tests/loop/test_drive.py::test": {unit: 3.0}, "tests/loop/test_camera.py::test": {unit: 2.0}}
    assert told(spent, budget, over=True) == []

"""A failure that the wall clock judged is tried again where the machine stood still, once, and no other one ever."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest

from tests.rules.repository import ROOT
from tests.timing.sleepers import Stalls

CONFTEST: Final = """
import time
from contextlib import contextmanager
import pytest
import tests.timing.stalled

spans = []

class Machine:
    def longest(self, begin_ns, end_ns):
        return max((end - begin for begin, end in spans if begin <= end_ns and begin_ns <= end), default=0) * 1e-9

@contextmanager
def seen(folder, least):
    yield Machine()

@pytest.fixture
def stall():
    def stand_still(seconds):
        now = time.monotonic_ns()
        spans.append((now - round(seconds * 1e9), now))
    return stand_still

tests.timing.stalled.stalls_seen = seen
"""
FAILING: Final = """
import time
from collections import Counter
import pytest
from tests.timing.stalled import by_the_wall

tries = Counter()

@pytest.fixture(scope="module")
def robot():
    yield
    print("the robot ends")

@pytest.mark.parametrize("number", range({tests}))
def test_it(number, robot, stall):
    tries[number] += 1
    fails = number < {failing} and tries[number] <= {fails}
{body}
"""
WITHIN: Final = """
    with by_the_wall():
        stall(0.06)
        assert not fails
"""
BRIEFLY: Final = WITHIN.replace("0.06", "0.04")
BEFORE: Final = """
    stall(0.06)
    time.sleep(0.001)
    with by_the_wall():
        assert not fails
"""
AFTER: Final = """
    try:
        with by_the_wall():
            assert not fails
    finally:
        time.sleep(0.2)
        stall(0.06)
"""
NOT_JUDGED_BY_THE_WALL: Final = """
    stall(0.06)
    assert not fails
"""
A_MISTAKE: Final = """
    with by_the_wall():
        stall(0.06)
        if fails:
            raise ValueError
"""
NESTED: Final = """
    with by_the_wall():
        stall(0.06)
        time.sleep(0.001)
        with by_the_wall():
            assert not fails
"""


def write(folder: Path, name: str, body: str, *, fails: int = 1, failing: int = 1, tests: int = 1) -> None:
    """A file of so many tests, so many of which fail so often."""
    (folder / "conftest.py").write_text(CONFTEST)
    text = FAILING.format(body=body, fails=fails, failing=failing, tests=tests)
    (folder / f"test_{name}.py").write_text(text)


def run(where: Path) -> tuple[bool, str]:
    """Whether the tests there have passed, and what was told."""
    words = ["-p", "tests.timing.stalled", "-c", "pyproject.toml", "--rootdir", str(where), str(where)]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *words], cwd=ROOT, check=False, capture_output=True, text=True
    )
    return done.returncode == 0, done.stdout + done.stderr


def again(told: str) -> int:
    return told.count(" s; assert")


def test_only_what_the_wall_clock_judged_within_a_stall_is_tried_again(tmp_path: Path) -> None:
    write(tmp_path, "within", WITHIN)
    write(tmp_path, "twice", WITHIN, fails=2)
    write(tmp_path, "well", WITHIN, failing=0, tests=5)
    never = {
        "briefly": BRIEFLY,
        "before": BEFORE,
        "after": AFTER,
        "not_judged": NOT_JUDGED_BY_THE_WALL,
        "a_mistake": A_MISTAKE,
        "nested": NESTED,
    }
    for name, body in never.items():
        write(tmp_path, name, body)
    has_passed, told = run(tmp_path)
    assert not has_passed
    failed = set(re.findall(r"^FAILED \S*test_(\w+)\.py::", told, re.MULTILINE))
    assert failed == {"twice", *never}, told
    assert re.findall(r"^test_(\w+)\.py::.* s; assert", told, re.MULTILINE) == ["twice", "within"], told
    assert "passed" in told
    assert "too many" not in told


def test_a_machine_that_stands_still_all_the_time_proves_nothing(tmp_path: Path) -> None:
    write(tmp_path, "it", WITHIN, failing=3, tests=3)
    has_passed, told = run(tmp_path)
    assert not has_passed
    assert "3 passed" in told
    assert again(told) == 3


def test_of_one_file_it_is_one_in_five(tmp_path: Path) -> None:
    write(tmp_path, "others", WITHIN, failing=0, tests=60)
    write(tmp_path, "faults", WITHIN, failing=3, tests=13)
    has_passed, told = run(tmp_path)
    assert not has_passed
    assert "too many of test_faults.py: 3" in told


def test_a_stall_that_is_still_being_written_is_not_read(tmp_path: Path) -> None:
    file = tmp_path / "stalls.0"
    file.write_text("1000 2000\n5000 60")
    stalls = Stalls([file])
    assert stalls.longest(0, 10_000) == pytest.approx(1e-6)
    file.write_text("10")
    assert stalls.longest(0, 10_000) == 0.0


@pytest.mark.parametrize(
    ("begin", "end", "found"), [(0, 999, 0), (0, 1000, 1), (1500, 1600, 1), (2000, 9000, 1), (2001, 9000, 0)]
)
def test_only_a_stall_within_the_time_counts(tmp_path: Path, begin: int, end: int, found: int) -> None:
    file = tmp_path / "stalls.0"
    file.write_text("1000 2000\n")
    assert round(Stalls([file]).longest(begin, end) * 1e6) == found

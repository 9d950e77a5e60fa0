"""What judges by the wall clock, and fails while this machine itself stands still, is tried once more, and counted.

A test says what it judges so: what is in `by_the_wall`. A probe beside the tests tells of stalls: processes that only
sleep, on each processor one. No other failure is tried again, and a machine that stands still all the time fails the
run: it proves nothing. Counted are all processes of a run, in the file that `tests/run` names.
"""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import NamedTemporaryFile, TemporaryDirectory
from typing import Final

import pytest
from _pytest.runner import runtestprotocol

from tests.timing.sleepers import Stalls, stalls_seen

FOLDERS: Final = ("timing", "campaign")
"""Of tests, those that run real processes against the wall clock."""
STALL: Final = 0.05  # s
TALLY: Final = "TESTS_TALLY"
"""Names the file in which all processes of a run count."""
_SHARE: Final = 0.05  # of all tests of a run that may be tried again
_SHARE_OF_A_FILE: Final = 0.2
_ALWAYS: Final = 2  # of a few tests
_TOLD: Final = 0.02  # s after a stall until all sleepers have told of it
_TESTS: Final = Path(__file__).parents[1]

_stalls = pytest.StashKey[Stalls]()
_failures = pytest.StashKey[list[BaseException]]()
_own_tally = pytest.StashKey[str]()


class JudgedByTheWallError(AssertionError):
    """Something was too late, or did not come about, between these two times of `time.monotonic_ns`."""

    def __init__(self, what: str, begin_ns: int, end_ns: int) -> None:
        super().__init__(what)
        self.begin_ns, self.end_ns = begin_ns, end_ns


@contextmanager
def by_the_wall(begin_ns: int | None = None) -> Iterator[None]:
    """What fails in this block was judged by the wall clock: by the time from `begin_ns` on, or from the block's begin.

    Only what a stall of this machine can bring about belongs in it. `begin_ns`: of `time.monotonic_ns`.
    """
    begin_ns = begin_ns or time.monotonic_ns()
    try:
        yield
    except JudgedByTheWallError:  # by a block in this one, which knows it better
        raise
    except AssertionError as failure:
        raise JudgedByTheWallError(str(failure), begin_ns, time.monotonic_ns()) from failure


def tried_again() -> list[str]:
    """Each test of this run that was, and why."""
    return [line.removeprefix("again ") for line in _counted() if line.startswith("again ")]


def pytest_configure(config: pytest.Config) -> None:
    # A run that a test starts is none of this one's; a worker's is.
    if TALLY not in os.environ or "PYTEST_CURRENT_TEST" in os.environ:
        with NamedTemporaryFile("w", prefix="tally-", delete=False) as file:
            os.environ[TALLY] = config.stash[_own_tally] = file.name


def pytest_unconfigure(config: pytest.Config) -> None:
    if own := config.stash.get(_own_tally, ""):
        del os.environ[TALLY]
        Path(own).unlink()


@pytest.hookimpl(wrapper=True)
def pytest_runtestloop(session: pytest.Session) -> Iterator[None]:
    if not any(judges_by_the_wall(item) for item in session.items):
        return (yield)
    with TemporaryDirectory() as folder, stalls_seen(Path(folder), STALL) as stalls:
        session.config.stash[_stalls] = stalls
        return (yield)


def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> bool | None:
    if not judges_by_the_wall(item):
        return None
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    _count(f"ran {item.nodeid}")
    item.stash[_failures] = []
    reports = runtestprotocol(item, nextitem=nextitem, log=False)
    if why := _excuse(item.stash[_failures], item.config.stash[_stalls]):
        _count(f"again {item.nodeid}: {why}")
        reports = runtestprotocol(item, nextitem=nextitem, log=False)
    for report in reports:
        item.ihook.pytest_runtest_logreport(report=report)
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    return True


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    if report.failed and call.excinfo is not None:
        item.stash.setdefault(_failures, []).append(call.excinfo.value)
    return report


def pytest_sessionfinish(session: pytest.Session) -> None:
    if _too_many() and session.exitstatus == pytest.ExitCode.OK and not hasattr(session.config, "workerinput"):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if again := tried_again():
        terminalreporter.section("tried again, for this machine stood still meanwhile")
        for line in (*again, *_too_many()):
            terminalreporter.line(line)


def judges_by_the_wall(item: pytest.Item) -> bool:
    return item.path.is_relative_to(_TESTS) and item.path.relative_to(_TESTS).parts[0] in FOLDERS


def _excuse(failures: list[BaseException], stalls: Stalls) -> str:
    """Why a test is tried again: each of its failures was judged by the wall while the machine stood still; or ''."""
    time.sleep(_TOLD if failures else 0.0)
    told = []
    for failure in failures:
        if not isinstance(failure, JudgedByTheWallError):
            return ""
        stalled = stalls.longest(failure.begin_ns, failure.end_ns)
        if stalled <= STALL:
            return ""
        told.append(f"{stalled:.3f} s; {' '.join(str(failure).split())[:200]}")
    return "; ".join(told)


def _too_many() -> list[str]:
    """Whose tests were tried again too often, and how often."""
    ran = Counter(_file(line) for line in _counted() if line.startswith("ran "))
    again = Counter(_file(line) for line in _counted() if line.startswith("again "))
    every = [("all tests", again.total(), _SHARE * ran.total())]
    every += [(file, count, _SHARE_OF_A_FILE * ran[file]) for file, count in again.items()]
    return [
        f"too many of {whose}: {count}; relieve this machine"
        for whose, count, most in every
        if count > max(_ALWAYS, most)
    ]


def _file(line: str) -> str:
    return line.split(" ", 1)[1].partition("::")[0]


def _count(line: str) -> None:
    with Path(os.environ[TALLY]).open("a") as file:
        file.write(line + "\n")


def _counted() -> list[str]:
    return Path(os.environ[TALLY]).read_text().splitlines()

"""What judges by the wall clock and fails while this machine itself stood still is tried once more, and counted.

A probe beside the tests tells of it: processes that only sleep, on each processor one. No other failure is tried again,
and a machine that stands still all the time fails the run: it proves nothing.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import pytest
from _pytest.runner import runtestprotocol

from tests.sleepers import Stalls, stalls_seen

FOLDERS: Final = ("system", "desk", "hosts")
"""Of tests, those that run real processes against the wall clock."""
STALL: Final = 0.05  # s
_SHARE: Final = 0.05  # of the tests that may be tried again
_ALWAYS: Final = 2  # of a few tests
_TESTS: Final = Path(__file__).parent

_stalls = pytest.StashKey[Stalls]()
_tried_again = pytest.StashKey[list[str]]()


@pytest.hookimpl(wrapper=True)
def pytest_runtestloop(session: pytest.Session) -> Iterator[None]:
    if not any(judges_by_the_wall(item) for item in session.items):
        return (yield)
    with TemporaryDirectory() as folder, stalls_seen(Path(folder)) as stalls:
        session.config.stash[_stalls], session.config.stash[_tried_again] = stalls, []
        return (yield)


def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> bool | None:
    if not judges_by_the_wall(item):
        return None
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    began_ns = time.monotonic_ns()
    reports = runtestprotocol(item, nextitem=nextitem, log=False)
    failures = [report.longreprtext.splitlines()[-1] for report in reports if report.failed]
    if failures and (stalled := item.config.stash[_stalls].longest(began_ns)) > STALL:
        item.config.stash[_tried_again].append(f"{item.nodeid}: {stalled:.3f} s; {'; '.join(failures)}")
        reports = runtestprotocol(item, nextitem=nextitem, log=False)
    for report in reports:
        item.ihook.pytest_runtest_logreport(report=report)
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    return True


def pytest_sessionfinish(session: pytest.Session) -> None:
    again = session.config.stash.get(_tried_again, [])
    if len(again) > max(_ALWAYS, _SHARE * session.testscollected) and session.exitstatus == pytest.ExitCode.OK:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    if again := config.stash.get(_tried_again, []):
        terminalreporter.section("tried again, for this machine stood still meanwhile")
        for line in again:
            terminalreporter.line(line)


def judges_by_the_wall(item: pytest.Item) -> bool:
    return item.path.is_relative_to(_TESTS) and item.path.relative_to(_TESTS).parts[0] in FOLDERS

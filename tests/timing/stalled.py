"""What judges by the wall clock, and fails while this machine itself stands still, is tried once more, and counted.

A test says what it judges so: what is in `by_the_wall`. A probe beside the tests tells of stalls: processes that only
sleep, on each processor one. No other failure is tried again, and a machine that stands still all the time fails the
run: it proves nothing. It serves tests/timing, in one process: `pytest -p tests.timing.stalled tests/timing`.
"""

import time
from collections import Counter
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import pytest
from _pytest.runner import runtestprotocol

from tests.timing.sleepers import Stalls, stalls_seen

STALL: Final = 0.05  # s
_SHARE: Final = 0.05  # of all tests of a run that may be tried again
_SHARE_OF_A_FILE: Final = 0.2
_ALWAYS: Final = 2  # of a few tests
_TOLD: Final = 0.02  # s after a stall until all sleepers have told of it


@dataclass
class _Tally:
    """Of a run."""

    ran: Counter[str] = field(default_factory=Counter)
    """Tests of each file."""
    again: Counter[str] = field(default_factory=Counter)
    told: list[str] = field(default_factory=list)
    """Each test that was tried again, and why."""

    def too_many(self) -> list[str]:
        """Whose tests were tried again too often, and how often."""
        every = [("all tests", self.again.total(), _SHARE * self.ran.total())]
        every += [(file, count, _SHARE_OF_A_FILE * self.ran[file]) for file, count in self.again.items()]
        return [
            f"too many of {whose}: {count}; relieve this machine"
            for whose, count, most in every
            if count > max(_ALWAYS, most)
        ]


_stalls = pytest.StashKey[Stalls]()
_tally = pytest.StashKey[_Tally]()
_failures = pytest.StashKey[list[BaseException]]()


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


def pytest_configure(config: pytest.Config) -> None:
    config.stash[_tally] = _Tally()


@pytest.hookimpl(wrapper=True)
def pytest_runtestloop(session: pytest.Session) -> Iterator[None]:
    with TemporaryDirectory() as folder, stalls_seen(Path(folder), STALL) as stalls:
        session.config.stash[_stalls] = stalls
        return (yield)


def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> bool:
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    tally, file = item.config.stash[_tally], item.nodeid.partition("::")[0]
    tally.ran[file] += 1
    item.stash[_failures] = []
    reports = runtestprotocol(item, nextitem=nextitem, log=False)
    if why := _excuse(item.stash[_failures], item.config.stash[_stalls]):
        tally.again[file] += 1
        tally.told.append(f"{item.nodeid}: {why}")
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
    if session.config.stash[_tally].too_many() and session.exitstatus == pytest.ExitCode.OK:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    tally = config.stash[_tally]
    if tally.told:
        terminalreporter.section("tried again, for this machine stood still meanwhile")
        for line in (*tally.told, *tally.too_many()):
            terminalreporter.line(line)


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

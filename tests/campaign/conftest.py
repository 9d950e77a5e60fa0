"""`--tenth`: ten minutes of a campaign that takes hours, other ones each day."""

import datetime as dt
import random
import time
from itertools import groupby
from typing import Final

import pytest

TAKES: Final = 600.0
"""s for all files together."""
MUTANTS: Final = 10
"""Most that are drawn: before the first, the killers of all of them run once with all rules whole."""


def pytest_addoption(parser: pytest.Parser) -> None:
    today = dt.datetime.now(dt.UTC).date().isoformat()
    parser.addoption(
        "--tenth",
        nargs="?",
        const=today,
        metavar="DAY",
        help="from each file what ten minutes allow, drawn by the day: today, or a DAY as 2026-11-26 again",
    )


def pytest_configure(config: pytest.Config) -> None:
    if day := config.getoption("tenth"):
        config.pluginmanager.register(_Tenth(day))


class _Tenth:
    """Each file has its share of the time that is left when its turn comes, and one test at least."""

    def __init__(self, day: str) -> None:
        self._day = day
        self._chance = random.Random(day)
        self._taken: dict[str, tuple[int, int]] = {}
        """By file: how many of how many."""

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool | None:
        if session.config.option.collectonly:
            return None
        files = [(name, list(items)) for name, items in groupby(session.items, _file)]
        self._chance.shuffle(files)
        ends = time.monotonic() + TAKES
        for number, (name, items) in enumerate(files):
            now = time.monotonic()
            drawn = self._chance.sample(items, min(len(items), MUTANTS) if "mutants" in name else len(items))
            session.items = drawn  # the laboratory of mutants looks which are tried
            taken = _run(session, drawn, now + (ends - now) / (len(files) - number))
            self._taken[name] = taken, len(items)
        return True

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        terminalreporter.section(f"a tenth, of {self._day}: again with --tenth={self._day}")
        for name, (taken, every) in sorted(self._taken.items()):
            terminalreporter.write_line(f"  {name:<40} {taken:4d} taken, {every - taken:4d} left")


def _run(session: pytest.Session, items: list[pytest.Item], ends: float) -> int:
    """Run a file's tests until its time is over, and return how many. The last one takes down what they share."""
    longest = 0.0
    for place, item in enumerate(items):
        began = time.monotonic()
        is_last = place + 1 == len(items) or began + longest >= ends
        session.config.hook.pytest_runtest_protocol(item=item, nextitem=None if is_last else items[place + 1])
        if session.shouldfail or session.shouldstop:
            raise session.Interrupted(session.shouldfail or session.shouldstop)
        longest = max(longest, time.monotonic() - began)
        if is_last:
            return place + 1
    return 0


def _file(item: pytest.Item) -> str:
    return item.nodeid.partition("::")[0]

"""`--tenth`: ten minutes of a campaign that takes hours, other ones each day."""

from __future__ import annotations

import datetime as dt
import random
import time
from collections import Counter
from itertools import groupby
from typing import Final

import pytest
from _pytest.runner import call_and_report

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
    """Each file has its share of the time that is left when its turn comes. An item that has begun is ended."""

    def __init__(self, day: str) -> None:
        self._day = day
        self._chance = random.Random(day)
        self._files_left = 0
        self._file = ""
        self._ends = 0.0
        self._file_ends = 0.0
        self._all: Counter[str] = Counter()
        self._left: Counter[str] = Counter()

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        files = [list(each) for _, each in groupby(items, _file)]
        self._chance.shuffle(files)
        drawn = []
        for each in files:
            self._chance.shuffle(each)
            name = _file(each[0])
            self._all[name] = len(each)
            most = MUTANTS if "mutants" in name else len(each)
            self._left[name] = len(each[most:])
            drawn += each[:most]
        items[:] = drawn
        self._files_left = len(files)
        self._ends = time.monotonic() + TAKES

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item, nextitem: pytest.Item | None) -> bool | None:
        now = time.monotonic()
        if _file(item) != self._file:
            self._file = _file(item)
            self._file_ends = now + (self._ends - now) / self._files_left
            self._files_left -= 1
        elif now >= self._file_ends:
            self._left[self._file] += 1
            call_and_report(item, "teardown", nextitem=nextitem)
            return True
        return None

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        terminalreporter.section(f"a tenth, of {self._day}: again with --tenth={self._day}")
        for name, count in sorted(self._all.items()):
            terminalreporter.write_line(f"  {name:<40} {count - self._left[name]:4d} taken, {self._left[name]:4d} left")


def _file(item: pytest.Item) -> str:
    return item.nodeid.partition("::")[0]

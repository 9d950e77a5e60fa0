"""Which mutants are tried, and what became of them."""

import random
from typing import Final

import pytest

from tests.mutants.laboratory import read_mutants
from tests.support.report import report

DRAW: Final = 1
"""Seeds what `--sample` draws."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--sample", type=int, default=0, metavar="N", help="of all mutants, the same N drawn at random")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "mutant" in metafunc.fixturenames:
        mutants = read_mutants()
        if wanted := metafunc.config.getoption("sample"):
            mutants = random.Random(DRAW).sample(mutants, wanted)
        metafunc.parametrize("mutant", mutants, ids=lambda mutant: mutant.rule)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Of all processes of a run, by the one that reports."""
    found = {
        how: [each.nodeid for each in terminalreporter.getreports(how) if "test_a_broken_rule" in each.nodeid]
        for how in ("passed", "failed", "error")
    }
    if any(found.values()):
        figures = {"killed": len(found["passed"]), "not_killed": found["failed"], "not_judged": found["error"]}
        report("campaign/mutants", figures)

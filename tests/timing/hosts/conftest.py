"""A lab for each file of this folder, and what they measured."""

import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import nullcontext

import pytest

from tests.hosts.lab import Lab
from tests.rules.repository import ROOT
from tests.timing.stalled import by_the_wall

_measured: list[str] = []


@pytest.fixture(scope="module")
def lab() -> Iterator[Lab]:
    """Three hosts, without a container yet."""
    subprocess.run([ROOT / "tests" / "hosts" / "prepare"], check=True)
    lab = Lab()
    try:
        yield lab
    finally:
        lab.close()


@pytest.fixture
def figure() -> Callable[[str, float, float, str], None]:
    """What was measured, its bound and their unit: printed at the end, and held. Seconds are the wall clock's."""
    begin_ns = time.monotonic_ns()

    def note(what: str, value: float, bound: float, unit: str) -> None:
        _measured.append(f"{what:<72} {value:8.2f} {unit:<2} (bound {bound:g})")
        with by_the_wall(begin_ns) if unit == "s" else nullcontext():
            assert value <= bound, f"{what}: {value:.2f} {unit}, and {bound:g} is the bound"

    return note


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    terminalreporter.section("measured")
    for line in _measured:
        terminalreporter.line(line)

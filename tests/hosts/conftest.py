"""One lab for all tests of this folder, because making it takes longer than any of them; and what they measured."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from tests.hosts.lab import Lab

_measured: list[str] = []


@pytest.fixture(scope="session")
def lab() -> Iterator[Lab]:
    """Three hosts, without a container yet."""
    lab = Lab()
    try:
        yield lab
    finally:
        lab.close()


@pytest.fixture(scope="session")
def figure() -> Callable[[str, float, float, str], None]:
    """What was measured, its bound and their unit: printed at the end, and held."""

    def note(what: str, value: float, bound: float, unit: str) -> None:
        _measured.append(f"{what:<72} {value:8.2f} {unit:<2} (bound {bound:g})")
        assert value <= bound, f"{what}: {value:.2f} {unit}, and {bound:g} is the bound"

    return note


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    terminalreporter.section("measured")
    for line in _measured:
        terminalreporter.line(line)

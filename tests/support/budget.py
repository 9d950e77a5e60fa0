"""A pytest plugin that holds each folder's tests to what tests/budget.toml lets them cost.

Simulated seconds, robots, processes, windows, pictures and drawn examples are counted while the tests run. They are the
same on every machine, busy or not. Processor time, which plain computing takes too, is compared with a loop's.
"""

import subprocess
import tomllib
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Mapping
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Final

import msgspec
import pytest
from hypothesis.internal.conjecture.engine import ConjectureRunner
from PIL import Image

from giraff_sim.camera.renderer import Renderer
from giraff_sim.simulation import Simulation
from tests.support.balancer import Balancer
from tests.support.counting import count, counted
from tests.support.processor import Pace, taken

BUDGET: Final = Path(__file__).parents[1] / "budget.toml"
PROCESSOR: Final = "processor s"
"""The unit of tests.support.processor."""
START: Final = "start"
"""The row for the processor time of pytest before, between and after its tests, in the process where that is most."""
LISTED: Final = 5
"""Files that a report names."""
REMEDY: Final = """\
Show it by a cheaper test: call the policy; play one seed; share one robot in a file. Or remove an older test that shows
the same thing. Or move its breadth to tests/campaign and keep one test here. CONTRIBUTING.md: Stay in the budget."""

Costs = Mapping[str, float]
"""Amounts by unit: simulated (s), robots, processes, forks, windows, pictures, examples, processor s."""


class Budget(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The content of tests/budget.toml."""

    prices: dict[str, float]
    """Processor seconds of a quiet machine that one of each unit takes."""
    folders: dict[str, dict[str, float]]
    """Largest costs of the tests whose path begins with the key, in one whole `make test`."""
    capabilities: dict[str, dict[str, float]] = {}
    """Largest costs of later capabilities' tests. A test belongs to the longest key that its path begins with."""

    processor: dict[str, float] = {}
    """Largest processor time (s) of the tests whose path begins with the key."""
    lines: dict[str, int] = {}
    """Most lines that a part of the repository has."""

    def priced(self, costs: Costs) -> float:
        """Return what these costs come to, in processor seconds of a quiet machine."""
        return sum(self.prices[unit] * amount for unit, amount in costs.items())


def read_budget(path: Path = BUDGET) -> Budget:
    return msgspec.convert(tomllib.loads(path.read_text(encoding="utf-8")), Budget)


def by_row(spent: Mapping[str, Costs], rows: Iterable[str]) -> dict[str, dict[str, Counter[str]]]:
    """Return the costs of each row's files. `spent`: costs by node id."""
    ordered = sorted(rows, key=len)
    found: dict[str, dict[str, Counter[str]]] = {row: {} for row in ordered}
    for test, costs in spent.items():
        if fitting := [row for row in ordered if test.startswith(row)]:
            found[fitting[-1]].setdefault(test.partition("::")[0], Counter()).update(costs)
    return found


def told(spent: Mapping[str, Costs], budget: Budget, *, over: bool, unsteadiness: float = 0.0) -> list[str]:
    """Return a report: the cost of each row's tests, or if `over`, only the rows that are over their limits.

    `unsteadiness`: share by which processor times were uncertain in this run.
    """
    timed = {row: {PROCESSOR: most * (1.0 + unsteadiness)} for row, most in budget.processor.items()}
    tables = ((budget.folders | budget.capabilities, tuple(budget.prices)), (timed, (PROCESSOR,)))
    return [line for rows, units in tables for line in _told(spent, rows, units, over=over)]


def _told(spent: Mapping[str, Costs], rows: Mapping[str, Costs], units: Iterable[str], *, over: bool) -> list[str]:
    lines: list[str] = []
    for row, files in by_row(spent, rows).items():
        for unit in units:
            each = {file: costs[unit] for file, costs in files.items() if costs[unit]}
            total, most = sum(each.values()), rows[row].get(unit, 0)
            if not over and total:
                lines.append(f"  {row:<40} {unit:<11} {total:8.4g} of {most:g}")
            elif over and total > most + 1e-6:
                lines.append(f"{row}: {total:.6g} {unit}, {total - most:.6g} more than its {most:g}. Most is taken by")
                dearest = sorted(each, key=lambda file: -each[file])[:LISTED]
                lines += [f"  {each[file]:10.6g}  {file}" for file in dearest]
    return lines


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--costs", action="store_true", help="tell what each folder's tests cost, of what they may")
    parser.addoption("--budget", type=Path, default=BUDGET, metavar="FILE", help="what each folder's tests may cost")


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(_Counts(config.getoption("budget"), tells=config.getoption("costs")))


class _Counts:
    """Counts the costs of each test in every worker. The main process compares their sums with the budget."""

    def __init__(self, budget: Path, *, tells: bool) -> None:
        self._budget = budget
        self._tells = tells
        self._spent: dict[str, Counter[str]] = {}
        self._pace = Pace()
        self._in_tests = 0.0
        self._unsteadiness = 0.0
        """Largest of the workers."""
        self._lines: list[str] = []
        _count_calls(Simulation, "step", lambda step: count("simulated", step.world.step_us * 1e-6))
        _count_calls(Balancer, "step", lambda _: count("simulated", 0.001))
        _count_calls(ConjectureRunner, "test_function", lambda _: count("examples"))
        _count_calls(BaseProcess, "start", lambda _: count("processes"))
        _count_calls(Image.Image, "save", lambda _: count("pictures"))
        _count_calls(Renderer, "frame", lambda _: count("pictures"))
        _count_calls(subprocess.Popen, "__init__", lambda process: count(_kind(process.args)))

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        self._pace.run()
        before, began = Counter(counted), taken()
        done = yield
        took = taken() - began
        self._spent[item.nodeid] = counted - before + Counter({PROCESSOR: took / self._pace.slowness})
        self._in_tests += took
        return done

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node: Any) -> None:
        """Take what a worker of xdist has counted."""
        output = getattr(node, "workeroutput", {})
        costs = output.get("giraff_spent", {})
        self._note_start(costs.pop(START, {}).get(PROCESSOR, 0.0))
        self._unsteadiness = max(self._unsteadiness, output.get("giraff_unsteadiness", 0.0))
        self._spent |= {test: Counter(each) for test, each in costs.items()}

    @pytest.hookimpl(wrapper=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> Generator[None, None, None]:
        output: dict[str, object] | None = getattr(session.config, "workeroutput", None)
        self._note_start((taken() - self._in_tests) / self._pace.slowness)
        if output is not None:  # before xdist sends it
            output["giraff_unsteadiness"] = self._pace.unsteadiness
            output["giraff_spent"] = {test: dict(each) for test, each in self._spent.items()}
        yield
        if output is not None:
            return
        self._unsteadiness = max(self._unsteadiness, self._pace.unsteadiness)
        self._lines = told(self._spent, read_budget(self._budget), over=True, unsteadiness=self._unsteadiness)
        if self._lines and session.exitstatus == pytest.ExitCode.OK:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def _note_start(self, seconds: float) -> None:
        """Keep the time of the process that took most. More workers do not raise it."""
        before = self._spent.get(START, Counter())[PROCESSOR]
        self._spent[START] = Counter({PROCESSOR: max(before, seconds)})

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if self._tells:
            terminalreporter.section("cost")
            terminalreporter.write_line("\n".join(told(self._spent, read_budget(self._budget), over=False)))
            terminalreporter.write_line(f"  processor times are uncertain by {self._unsteadiness:.0%} in this run")
        if self._lines:
            terminalreporter.section(f"over budget: {self._budget.name}", red=True)
            terminalreporter.write_line("\n".join([*self._lines, REMEDY]))


def _count_calls(kind: type, method: str, note: Callable[[Any], None]) -> None:
    """Call `note` with the object after each call of its method."""
    original = getattr(kind, method)

    def noted(self: Any, *given: Any, **named: Any) -> Any:
        done = original(self, *given, **named)
        note(self)
        return done

    setattr(kind, method, noted)


def _kind(command: Any) -> str:
    """Return the unit of a process: a simulator or `giraff run` is a robot, a browser or a view that draws a window."""
    words = [str(word) for word in command] if isinstance(command, list | tuple) else [str(command)]
    called = next(
        (place for place, word in enumerate(words) if Path(word).name in ("giraff", "giraff_cli")), len(words)
    )
    verb = words[called + 1 : called + 2]
    if "giraff_sim" in words or verb == ["run"]:
        return "robots"
    draws = Path(words[0]).name == "chromium" or (verb == ["view"] and "--picture" in words)
    return "windows" if draws else "processes"

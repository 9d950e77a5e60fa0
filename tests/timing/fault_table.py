"""The fault table of docs/safety.md: made of the scenarios, and of what was last measured on them.

Usage: python -m tests.timing.fault_table: writes the page's table anew, as after a change of the scenarios.
"""

import datetime as dt
from collections.abc import Iterable, Iterator, Mapping
from typing import Final

import msgspec

from giraff_sim.board import ROOT
from tests.timing.faults import Scenario
from tests.timing.scenarios import SCENARIOS
from tests.timing.simulated import judge_of

FILE: Final = ROOT / "docs" / "fault-table.toml"
PAGE: Final = ROOT / "docs" / "safety.md"
BEGIN: Final = "<!-- the fault table: written by make test-timing -->\n"
END: Final = "<!-- end of the fault table -->\n"

_HEAD: Final = """\
| fault | then | bound, s | worst, s | of trials | in simulated time, too |
|---|---|---|---|---|---|
"""
_ABOUT: Final = """\
# Figures of the fault table in safety.md. make test-timing writes them when every row has kept its promise.
"""


class Worst(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Of the trials of one scenario that stops."""

    worst_s: float
    trials: int


class Measured(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Of all scenarios, by their names."""

    date: dt.date
    commit: str
    trials: int
    """Also of those that do not stop."""
    scenarios: dict[str, Worst]


def read() -> Measured:
    return msgspec.toml.decode(FILE.read_bytes(), type=Measured)


def keep(commit: str, worst: Mapping[str, float], trials: int) -> None:
    """Write the file and the page's table: of each scenario the worst of so many trials, s."""
    rows = {each.name: Worst(round(worst[each.name], 3), trials) for each in SCENARIOS if each.does == "stops"}
    today = dt.datetime.now(dt.UTC).date()
    measured = Measured(today, commit, trials * len(SCENARIOS), rows)
    FILE.write_text(dumped(measured))
    write(measured)


def dumped(measured: Measured) -> str:
    """As the file has it, a line a scenario."""
    rows = "".join(
        f'"{name}" = {{ worst_s = {row.worst_s:.3f}, trials = {row.trials} }}\n'
        for name, row in measured.scenarios.items()
    )
    head = f'date = {measured.date}\ncommit = "{measured.commit}"\ntrials = {measured.trials}\n'
    return f"{_ABOUT}{head}\n[scenarios]\n{rows}"


def table(measured: Measured) -> str:
    """Rows of faults; those that differ in duration or direction only are one."""
    lines = [_line(scenarios, measured.scenarios) for scenarios in _grouped(SCENARIOS)]
    told = f"Measured on {measured.date} at commit {measured.commit}, in {measured.trials} trials:\n\n"
    return told + _HEAD + "".join(lines)


def written() -> str:
    """The table as the page has it."""
    return PAGE.read_text().partition(BEGIN)[2].partition(END)[0]


def write(measured: Measured) -> None:
    """Put the figures into the page."""
    before, _, rest = PAGE.read_text().partition(BEGIN)
    PAGE.write_text(before + BEGIN + table(measured) + END + rest.partition(END)[2])


def _grouped(scenarios: Iterable[Scenario]) -> list[list[Scenario]]:
    groups: dict[tuple[str, str], list[Scenario]] = {}
    for scenario in scenarios:
        groups.setdefault((scenario.fault, _then(scenario)), []).append(scenario)
    return list(groups.values())


def _line(scenarios: list[Scenario], worst: Mapping[str, Worst]) -> str:
    name = scenarios[0].fault
    if scenarios[0].does == "dips":
        name += f", {max(scenario.lasts for scenario in scenarios):g} s at most"
    bounds = sorted({f"{scenario.bound:g}" for scenario in scenarios if scenario.bound})
    found = list(_found(scenarios, worst))
    longest = f"{max(row.worst_s for row in found):.3f}" if found else ""
    trials = str(sum(row.trials for row in found)) if found else ""
    judge, _, _ = judge_of(scenarios[0]).partition("::")
    cells = (name, _then(scenarios[0]), " or ".join(bounds), longest, trials, judge and f"`{judge}`")
    return f"| {' | '.join(cells)} |\n"


def _found(scenarios: list[Scenario], worst: Mapping[str, Worst]) -> Iterator[Worst]:
    return (worst[scenario.name] for scenario in scenarios if scenario.name in worst)


def _then(scenario: Scenario) -> str:
    match scenario.does:
        case "stops":
            return "stop all" if scenario.rearms else "stop that direction"
        case "creeps":
            return "creep"
        case "slows":
            return "0.16 m/s at most that way"
        case "dips":
            return "stop, then go on by itself"
        case "drives on":
            return "continue"


if __name__ == "__main__":
    write(read())

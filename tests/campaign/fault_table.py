"""The fault table of docs/safety.md: made of the scenarios, and of what the campaign has measured on them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any, Final

from giraff_sim.board import ROOT
from tests.campaign.records import RECORDS
from tests.timing.faults import Scenario
from tests.timing.scenarios import SCENARIOS

PAGE: Final = ROOT / "docs" / "safety.md"
BEGIN: Final = "<!-- the fault table: written by make campaign -->\n"
END: Final = "<!-- end of the fault table -->\n"

_HEAD: Final = "| fault | then | bound, s | worst, s | of trials |\n|---|---|---|---|---|\n"


def table(worst: Mapping[str, tuple[float, int]]) -> str:
    """Rows of faults; those that differ in duration or direction only are one. `worst`: s and trials, by scenario."""
    lines = [_line(faults, scenarios, worst) for faults, scenarios in _grouped().items()]
    return _HEAD + "".join(lines)


def measured(record: Mapping[str, Any]) -> dict[str, tuple[float, int]]:
    """The worst of each scenario that stops, and its trials, of a campaign's record."""
    return {row["scenario"]: (row["worst_s"], row["trials"]) for row in record["rows"] if row["does"] == "stops"}


def newest_record() -> dict[str, Any] | None:
    """The newest campaign's; None when there is none."""
    paths = sorted(RECORDS.glob("*-faults.json"))
    return json.loads(paths[-1].read_text()) if paths else None


def written() -> str:
    """The table as the page has it."""
    return PAGE.read_text().partition(BEGIN)[2].partition(END)[0]


def write(record: Mapping[str, Any]) -> None:
    """Put the record's figures into the page."""
    before, _, rest = PAGE.read_text().partition(BEGIN)
    PAGE.write_text(before + BEGIN + table(measured(record)) + END + rest.partition(END)[2])


def _grouped() -> dict[str, list[Scenario]]:
    groups: dict[str, list[Scenario]] = {}
    for scenario in SCENARIOS:
        name = " + ".join(fault.name for fault in scenario.faults)
        groups.setdefault(f"{name} → {_then(scenario)}", []).append(scenario)
    return groups


def _line(group: str, scenarios: list[Scenario], worst: Mapping[str, tuple[float, int]]) -> str:
    name, then = group.split(" → ")
    if scenarios[0].does == "dips":
        name += f", {max(scenario.lasts for scenario in scenarios):g} s at most"
    bounds = sorted({f"{scenario.bound:g}" for scenario in scenarios if scenario.bound})
    found = list(_found(scenarios, worst))
    longest = f"{max(seconds for seconds, _ in found):.3f}" if found else ""
    trials = str(sum(count for _, count in found)) if found else ""
    return f"| {name} | {then} | {' or '.join(bounds)} | {longest} | {trials} |\n"


def _found(scenarios: list[Scenario], worst: Mapping[str, tuple[float, int]]) -> Iterator[tuple[float, int]]:
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

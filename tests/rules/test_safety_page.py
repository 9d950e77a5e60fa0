"""The fault table that people read is the one that is tested, with the figures that were measured."""

import re

from tests.dst.test_stops import ROWS
from tests.loop.test_motion_stops import ROWS as MOTION_ROWS
from tests.rules.node_ids import exists, is_simulated
from tests.rules.repository import ROOT
from tests.timing import fault_table
from tests.timing.faults import MOVING
from tests.timing.scenarios import SCENARIOS
from tests.timing.simulated import MOTION_STOPS, SIMULATED, STOPS, judge_of


def test_the_page_has_the_table_of_the_scenarios_and_of_what_was_measured() -> None:
    assert fault_table.written() == fault_table.table(fault_table.read()), (
        "python -m tests.timing.fault_table writes it"
    )


def test_there_are_enough_rows_and_each_has_its_own_name() -> None:
    assert len({scenario.name for scenario in SCENARIOS}) == len(SCENARIOS) >= 60


def test_what_was_measured_is_within_its_bound_and_of_rows_that_there_are() -> None:
    measured = fault_table.read()
    assert fault_table.dumped(measured) == fault_table.FILE.read_text()
    bounds = {scenario.name: scenario.bound for scenario in SCENARIOS if scenario.does == "stops"}
    late = {name: row for name, row in measured.scenarios.items() if row.worst_s > bounds.get(name, 0.0)}
    assert late == {}


def test_whoever_judges_a_row_in_simulated_time_is_there() -> None:
    assert [test for test in SIMULATED.values() if not is_simulated(test)] == []
    assert SIMULATED.keys() <= {scenario.fault for scenario in SCENARIOS}


def test_what_stops_in_simulated_time_has_the_bound_that_the_table_has() -> None:
    bounds = {each.fault: each.bound for each in SCENARIOS if judge_of(each).startswith((f"{STOPS}[", MOTION_STOPS))}
    moving = {f"{name}{MOVING}": row.bound for name, row in MOTION_ROWS.items()}
    assert bounds == {name: row.bound for name, row in ROWS.items()} | moving


def test_whoever_shows_what_a_page_says_is_there() -> None:
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md")]
    named = {
        each for page in pages for each in re.findall(r"tests/[\w/]+\.py(?:::\w+)?", page.read_text(encoding="utf-8"))
    }
    assert [test for test in sorted(named) if "::" in test and not exists(test)] == []


def test_each_letter_of_the_access_table_is_a_test() -> None:
    page = (ROOT / "docs" / "access.md").read_text(encoding="utf-8")
    legend = re.findall(r"^([a-z]) `tests/\S+::\w+`[,.]$", page, re.MULTILINE)
    used = {letter for letters in re.findall(r": ([a-z](?: [a-z])*)(?=;| \|)", page) for letter in letters.split()}
    assert (len(legend), set(legend)) == (len(used), used)

"""Every row of the fault campaign, several times: real processes, the real firmware, the board's own record."""

from __future__ import annotations

import os
import random
from collections.abc import Iterator

import msgspec
import pytest

from tests.campaign.fault_table import write as write_table
from tests.campaign.records import PROCESSES, ROBOT, judged, write_record
from tests.timing.faults import Scenario
from tests.timing.scenarios import SCENARIOS
from tests.timing.stalled import tried_again
from tests.timing.trials import Figures, Stand, judge_levels, judge_times, stand

REPETITIONS = 3
RANGER_CYCLE = 0.18  # s


class Campaign:
    """The figures of all trials."""

    def __init__(self) -> None:
        self.figures: dict[str, list[Figures]] = {}

    def write(self) -> None:
        """A record, of a whole campaign only."""
        if len(self.figures) < len(SCENARIOS):
            return
        rows = [self._row(scenario) for scenario in SCENARIOS]
        record = {
            "scenarios": len(rows),
            "trials": sum(map(len, self.figures.values())),
            "tried_again_for_stalls": tried_again(),
            "rows": rows,
        }
        write_record("faults", record, judged(__name__, *PROCESSES, "giraff_cli.estop", also=ROBOT))
        write_table(record)

    def _row(self, scenario: Scenario) -> dict[str, object]:
        trials = self.figures[scenario.name]
        row: dict[str, object] = {"scenario": scenario.name, "does": scenario.does, "trials": len(trials)}
        row["kept"] = all(keeps(scenario, each) for each in trials)
        if scenario.does == "stops":
            row |= {"bound_s": scenario.bound, "worst_s": round(max(each.driven_until for each in trials), 3)}
        return row | {"figures": [msgspec.to_builtins(each) for each in trials]}


def keeps(scenario: Scenario, figures: Figures) -> bool:
    try:
        judge_levels(scenario, figures)
        judge_times(scenario, figures)
    except AssertionError:
        return False
    return True


@pytest.fixture(scope="module")
def campaign() -> Iterator[Campaign]:
    made = Campaign()
    yield made
    made.write()


@pytest.fixture(scope="module")
def robots(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stand]:
    with stand(tmp_path_factory.mktemp("robots")) as made:
        yield made


@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda scenario: scenario.name)
def test_a_row_keeps_its_promise(scenario: Scenario, robots: Stand, campaign: Campaign) -> None:
    chance = random.Random(scenario.name)
    trials = campaign.figures[scenario.name] = []
    for _ in range(int(os.environ.get("REPETITIONS", REPETITIONS))):
        robots.tried(scenario, chance.uniform(0.0, RANGER_CYCLE), trials.append)
        print(trials[-1])


def test_there_are_enough_rows_and_each_has_its_own_name() -> None:
    assert len({scenario.name for scenario in SCENARIOS}) == len(SCENARIOS) >= 60

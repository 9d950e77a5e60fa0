"""Every row of the fault table: real processes, the real firmware, the board's own record. One robot for all.

When every row has kept its promise, docs/fault-table.toml and the table of docs/safety.md are written. TRIALS in the
environment: how many of each row, 1 if not told.
"""

import os
import random
import subprocess
from collections.abc import Iterator
from typing import Final

import pytest

from giraff_sim.board import ROOT
from tests.timing import fault_table
from tests.timing.faults import Scenario
from tests.timing.scenarios import SCENARIOS
from tests.timing.trials import Figures, Stand, stand

TRIALS: Final = int(os.environ.get("TRIALS", "1"))
RANGER_CYCLE: Final = 0.18
"""s; a trial begins at any moment of it."""


@pytest.fixture(scope="module")
def worst() -> Iterator[dict[str, float]]:
    """s to the last PWM, of each row that has kept its promise."""
    found: dict[str, float] = {}
    yield found
    if len(found) == len(SCENARIOS):
        command = ["git", "describe", "--always", "--dirty", "--exclude=*"]
        commit = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()
        fault_table.keep(commit, found, TRIALS)


@pytest.fixture(scope="module")
def robots(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stand]:
    with stand(tmp_path_factory.mktemp("robots")) as made:
        yield made


@pytest.mark.timeout(120 * TRIALS)
@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda scenario: scenario.name)
def test_a_row_keeps_its_promise(scenario: Scenario, robots: Stand, worst: dict[str, float]) -> None:
    chance = random.Random(scenario.name)
    trials: list[Figures] = []
    for _ in range(TRIALS):
        robots.tried(scenario, chance.uniform(0.0, RANGER_CYCLE), trials.append)
        print(trials[-1])
    worst[scenario.name] = max(each.driven_until for each in trials)

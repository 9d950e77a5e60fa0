"""How soon the wheels do what the hand does, with what ships, and what the robot's side works for it."""

import random
import time
from pathlib import Path
from typing import Final

import msgspec
import pytest

from tests.support.process_robot import ARENA, FULL_TILT, process_robot
from tests.support.report import report
from tests.timing.hand_to_wheel import Trial, figures, measured, processor, processor_table, robot_side, table
from tests.timing.sleepers import stalls_seen
from tests.timing.stalled import by_the_wall

ROBOTS: Final = 6
"""Started one after the other: each start draws anew how the services' paces lie to each other and to the boards'."""
PAIRS: Final = 10
"""Of a start and a stop, with each."""
SECONDS: Final = 10.0
SHARE: Final = 0.5
"""Of a core, for all of the robot's side."""
P50: Final = 27.0
P95: Final = 40.0
"""ms, of a stop."""
RAMP: Final = 10.0
"""ms that a start may take longer: by the next report of the board, its ramp has come to a level that is not 0."""


@pytest.mark.timeout(600)
def test_the_hand_reaches_the_wheels_at_once(tmp_path: Path) -> None:
    begin_ns, choose, trials = time.monotonic_ns(), random.Random(5), list[Trial]()
    with stalls_seen(tmp_path) as stalls:
        for number in range(ROBOTS):
            directory = tmp_path / str(number)
            directory.mkdir()
            with process_robot(directory, ARENA, truth="exact") as robot:
                trials += measured(robot, PAIRS, choose, stalls)
    stops, starts = ([trial for trial in trials if trial.does == does] for does in ("stop", "start"))
    found = {"stops": figures(stops), "starts": figures(starts)}
    report("timing/hand-to-wheel", found | {"trials": [msgspec.to_builtins(trial) for trial in trials]})
    print(table(trials))
    with by_the_wall(begin_ns):
        for of, longer in ((found["stops"], 0.0), (found["starts"], RAMP)):
            assert of["whole"]["p50"] <= P50 + longer, found
            assert of["whole"]["p95"] <= P95 + longer, found


@pytest.mark.timeout(300)
def test_what_the_robots_side_works(tmp_path: Path) -> None:
    begin_ns = time.monotonic_ns()
    with process_robot(tmp_path, ARENA, truth="exact") as robot:
        robot.drive(FULL_TILT / 3.0, FULL_TILT, 1.0)  # in circles from now on
        shares = processor(robot, SECONDS)
    report("timing/processor", {"robot's side": robot_side(shares)} | shares)
    print(processor_table(shares))
    with by_the_wall(begin_ns):
        assert robot_side(shares) <= SHARE, shares

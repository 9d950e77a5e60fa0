"""How soon a replugged base board is driven again."""

import statistics
import time
from pathlib import Path

from tests.support.process_robot import ProcessRobot, process_robot
from tests.timing.stalled import by_the_wall

REPLUGS = 5


def replug_time(robot: ProcessRobot) -> float:
    """Unplug the base board, plug it in: simulated s until it has accepted a drive frame."""
    robot.simulator.unplug("base")
    robot.run(0.5)
    plugged_us = robot.simulator.plug("base")
    accepted = robot.accepted()
    robot.wait("an accepted frame after the replug", lambda: robot.accepted() != accepted, 10.0)
    first_us = robot.simulator.record(plugged_us).first_accepted_us
    assert first_us is not None
    return (first_us - plugged_us) * 1e-6


def test_a_replugged_base_board_is_back_in_time(tmp_path: Path) -> None:
    with process_robot(tmp_path) as robot:
        begin_ns = time.monotonic_ns()
        times = [replug_time(robot) for _ in range(REPLUGS)]
        print(f"replug to first accepted frame: {', '.join(f'{each:.2f}' for each in sorted(times))} s")
        with by_the_wall(begin_ns):
            assert statistics.median(times) <= 1.0
            assert max(times) <= 2.0

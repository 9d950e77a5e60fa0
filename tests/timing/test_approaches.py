"""Real processes and the AVR firmware drive at a wall."""

import math
import random
import time
from pathlib import Path

from tests.support.process_robot import FULL_TILT, process_robot
from tests.timing.stalled import by_the_wall

APPROACHES = 5
MARGIN = 0.25  # m, of `[guard]`


def test_five_approaches_stop_outside_the_margin(tmp_path: Path) -> None:
    choose = random.Random(5)
    # Exactly as its file says: another one comes by an arc, on which it may lose the wall (tests/loop has those).
    with process_robot(tmp_path, truth="exact") as robot:
        for number in range(APPROACHES):
            begin_ns = time.monotonic_ns()
            incidence = choose.uniform(-1.0, 1.0) * math.radians(25.0)
            distance = choose.uniform(1.2, 2.5)
            robot.simulator.place(0.0, 0.0)
            x, dx, dy = distance * math.cos(incidence), -math.sin(incidence) * 10.0, math.cos(incidence) * 10.0
            y = distance * math.sin(incidence)
            x, y = x * math.cos(incidence), y * math.cos(incidence)
            robot.simulator.add_wall("wall", [(x - dx, y - dy), (x + dx, y + dy)])
            robot.simulator.tilt(0.0, 0.0)
            robot.run(1.5)
            robot.simulator.tilt(FULL_TILT, 0.0)
            robot.wait("driving", robot.drives, 10.0)
            robot.run(distance / 0.6 + 3.0)
            state = robot.simulator.state()
            print(f"approach {number}: at rest {state.clearance:.3f} m from the wall")
            assert state.contacts == 0
            assert state.clearance >= MARGIN
            assert not robot.drives()
            with by_the_wall(begin_ns):  # a stall stops it before, and disarms it
                assert state.clearance <= MARGIN + 0.35
                robot.simulator.tilt(-FULL_TILT, 0.0)
                robot.run(1.5)
                assert robot.simulator.state().clearance > state.clearance + 0.1
            robot.simulator.remove_wall("wall")

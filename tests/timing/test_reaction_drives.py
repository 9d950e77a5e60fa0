"""Ten drives at an obstacle that appears, with real processes and the real firmware, one reading in twenty wild."""

import random
import time
from pathlib import Path
from typing import Final

import msgspec
import pytest

from giraff_schemas.messages import Range
from giraff_schemas.topics import RANGE
from giraff_sim.world.sonar import SonarFault
from tests.support.process_robot import ARENA, ProcessRobot, process_robot
from tests.support.report import report
from tests.timing.faults import FORWARD, Scenario
from tests.timing.sleepers import Stalls, stalls_seen
from tests.timing.stalled import STALL, by_the_wall
from tests.timing.trials import back_to_the_middle, wall_clock_offset_us

DRIVES: Final = 10
BOUND: Final = 0.060
"""s from the first short reading to PWM 0, of a machine that adds nothing."""
WILD: Final = 0.05
AHEAD: Final = 0.70  # m from the robot's middle: too near for full speed, and far enough to stop before
SHORT: Final = 0.60  # m; what the front sensors read of it at the most
LONGEST: Final = 0.3  # s that are looked through for the stop
ROW: Final = Scenario(faults=())


class Reaction(msgspec.Struct, frozen=True, kw_only=True):
    """Of one drive, s."""

    reaction: float
    """From the first short reading, as the ranger had it, to the first millisecond without PWM."""
    longest_stall: float
    """Of the machine, in that drive: what it may have added."""
    clearance: float
    """m, at rest."""
    contacts: int


def react(robot: ProcessRobot, heard: list[Range], phase: float, stalls: Stalls) -> Reaction:
    """Drive, put up a wall, and find the stop in the black box."""
    begin_ns = time.monotonic_ns()
    for sensor in (0, 1):
        robot.simulator.fail_sonar(sensor, SonarFault.WILD_SOME, WILD)
    robot.drive(*FORWARD, seconds=1.3 + phase)
    heard.clear()
    put_up_us = robot.put_up_wall("sudden", AHEAD, half_width=1.0)
    robot.run(0.6)
    offset_us = wall_clock_offset_us(robot)
    # From the wall on: a ping that was under way is not of it.
    short = [
        each.stamp_ns / 1e3 + offset_us
        for each in heard
        if each.sensor != "rear" and each.range is not None and each.range < SHORT
    ]
    first_us = round(min(at for at in short if at > put_up_us))
    reaction = next((ms / 1e3 for ms in range(round(LONGEST * 1e3)) if _is_zero(robot, first_us + ms * 1000)), LONGEST)
    robot.run(0.5)
    state = robot.simulator.state()
    end_ns = time.monotonic_ns()
    robot.simulator.remove_wall("sudden")
    for sensor in (0, 1):
        robot.simulator.fail_sonar(sensor, SonarFault.NONE)
    robot.arm()
    back_to_the_middle(robot, ROW)
    return Reaction(
        reaction=reaction,
        longest_stall=stalls.longest(begin_ns, end_ns),
        clearance=state.clearance,
        contacts=state.contacts,
    )


def _is_zero(robot: ProcessRobot, at_us: int) -> bool:
    return robot.simulator.record(at_us, at_us + 1000).driven_ms == 0


@pytest.mark.timeout(600)
def test_the_first_short_reading_stops_it_at_once(tmp_path: Path) -> None:
    chance = random.Random(3)
    drives: list[Reaction] = []
    begin_ns = time.monotonic_ns()
    heard: list[Range] = []
    with process_robot(tmp_path, ARENA) as robot, stalls_seen(tmp_path) as stalls:
        robot.observer.listen(RANGE, heard.append)
        for _ in range(DRIVES):
            phase = chance.uniform(0.0, 0.18)
            drives.append(react(robot, heard, phase, stalls))
            print(drives[-1])
    figures = {
        "bound_s": BOUND,
        "worst_s": max(each.reaction for each in drives),
        "drives": [msgspec.to_builtins(each) for each in drives],
    }
    report("timing/reaction-drives", figures)
    for each in drives:
        assert each.contacts == 0, each
        with by_the_wall(begin_ns):
            assert each.reaction <= BOUND + min(each.longest_stall, STALL), each

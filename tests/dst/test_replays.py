"""Old traffic that comes again, as TCP and serial buffers have been seen to do: nothing of it moves a motor."""

from __future__ import annotations

from random import Random

import pytest

from giraff_schemas.messages import DriveCommand, GuardedCommand, Lease, Range, Tick, Wheels
from giraff_sim.dst.drill import Drill
from giraff_sim.dst.faults import Begin, Course
from giraff_sim.hand import LEVEL
from giraff_sim.record import Verdict
from tests.dst.courses import cut, hold_frames, replay, watch
from tests.dst.stage import FORWARD, at, driving, stage

LATE = (1.0, 2.0, 5.0, 8.0, 15.0, 30.0, 60.0)
"""s from the end of what was said to its replay."""
SAID = 4.5  # s; the hand drives from 2.5 on
HOUR = 3600.0


def wall_clocks(operator: float, robot: float) -> Begin:
    """Set both machines' wall clocks wrong, s."""

    def course(drill: Drill, chance: Random) -> Course:
        del chance
        for name, ahead in (("operator", operator), ("robot", robot)):
            drill.loop.hosts[name].wall_ahead_ns = round(ahead * 1e9)
        yield "the wall clocks are wrong"

    return course


@pytest.mark.parametrize(
    ("operator", "robot"), [(0.0, 0.0), (HOUR, 0.0), (-HOUR, 0.0), (30.0, HOUR), (HOUR, -HOUR)], ids=str
)
def test_a_recorded_stream_moves_nothing_however_late_it_comes(operator: float, robot: float) -> None:
    """The robot is armed, the lease held, the hand level: what comes again is all that could move it."""
    verdicts: list[Verdict] = []
    befalls = [at(0.1, wall_clocks(operator, robot))]
    for late in LATE:
        moment = SAID + late
        befalls += [
            at(moment, replay(DriveCommand, since=2.5, until=SAID)),
            at(moment + 0.1, replay(GuardedCommand, since=2.5, until=SAID)),
            at(moment + 0.2, replay(DriveCommand, Lease, Tick, Range, Wheels, GuardedCommand, since=2.5, until=SAID)),
            at(moment, watch(verdicts), lasts=0.7),
        ]
    nudges = [change for moment in (16.0, 28.0, 44.0, 62.0) for change in ((moment, FORWARD), (moment + 0.4, LEVEL))]
    outcome = stage(*befalls, hand=driving((SAID - 0.2, LEVEL), *nudges), seconds=SAID + LATE[-1] + 1.0)
    assert outcome.violations == ()
    assert len(verdicts) == len(LATE)
    assert [verdict.driven_ms for verdict in verdicts] == [0] * len(LATE)
    assert outcome.counts["armed"] == 1, "a replay disarmed the robot, so the next ones proved nothing"
    assert outcome.path > 0.5, "the stream was not one that drives"


@pytest.mark.parametrize("lasts", [1.5, 5.0, 12.0])
def test_what_tcp_held_during_a_cut_moves_nothing(lasts: float) -> None:
    verdicts: list[Verdict] = []
    outcome = stage(at(4.0, cut("holds"), lasts), at(4.45, watch(verdicts), lasts + 1.5), seconds=lasts + 6.5)
    assert outcome.violations == ()
    assert [verdict.driven_ms for verdict in verdicts] == [0]
    assert outcome.path > 0.2


@pytest.mark.parametrize("held", [1.5, 2.0, 8.0, 29.0, 60.0])
def test_queued_serial_frames_move_nothing(held: float) -> None:
    """Among them are zero ones, which open the board's latch, and then such with levels; the hand is level again."""
    verdicts: list[Verdict] = []
    outcome = stage(
        at(3.5, hold_frames, held),
        at(3.5 + 0.35, watch(verdicts), held + 0.5),
        hand=driving((3.6, LEVEL), (4.0, FORWARD), (3.5 + held - 0.3, LEVEL)),
        seconds=held + 5.0,
    )
    assert outcome.violations == ()
    assert [verdict.driven_ms for verdict in verdicts] == [0]
    assert verdicts[0].refused > 20, "no queued frame reached the board"

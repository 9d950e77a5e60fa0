"""Old traffic that comes again, as TCP and serial buffers have been seen to do: staged, and nothing of it may move."""

from collections.abc import Sequence
from functools import partial
from random import Random
from typing import Final

from giraff_schemas.messages import DriveCommand, GuardedCommand, Lease, Range, Tick, Wheels
from giraff_sim.dst.simulated_run import Begin, Course, SimulatedRun
from giraff_sim.record import MotorWindow
from giraff_sim.world.hand import LEVEL
from tests.dst.courses import cut, hold_frames, replay, watch
from tests.dst.stage import FORWARD, SET_OFF, at, driving, stage

HOUR: Final = 3600.0
CLOCKS: Final = ((0.0, 0.0), (HOUR, 0.0), (-HOUR, 0.0), (30.0, HOUR), (HOUR, -HOUR))
"""How far the wall clocks of operator and robot are ahead, s."""
_SAID: Final = 3.5  # s


def wall_clocks(operator: float, robot: float) -> Begin:
    """Set both machines' wall clocks wrong, s."""

    def course(run: SimulatedRun, chance: Random) -> Course:
        del chance
        for name, ahead in (("operator", operator), ("robot", robot)):
            run.loop.hosts[name].wall_ahead_ns = round(ahead * 1e9)
        yield "the wall clocks are wrong"

    return course


def say_a_stream_again(operator: float, robot: float, late: Sequence[float]) -> None:
    """So many s after it was said; the robot is armed, the lease held, the hand level: it is all that could move it."""
    verdicts: list[MotorWindow] = []
    again = partial(replay, since=SET_OFF, until=_SAID)
    faults = [at(0.1, wall_clocks(operator, robot))]
    for each in late:
        moment = _SAID + each
        faults += [
            at(moment, again(DriveCommand)),
            at(moment + 0.1, again(GuardedCommand)),
            at(moment + 0.2, again(DriveCommand, Lease, Tick, Range, Wheels, GuardedCommand)),
            at(moment, watch(verdicts), lasts=0.7),
        ]
    nudges = [change for moment in (15.0, 27.0, 43.0, 61.0) for change in ((moment, FORWARD), (moment + 0.4, LEVEL))]
    outcome = stage(*faults, hand=driving((_SAID - 0.2, LEVEL), *nudges), seconds=_SAID + late[-1] + 1.0)
    assert outcome.violations == ()
    assert [verdict.driven_ms for verdict in verdicts] == [0] * len(late)
    assert outcome.counts["armed"] == 1, "a replay disarmed the robot, so the next ones proved nothing"
    assert outcome.path > 0.5, "the stream was not one that drives"


def hold_in_tcp(lasts: float) -> None:
    """Cut the network for so long, s; what was said meanwhile comes after it."""
    verdicts: list[MotorWindow] = []
    outcome = stage(at(2.5, cut("holds"), lasts), at(2.95, watch(verdicts), lasts + 1.5), seconds=lasts + 4.5)
    assert outcome.violations == ()
    assert [verdict.driven_ms for verdict in verdicts] == [0]
    assert outcome.path > 0.2


def hold_in_the_serial_line(held: float) -> None:
    """Keep the base board's frames for so long, s.

    Among them are zero ones, which open the board's latch, and then such with levels; the hand is level again.
    """
    verdicts: list[MotorWindow] = []
    outcome = stage(
        at(2.5, hold_frames, held),
        at(2.5 + 0.35, watch(verdicts), held + 0.5),
        hand=driving((2.6, LEVEL), (3.0, FORWARD), (2.5 + held - 0.3, LEVEL)),
        seconds=held + 3.4,
    )
    assert outcome.violations == ()
    assert [verdict.driven_ms for verdict in verdicts] == [0]
    assert verdicts[0].refused > 100, "the queued frames were not refused for their age"

"""Faults of a laser scanner while the robot drives by it, and how long it drives on."""

import random
from collections.abc import Callable
from typing import Final, NamedTuple

from giraff_sim.config import SimConfig
from giraff_sim.world.ld19 import Ld19Fault
from giraff_sim.world.room import Pose, Room
from tests.loop.loops import FULL_TILT, SETTINGS, drawn, hold
from tests.loop.scanning import Scanned, scanned

BOUND: Final = 0.6  # s
CREEP: Final = SETTINGS.guard.creep_linear + 1e-6
_STEADY_S: Final = 0.2  # before the fault, in which nothing else may slow the robot


Begin = Callable[[Scanned], None]


def _is(fault: Ld19Fault) -> Begin:
    def begin(robot: Scanned) -> None:
        robot.laser.fault = fault

    return begin


def _hang(robot: Scanned) -> None:
    robot.loop.processes["scan"].paused = True


STOPPING: Final[dict[str, Begin]] = {
    "cable out": lambda robot: robot.loop.cables["scan"].unplug(),
    "service hung": _hang,
    "motor held": _is(Ld19Fault.HELD),
    "motor coasts down": _is(Ld19Fault.COASTS),
    "same bytes again and again": _is(Ld19Fault.REPEATS),
}
FAULTS: Final[dict[str, Begin]] = {
    **STOPPING,  # the others slow it to a creep
    "5 % of bytes broken": _is(Ld19Fault.BROKEN),
    "covered, no echo": _is(Ld19Fault.NO_ECHO),
    "covered, 3 cm": _is(Ld19Fault.LID),
    "a third covered ahead": _is(Ld19Fault.THIRD),
}


class Reaction(NamedTuple):
    """Outcome of one fault."""

    steady: float
    """m/s. Smallest command shortly before the fault."""
    blind: int
    """Most sectors that told nothing shortly before it."""
    seconds: float
    """s from the fault until the wheels are told to stop, or to creep; infinite: they were not."""


def react(name: str, seed: int, after: float) -> Reaction:
    """Drive at full tilt in a bare room for `after` s or a little longer, until the fault, and `BOUND` beyond."""
    choose = random.Random(f"{seed}/fault")
    room = Room("room", Pose(-1.5, 0.3, choose.uniform(-0.3, 0.3)))
    room.add_wall("walls", [(3.0, 2.0), (-3.0, 2.0), (-3.0, -2.0), (3.0, -2.0)], closed=True)
    with scanned(room, seed, sim=SimConfig(), truth=drawn(seed)) as robot:
        loop = robot.loop
        hold(loop, FULL_TILT)
        loop.run(after + choose.uniform(0.0, 0.1) - _STEADY_S)
        steady, blind, end_us = 1.0, 0, loop.simulation.now_us + round(_STEADY_S * 1e6)
        while loop.simulation.now_us < end_us:
            loop.step()
            steady = min(steady, loop.newest["cmd_vel"].linear_x)
            blind = max(blind, len(robot.turns[-1].blind))
        begun_us, most = loop.simulation.now_us, 0.0 if name in STOPPING else CREEP
        FAULTS[name](robot)
        while (now_us := loop.simulation.now_us) - begun_us <= BOUND * 1e6:
            loop.step()
            if loop.newest["cmd_vel"].linear_x <= most:
                return Reaction(steady, blind, (now_us - begun_us) * 1e-6)
        return Reaction(steady, blind, float("inf"))

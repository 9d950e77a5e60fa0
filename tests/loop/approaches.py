"""Driving at a wall, in simulated time: what an approach is, and what must hold of each."""

import math
import random
from typing import Final

import pytest

from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.truth import TrueWheel, Truth
from giraff_sim.world import sonar
from giraff_sim.world.room import Room
from tests.loop.loops import FULL_TILT, SETTINGS, arm, closed_loop, hold, spare_time
from tests.sim.robots import empty_room

LARGEST_INCIDENCE: Final = math.radians(25.0)
MARGIN: Final = SETTINGS.guard.margin
OF_USE: Final = MARGIN + 0.35
"""m from the wall: a guard that stops the robot farther out is of no use."""
WEAK: Final = Truth(right=TrueWheel(strength=0.85))
"""Driven straight on, it goes to the right by an arc of 2.9 m; backwards too."""
SMOOTH_MARGIN: Final = 0.20  # m


def come_to_rest(loop: ClosedLoop) -> None:
    """Run until the robot has stood still for a second."""
    until = loop.simulation.now_us + 40_000_000
    still_us = 0
    while still_us < 1_000_000:
        assert loop.simulation.now_us < until, f"the robot does not stop: {loop.newest['guard']}"
        loop.step()
        wheels = loop.newest["wheels"]
        is_still = (wheels.left_velocity, wheels.right_velocity) == (0.0, 0.0)
        still_us = still_us + loop.simulation.world.step_us if is_still else 0


def slanted(distance: float, incidence: float) -> Room:
    """A wall that crosses the robot's axis `distance` m ahead (negative: behind), slanted by `incidence` rad."""
    room = empty_room()
    x, y = distance * math.cos(incidence) ** 2, distance * math.cos(incidence) * math.sin(incidence)
    along = (-math.sin(incidence) * 10.0, math.cos(incidence) * 10.0)
    room.add_wall("wall", [(x - along[0], y - along[1]), (x + along[0], y + along[1])])
    return room


def approach(number: int) -> float:
    """One approach from its seed, which stops outside the margin and can get away: m to the wall where it rests."""
    choose = random.Random(number)
    incidence = choose.uniform(-LARGEST_INCIDENCE, LARGEST_INCIDENCE)
    distance = choose.uniform(1.0, 3.0)
    tilt = choose.uniform(2.5, 7.5)  # of the default curve: from a third of the speed up to all of it
    backward = choose.random() < 0.3
    side = -1.0 if backward else 1.0
    with closed_loop(slanted(side * distance, incidence), seed=number) as loop:
        spare_time(loop)
        plant = loop.simulation.world.plant
        arm(loop)
        hold(loop, x=side * tilt)
        loop.run(choose.uniform(1.0, 1.2))  # the ranger's cycle is 0.18 s: arrive at any moment of it
        come_to_rest(loop)
        assert plant.contacts == 0, f"approach {number} touched the wall"
        rest = plant.clearance
        way = "backward" if backward else "forward"
        verdict = getattr(loop.newest["guard"], way)
        assert verdict.clearance == "blocked"
        assert verdict.sensor
        assert verdict.reason.remedy
        if choose.random() < 0.5:
            before = plant.pose.yaw
            hold(loop, y=3.0)
            loop.run(1.5)
            assert abs(plant.pose.yaw - before) > 0.2, f"approach {number} cannot turn away"
        else:
            hold(loop, x=-side * 4.0)
            loop.run(2.0)
            assert plant.clearance > rest + 0.1, f"approach {number} cannot back away"
        assert plant.closest >= MARGIN, f"approach {number}: {plant.closest:.3f} m is inside the margin"
        return rest


def curve_before_a_smooth_wall(monkeypatch: pytest.MonkeyPatch, distance: float, loses_at: float, side: float) -> None:
    """Stop a robot whose right motor is 15 % weak before a wall that it no longer hears.

    The wall is so smooth that nothing comes back from it beyond 25 degrees, which the robot's arc passes about
    `loses_at` m before it: what was heard until then must keep it off. `side`: 1 forward, -1 backward.
    """
    monkeypatch.setattr(sonar, "_DOUBTFUL", sonar._SURE)
    monkeypatch.setattr(sonar, "_HEARD_SLANTED", 0.0)
    monkeypatch.setattr(sonar, "_LOST_SLANTED", 1.0)
    curvature = 2.0 * 0.15 / (1.85 * SETTINGS.robot.track_width)
    incidence = LARGEST_INCIDENCE - curvature * max(0.0, distance - loses_at)
    room = slanted(side * distance, side * incidence)
    with closed_loop(room, truth=WEAK) as loop:
        spare_time(loop)
        plant = loop.simulation.world.plant
        arm(loop)
        hold(loop, x=side * FULL_TILT)
        loop.run(8.0)  # what is remembered blocks for as long
        assert abs(plant.speed) < 1e-3, loop.newest["guard"]
        assert plant.closest >= SMOOTH_MARGIN
        assert plant.path_length > 0.2

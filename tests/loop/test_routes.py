"""A route through the whole robot in simulated time: what ends it, how it goes on. Pins and world are the judge."""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final, NamedTuple

import pytest

from giraff_core.kinematics.pose import Pose
from giraff_schemas.places import Goal
from giraff_schemas.topics import MOTION, ROUTE
from tests.loop.locator import ODOM_IN_MAP, PLAN, Locator
from tests.loop.loops import SETTINGS
from tests.loop.motions import Stage, stage
from tests.loop.routes import Walker, drive, goal_of, home, start_places
from tests.loop.test_motion_ends import STOPS
from tests.loop.test_motion_map import SILENT, TOLD
from tests.loop.test_motion_stops import LASTS, OPERATORS, Row, go_on, kill, pause
from tests.sim.robots import proving_room

_AHEAD: Final = Pose(2.0, 0.0, 0.0).placed_in(ODOM_IN_MAP)
_GOAL: Final = Goal(x=_AHEAD.x, y=_AHEAD.y)
_CREEPS: Final = 0.13
"""m/s; the guard's creep, and what the wheels' control adds to it."""


class Routed(NamedTuple):
    """A robot on its way."""

    stage: Stage
    walker: Walker


@contextmanager
def routed() -> Iterator[Routed]:
    """A robot that has begun a route of 2 m straight on, and its localization, which goes by odometry."""
    with stage(proving_room()) as it:
        it.start_stopper()
        it.loop.launch("localization", Locator, it.loop.hosts["robot"])
        walker = start_places(it, SETTINGS.robot, PLAN)
        it.run(0.6)
        walker.go(_GOAL)
        began = it.now
        while it.driven_ms(began) < 600:
            assert it.now - began < 4.0, (walker.result, walker.state)
            it.run(0.1)
        yield Routed(it, walker)


def start_walker(it: Stage) -> None:
    """Start another program, which asks for nothing."""
    it.loop.launch("walker", Walker, it.loop.hosts["operator"])


def start_its_places(it: Stage) -> None:
    start_places(it, SETTINGS.robot, PLAN)


ROWS: Final = {
    "requester killed": Row(OPERATORS, kill("walker"), start_walker, "lost_requester"),
    "requester suspended": Row(OPERATORS, pause("walker"), go_on("walker"), "lost_requester"),
    "places killed": Row(OPERATORS, kill("places"), start_its_places),
    "places suspended": Row(OPERATORS, pause("places"), go_on("places"), "lost_requester"),
    "localization killed": Row(SILENT + TOLD + STOPS, kill("localization"), outcome="lost_localization"),
    "e-stop engaged": Row(STOPS, Stage.engage, Stage.reset, "disarmed"),
}
"""By the names of docs/safety.md, where a route moves it. The others are in tests/campaign/test_routes.py."""


@pytest.mark.parametrize("name", ["requester suspended", "localization killed"])
def test_a_fault_stops_a_route_within_its_bound_for_good(name: str) -> None:
    stop_a_route(ROWS[name])


def stop_a_route(row: Row) -> None:
    """Have a fault come while a route moves the robot, and mend it: the robot stops, and moves no more."""
    with routed() as it:
        fault = it.stage.now
        row.begin(it.stage)
        it.stage.run(LASTS)
        row.mend(it.stage)
        it.stage.run(1.2)
        assert it.stage.last_driven(fault) <= row.bound
        if row.outcome:
            assert it.stage.loop.newest[ROUTE.key].outcome == row.outcome


def test_after_a_wait_it_says_that_it_goes_on_and_creeps() -> None:
    with routed() as it:
        plant, room = it.stage.loop.simulation.world.plant, it.stage.loop.simulation.world.room
        x, y, _ = plant.pose
        room.add_wall("box", [(x + 0.75, y - 0.3), (x + 0.75, y + 0.3)])
        _until(it, lambda: it.stage.loop.newest[ROUTE.key].stage == "waiting")
        room.remove("box")
        waits, stood = it.stage.now, plant.path_length
        _until(it, lambda: "goes on" in str(it.stage.loop.newest[ROUTE.key].reason))
        said = it.stage.now
        assert said - waits == pytest.approx(5.0, abs=0.2)
        _until(it, lambda: it.stage.driven_ms(said) > 0)
        assert it.stage.now - said >= 1.0
        assert it.stage.driven_ms(waits, said) == 0
        while plant.path_length - stood < 0.3:
            it.stage.run(0.02)
            assert abs(plant.speed) < _CREEPS
        assert abs(plant.pose.y) > 0.2, "it does not go around"


def test_it_arrives_in_a_furnished_home_by_its_sonars() -> None:
    with home("living_room", "sonars", 53) as it:
        told = drive(it, 53, "living_room", goal_of(it.floor, "living_room", 53, it.truth, least=1.0))
    assert told.outcome == "arrived", told
    assert told.off < 0.25, told
    assert told.turned < math.radians(15.0), told
    assert not told.touches, told


def _until(it: Routed, holds: Callable[[], bool]) -> None:
    began = it.stage.now
    while not holds():
        it.stage.run(0.02)
        assert it.stage.now - began < 12.0, (it.stage.loop.newest[ROUTE.key], it.stage.loop.newest[MOTION.key])

"""A route through a home, with the real localization: what becomes of it, by the world's own truth."""

import math
import random
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, partial
from typing import Any, Final, NamedTuple

import msgspec

from giraff_core.kinematics.pose import Pose as MapPlace
from giraff_core.motion.requester import HeldMotion, MotionRequester
from giraff_core.motion.result import MotionResult
from giraff_core.motion.wish import RouteWish
from giraff_core.robot import RobotConfig
from giraff_core.senses import Sense
from giraff_core.timer import Timer
from giraff_localization.config import LocalizationConfig
from giraff_localization.floor import Floor as KnownFloor
from giraff_localization.service import Localization
from giraff_maps.floor_plan import FloorPlan
from giraff_maps.places_file import KnownPlaces
from giraff_maps.read import read_map
from giraff_places.config import PlacesConfig
from giraff_places.policy import PlanFile
from giraff_places.route.planner import Route, RoutePlanner
from giraff_places.service import Places
from giraff_scan.config import ScanConfig
from giraff_scan.service import Scan
from giraff_schemas.localization import LocalizationSetPose
from giraff_schemas.places import Goal, RouteState
from giraff_schemas.topics import LOCALIZATION_SET_POSE, PLACES_HOLD, ROUTE, TICK
from giraff_sim.config import SimConfig
from giraff_sim.hosts.cable import Cable
from giraff_sim.hosts.process import Process
from giraff_sim.truth import draw_truth
from giraff_sim.world.ld19 import Ld19
from giraff_sim.world.room import Pose
from giraff_sim.world.sonar import SonarFault
from tests.loop.localization.floors import FILES, Differences, Floor, floor, start_at
from tests.loop.loops import SETTINGS
from tests.loop.motions import Stage, stage
from tests.loop.rooms import WILD_SHARE
from tests.loop.scanning import LASER
from tests.support.robots import ROBOT, ULTRASONIC

SENSES: Final[dict[str, dict[str, Sense]]] = {"sonars": {**ULTRASONIC}, "scan": {"laser": LASER, **ULTRASONIC}}
FURNISHED: Final = Differences(sloppy=0.03)
_STEP: Final = 0.1
"""s"""
_TOLD: Final = 0.1
"""m, and rad: standard deviation of where somebody says that the robot is."""
_ROOM: Final = 0.65
"""m about a goal: the guard lets the robot come to it from each side."""
_LONGEST: Final = 400.0
"""s of a route."""
LOCALIZATION: Final = LocalizationConfig()


class Walker:
    """A program that asks for one route, and holds it with what ships for that."""

    link = None

    def __init__(self, process: Process) -> None:
        self.result: MotionResult | None = None
        self.state: RouteState | None = None
        """The newest."""
        self._process = process
        self._ticks, self._states = process.inbox(TICK, wakes=False), process.inbox(ROUTE, wakes=False)
        self._holds = process.publisher(PLACES_HOLD)
        self._requester: MotionRequester | None = None
        self._motion: HeldMotion | None = None
        self.timers = (Timer(50.0),)

    def go(self, goal: str | Goal) -> None:
        self.result = None
        self._requester = MotionRequester(self._process.token(), RouteWish(goal), "a script", self._process.instance)
        self._motion = HeldMotion(
            self._requester, lambda query, request: self._process.ask(query, request, lambda _: True), self._holds.put
        )

    def tell_pose(self, pose: Pose) -> None:
        told = LocalizationSetPose(by="a script", id=1, x=pose.x, y=pose.y, yaw=pose.yaw)
        self._telling = self._process.ask(LOCALIZATION_SET_POSE, told, lambda _: True)
        self._telling.poll(self._process.monotonic())

    def turn(self, now: float) -> None:
        self.timers[0].due(now)
        ticks, states = [*self._ticks.pop_all()], [*self._states.pop_all()]
        for state in states:
            self.state = state
        if self._requester is None or self._motion is None or self.result is not None:
            return
        for tick in ticks:
            self._requester.on_tick(tick, now)
        for state in states:
            self._requester.on_state(state, now)
        self.result = self._motion.turn(now)

    def end(self) -> None:
        """Nothing is left to say."""


class _Book:
    """In the place of the file of places."""

    def read(self) -> KnownPlaces:
        return KnownPlaces()


@cache
def plan_of(world: str) -> FloorPlan:
    return read_map(FILES[world])


@cache
def _known_floor(world: str, sense: str) -> KnownFloor:
    made = KnownFloor(plan_of(world), LOCALIZATION, msgspec.structs.replace(ROBOT, sensors=SENSES[sense]))
    for _ in made.build():
        pass
    return made


@cache
def planner_of(world: str) -> RoutePlanner:
    return RoutePlanner(plan_of(world), ROBOT.footprint_radius, ROBOT.passage_radius)


class Home(NamedTuple):
    """A robot in a home, with all of its services, and who asks."""

    stage: Stage
    walker: Walker
    floor: Floor

    @property
    def truth(self) -> Pose:
        return self.stage.loop.simulation.world.plant.pose

    @property
    def route(self) -> RouteState:
        state: RouteState = self.stage.loop.newest[ROUTE.key]
        return state


@contextmanager
def home(
    world: str, sense: str, seed: int, start: Pose | None = None, differences: Differences = FURNISHED
) -> Iterator[Home]:
    """A drawn robot in a home that differs a little from its plan. It was told where it is, to a hand's breadth."""
    chance = random.Random(f"{seed}/route")
    here = floor(world, differences, seed)
    if start is None:
        start = start_at(here, chance.choice(sorted(here.free)), chance.uniform(-math.pi, math.pi))
    else:
        here.room.start = start
    robot = msgspec.structs.replace(ROBOT, sensors=SENSES[sense])
    settings = msgspec.structs.replace(SETTINGS, robot=robot)
    truth = draw_truth("uncalibrated", SimConfig().truth, seed)
    with stage(here.room, seed=seed, settings=settings, truth=truth) as it:
        loop, simulated = it.loop, it.loop.simulation.world
        for sonar in simulated.sonars.values():
            sonar.fault, sonar.wild_share = SonarFault.WILD_SOME, WILD_SHARE
        if sense == "scan":
            laser = Ld19(LASER, simulated, f"{seed}/laser", bias=chance.uniform(-0.015, 0.015))
            loop.cables["scan"] = Cable(laser, loop.simulation)
            loop.launch("scan", lambda io: Scan(io, ScanConfig(port="scan"), robot), loop.hosts["robot"])
        known = _known_floor(world, sense)
        loop.launch("localization", lambda io: Localization(io, LOCALIZATION, robot, known, seed), loop.hosts["robot"])
        walker = start_places(it, robot, plan_of(world))
        it.run(0.5)
        pose = simulated.plant.pose
        walker.tell_pose(
            Pose(pose.x + chance.gauss(0, _TOLD), pose.y + chance.gauss(0, _TOLD), pose.yaw + chance.gauss(0, _TOLD))
        )
        it.run(1.5)
        yield Home(it, walker, here)


def start_places(it: Stage, robot: RobotConfig, plan: FloorPlan) -> Walker:
    """Start giraff_places, and a program of the operator's that asks for routes."""
    book: Any = _Book()
    places = partial(Places, config=PlacesConfig(), robot=robot, source=PlanFile(plan, "home.toml"), store=book)
    it.loop.launch("places", places, it.loop.hosts["robot"])
    walkers: list[Walker] = []

    def walker(process: Process) -> Walker:
        walkers.append(Walker(process))
        return walkers[-1]

    it.loop.launch("walker", walker, it.loop.hosts["operator"])
    return walkers[0]


class Told(NamedTuple):
    """What became of one route."""

    seed: int
    goal: Goal
    outcome: str
    reason: str
    off: float
    """m from the goal, by the truth."""
    turned: float
    """rad, the same."""
    seconds: float
    way: float
    """m that the robot truly came."""
    shortest: float
    """m of the shortest way by the plan."""
    touches: tuple[float, ...]
    """m/s of each."""
    fastest: float
    """m/s"""
    waits: tuple[str, ...]
    """Reasons."""


def goal_of(here: Floor, world: str, seed: int, start: Pose, least: float = 2.0) -> Goal:
    """Draw a goal that the robot can get to from each side, `least` m away or more."""
    chance, planner = random.Random(f"{seed}/goal"), planner_of(world)
    cells = sorted(here.free)
    while True:
        x, y = here.middle(chance.choice(cells))
        goal = MapPlace(x, y, chance.uniform(-math.pi, math.pi))
        has_room = planner.floor.near(x, y) >= _ROOM
        if (
            has_room
            and math.dist((x, y), start[:2]) > least
            and isinstance(planner.route(MapPlace(*start), goal), Route)
        ):
            return Goal(x=x, y=y, yaw=goal.yaw)


def drive(it: Home, seed: int, world: str, goal: Goal, meanwhile: Callable[[Home], None] = lambda _: None) -> Told:
    """Have the robot go there. `meanwhile` is called ten times a second."""
    simulated, plant = it.stage.loop.simulation, it.stage.loop.simulation.world.plant
    start, path, began, contacts = it.truth, plant.path_length, it.stage.now, plant.contacts
    it.walker.go(goal)
    touches: list[float] = []
    waits: list[str] = []
    fastest = 0.0
    while it.walker.result is None and it.stage.now - began < _LONGEST:
        end = simulated.now_us + round(_STEP * 1e6)
        while simulated.now_us < end:
            speed = abs(plant.speed)
            it.stage.loop.step()
            fastest = max(fastest, abs(plant.speed))
            if plant.contacts > contacts:
                contacts = plant.contacts
                touches.append(speed)
        state = it.route
        if state.stage == "waiting" and (not waits or waits[-1] != str(state.reason)):
            waits.append(str(state.reason))
        meanwhile(it)
    way = planner_of(world).route(MapPlace(*start), MapPlace(goal.x, goal.y, goal.yaw or 0.0))
    result, there = it.walker.result, it.truth
    return Told(
        seed,
        goal,
        "never" if result is None else result.outcome,
        "" if result is None else result.reason,
        math.dist(there[:2], (goal.x, goal.y)),
        0.0 if goal.yaw is None else abs(math.remainder(there.yaw - goal.yaw, math.tau)),
        it.stage.now - began,
        plant.path_length - path,
        way.length if isinstance(way, Route) else math.nan,
        tuple(touches),
        fastest,
        tuple(waits),
    )

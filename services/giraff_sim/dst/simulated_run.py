"""One run from one seed: a room, people, faults, and the judge's verdict."""

import hashlib
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from random import Random
from typing import Any, Final, NamedTuple

import msgspec

from giraff_node.config.robot_file import load
from giraff_sim.board import BUILD, ROOT, Implementation
from giraff_sim.bodies.registry import with_known, world_of
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.config import SimConfig
from giraff_sim.dst.judging.judge import Judge, Violation
from giraff_sim.dst.judging.stops import Stop
from giraff_sim.dst.network import FaultyNetwork, Link
from giraff_sim.dst.people import Button, EStopOperator
from giraff_sim.hosts.cable import Cable
from giraff_sim.hosts.event_queue import EventLog, EventQueue
from giraff_sim.hosts.process import Process
from giraff_sim.settings import Services, Settings
from giraff_sim.simulation import Simulation, simulation
from giraff_sim.truth import EXACT, Truth
from giraff_sim.world.bno055 import Vector
from giraff_sim.world.body import BoundedMotion
from giraff_sim.world.hand import Hand
from giraff_sim.world.room import Room

SECONDS: Final = 20.0

_STEP_US: Final = 4000  # a serial adapter waits longer, and twice as many steps take a third more time
_HOUR_NS: Final = 3_600_000_000_000
_WRITES_US: Final = (2_000, 120_000)  # file, folder and their fsync, from a solid state disk to a slow flash card
_RELEASE_US: Final = 500_000
_DRIVES: Final = 0.2  # m of path that count as driving

SIM: Final = SimConfig()
_STOCK: Final = {"GIRAFF_CONFIG": str(ROOT / "deploy" / "robot.toml")}


class Outcome(msgspec.Struct, frozen=True, kw_only=True):
    """What a run has come to."""

    seed: int
    motion_digest: str
    """SHA-256 of all bytes between base and its board, with their times, and of the pose at the end."""
    violations: tuple[Violation, ...]
    events: tuple[str, ...]
    counts: dict[str, int]
    path: float
    """m."""
    near: float
    """m of it with something less than half a metre from the body."""
    contacts: int

    @property
    def drove(self) -> bool:
        return self.path >= _DRIVES

    @property
    def event_digest(self) -> str:
        """SHA-256 of the event log. Another wording changes it, and leaves `motion_digest` as it was."""
        return hashlib.sha256("\n".join(self.events).encode()).hexdigest()


def known_settings(environment: Mapping[str, str] = _STOCK) -> Settings:
    """The simulated robot of the robot file that `environment` names."""
    given = with_known(environment)
    tables = Settings.__struct_fields__
    types = {field.name: field.type for field in msgspec.structs.fields(Settings)}
    return Settings(**{name: load(name, types[name], given) for name in tables})


Course = Generator[str, None, None]
"""Begins a fault, yields what to tell, and ends the fault when it is called on. One that finds what it would spoil
spoilt already returns before it yields: it does not happen."""
Begin = Callable[["SimulatedRun", Random], Course]


class Kind(NamedTuple):
    """A kind of fault."""

    name: str
    begin: Begin
    weight: float
    """How often it is drawn, beside the others."""
    lasts: tuple[float, float]
    """s, from and to."""
    calm_after: float
    """s after its end until everything can be proven again."""


def fault(
    kinds: list[Kind], weight: float, lasts: tuple[float, float], calm_after: float = 3.0
) -> Callable[[Begin], Begin]:
    """Add a function to the `kinds` that are drawn from; its name is the fault's."""

    def add(begin: Begin) -> Begin:
        name = getattr(begin, "__name__", "").replace("_", " ")
        kinds.append(Kind(name, begin, weight, lasts, calm_after))
        return begin

    return add


class ScheduledFault(NamedTuple):
    """A fault that is to come."""

    kind: Kind
    at: float
    """s."""
    chance: Random


class Scenario(NamedTuple):
    """All that is given of a run."""

    seed: int
    room: Room
    hand: Hand
    seconds: float
    faults: tuple[ScheduledFault, ...]
    truth: Truth = EXACT
    presses: tuple[tuple[float, float], ...] = ()
    """When the joystick's button is pressed and let go, s."""


class SimulatedRun:
    """The robot, its people and its faults, while they run."""

    def __init__(self, running: Simulation, settings: Settings, services: Services, scenario: Scenario) -> None:
        chance = Random(f"{scenario.seed}/drill")
        agenda = EventQueue()
        self.seconds = scenario.seconds
        self.event_log = EventLog(agenda)
        self.network = FaultyNetwork(agenda, chance)
        self.judge = Judge(agenda, running, settings, self.event_log)
        self.loop = ClosedLoop(running, settings, services, self.network, self.judge, agenda)
        self.loop.hosts["robot"].disk.write_us = Random(f"{scenario.seed}/disk").randint(*_WRITES_US)
        self.loop.kill("odometry")  # not in the chain that drives
        for host in self.loop.hosts.values():
            host.wall_ahead_ns = chance.randint(-_HOUR_NS, _HOUR_NS)
        self.loop.launch("button", self._press_button, self.loop.hosts["operator"])
        self.loop.launch("caretaker", self._work_estop, self.loop.hosts["operator"])
        self._names = 0
        self._claims: list[Any] = []  # of the fault that begins
        self._claimed: list[Any] = []
        for fault in scenario.faults:
            self._plan(*fault)
        for begin, end in scenario.presses:
            agenda.at(round(begin * 1e6), self._press_joystick)
            agenda.at(round(end * 1e6), self._let_joystick_go)

    def link(self, sender: str, taker: str) -> Link:
        """The way from one machine to the other."""
        return self.network.link(self.loop.hosts[sender], self.loop.hosts[taker])

    def cable(self, service: str) -> Cable:
        """The cable between a service and its board."""
        return self.loop.cables[getattr(self.loop.settings, service).port]

    def fresh_name(self, what: str) -> str:
        self._names += 1
        return f"{what} {self._names}"

    def drives(self, host: str) -> bool:
        """Whether the robot obeys an operator on this machine."""
        holder = self.judge.holder
        return any(process.instance == holder and process.host.name == host for process in self.loop.processes.values())

    def driven_by(self, service: str) -> Callable[[], bool]:
        """Whether the robot depends on this service now: on a joystick only while it obeys that one."""
        if service != "joystick":
            return lambda: True
        process = self.loop.processes.get(service)
        instance = process.instance if process is not None else "joystick"
        return lambda: self.judge.holder == instance

    def claims(self, *things: Any) -> bool:
        """Whether a fault may have these to itself until it ends: two that spoil one thing would mend each other."""
        if any(thing in self._claimed for thing in things):
            return False
        self._claims += things
        return True

    @contextmanager
    def stops(
        self, what: str, bound_us: int, way: BoundedMotion = "any", applies: Callable[[], bool] = lambda: True
    ) -> Iterator[None]:
        """Hold the robot to standing still within `bound_us`, as long as the fault lasts."""
        self.judge.stops.begin(Stop(what, self.loop.agenda.now_us, bound_us, way, applies))
        yield
        self.judge.stops.end(what, self.loop.agenda.now_us)

    def release_later(self, after_us: int = _RELEASE_US) -> None:
        """Have the emergency stop reset, should it be engaged."""
        self.loop.agenda.at(self.loop.agenda.now_us + after_us, self.button.reset)

    def run(self, until_rules: str = "") -> None:
        """Run to the end, or until the judge has found a violation of each of `until_rules`."""
        end_us = round(self.seconds * 1e6)
        loop, judge, world = self.loop, self.judge, self.loop.simulation.world
        disk = loop.hosts["robot"].disk
        felt: Vector | None = None
        while loop.agenda.now_us < end_us and not judge.has_found(until_rules):
            loop.step()
            if world.acceleration is not felt and (joystick := loop.processes.get("joystick")) is not None:
                felt = world.acceleration
                if world.button:
                    judge.clutched(joystick)
                else:
                    judge.held(joystick, felt)
            judge.after_step(disk)

    def _press_joystick(self) -> None:
        simulation = self.loop.simulation
        simulation.world.button = True
        drives = " while the robot drives" if simulation.world.body.activity else ""
        self.event_log.log(f"the joystick's button is pressed{drives}")
        self.event_log.count(f"the joystick's button is pressed{drives}")

    def _let_joystick_go(self) -> None:
        self.loop.simulation.world.button = False
        self.event_log.log("the joystick's button is let go")

    def _press_button(self, process: Process) -> Button:
        self.button = Button(process, self.judge)
        return self.button

    def _work_estop(self, process: Process) -> EStopOperator:
        self.estop_operator = EStopOperator(process)
        return self.estop_operator

    def _plan(self, kind: Kind, at: float, chance: Random) -> None:
        """Let a fault happen at that moment."""
        at_us = round(at * 1e6)
        lasts_us = round(chance.uniform(*kind.lasts) * 1e6)
        course = kind.begin(self, chance)
        clearance = self.judge.clearance_check

        def begin() -> None:
            claims: list[Any] = []
            self._claims = claims
            told = next(course, "")
            if not told:
                return
            self._claimed += claims
            clearance.disturb()
            self.event_log.count(f"fault: {kind.name}")
            self.event_log.log(f"{told}, for {lasts_us / 1e6:.2f} s" if lasts_us else told)
            self.loop.agenda.at(at_us + lasts_us, partial(end, claims))

        def end(claims: list[Any]) -> None:
            next(course, None)
            for claim in claims:
                self._claimed.remove(claim)
            self.event_log.log(f"{kind.name} is over")
            clearance.calm(self.loop.agenda.now_us + round(kind.calm_after * 1e6))

        self.loop.agenda.at(at_us, begin)


def play(
    scenario: Scenario,
    settings: Settings,
    services: Services | None = None,
    build: Path = BUILD,
    until_rules: str = "",
    sim: SimConfig = SIM,
) -> Outcome:
    """Run a scenario to its end, or until each of `until_rules` is violated. `build`: where the boards are compiled."""
    robot, drive = settings.robot, settings.base.drive
    world = world_of(scenario.room, robot, drive, sim, scenario.hand, scenario.seed, _STEP_US, scenario.truth)
    ranger = settings.ranger.board_type
    with simulation(world, implementation=Implementation.HOST, build=build, ranger=ranger) as running:
        run = SimulatedRun(running, settings, services or Services(), scenario)
        run.run(until_rules)
        plant = world.plant
        return Outcome(
            seed=scenario.seed,
            motion_digest=hashlib.sha256(run.cable("base").digest() + repr(plant.pose).encode()).hexdigest(),
            violations=tuple(run.judge.violations),
            events=tuple(run.event_log.lines),
            counts=dict(run.event_log.counts),
            path=plant.path_length,
            near=run.judge.near,
            contacts=plant.contacts,
        )

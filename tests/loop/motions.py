"""A motion around the robot in simulated time: who has asked for it, on the operator's machine, and its link."""

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from random import Random
from typing import Any, Final

from giraff_core.retry import RetriedRequest
from giraff_core.timer import Timer
from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.service import Keyboard
from giraff_schemas.messages import RobotTime
from giraff_schemas.motion import (
    MotionAnswer,
    MotionArc,
    MotionCancel,
    MotionGo,
    MotionHold,
    MotionMove,
    MotionRequest,
    MotionState,
    MotionTurn,
)
from giraff_schemas.requests import EStopEngage, EStopReset
from giraff_schemas.topics import (
    ESTOP_ENGAGE,
    ESTOP_RESET,
    MOTION,
    MOTION_ARC,
    MOTION_CANCEL,
    MOTION_GO,
    MOTION_HOLD,
    MOTION_MOVE,
    MOTION_TURN,
    TICK,
    Query,
)
from giraff_schemas.trouble import Trouble
from giraff_sim.board import Implementation
from giraff_sim.bodies.registry import world_of
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.dst.network import FaultyNetwork, Link
from giraff_sim.hosts.event_queue import EventQueue
from giraff_sim.hosts.process import Process
from giraff_sim.settings import Services, Settings
from giraff_sim.simulation import simulation
from giraff_sim.truth import Truth
from giraff_sim.world.hand import StillHand
from giraff_sim.world.room import Room
from tests.loop.loops import COARSE_STEP_US, SETTINGS, SeenRobot
from tests.loop.people import REPEAT, Desk, Stopper
from tests.sim.robots import EXACT, proving_room
from tests.support.robots import ROBOT

AHEAD: Final[dict[str, Any]] = {"distance": 2.0}
"""A `MotionMove` that goes on for longer than anything here is looked at."""
_QUERIES: Final[dict[type[MotionRequest], Query[Any, MotionAnswer]]] = {
    MotionMove: MOTION_MOVE,
    MotionTurn: MOTION_TURN,
    MotionArc: MOTION_ARC,
    MotionGo: MOTION_GO,
}
_PROVES: Final = 0.7
"""s after which each sensor was heard, and base and guard have told of themselves. Half a second later, when a motion
that is asked for then has armed the robot, the guard trusts all of them."""
_LOOKS: Final = 0.02
"""s"""


class Requester:
    """A script with `giraff_client` in part: it asks, and holds for as long as it runs, whatever becomes of it."""

    link = None

    def __init__(self, process: Process) -> None:
        self.answer: MotionAnswer | None = None
        """To the last request; None: there is none yet."""
        self.id = 0
        """That it holds; 0: none."""
        self.tick: RobotTime | None = None
        self.instance = process.instance
        self._process = process
        self._ticks = process.inbox(TICK, limit=1, wakes=False)
        self._holds = process.publisher(MOTION_HOLD)
        self._asking: RetriedRequest[Any] | None = None
        self.timers = (Timer(MOTION_HOLD.rate_hz),)

    def ask(self, query: Query[Any, MotionAnswer], request: Any) -> None:
        """Until it is answered."""
        self.answer = None
        self.id = getattr(request, "id", 0)
        self._asking = self._process.ask(query, request, lambda _: True)
        self._process.wake()

    def turn(self, now: float) -> None:
        for tick in self._ticks.pop_all():
            self.tick = tick.time
        if self._asking is not None and (answer := self._asking.poll(now)) is not None:
            self.answer, self._asking = answer, None
        if self.timers[0].due(now) and self.id and self.tick is not None:
            self._holds.put(MotionHold(id=self.id, tick=self.tick))

    def end(self) -> None:
        """Nothing is left to say."""


class Stage(SeenRobot):
    """A robot whose sensors have all been heard, at rest, with nobody driving it."""

    def __init__(self, loop: ClosedLoop, network: FaultyNetwork) -> None:
        super().__init__(loop)
        self.network = network
        self._desk = Desk()
        self._ids = count(1)
        self.start_requester()

    @property
    def state(self) -> MotionState:
        """As giraff_motion has said last."""
        state: MotionState = self.loop.newest[MOTION.key]
        return state

    @property
    def links(self) -> tuple[Link, Link]:
        """Between the operator's machine and the robot's, both ways."""
        operator, robot = self.loop.hosts["operator"], self.loop.hosts["robot"]
        return self.network.link(operator, robot), self.network.link(robot, operator)

    def start_requester(self) -> None:
        """Another one takes its place."""
        self.loop.launch("requester", self._make_requester, self.loop.hosts["operator"])

    def start_keyboard(self) -> None:
        """A keyboard that merely runs, on the operator's machine."""
        self.loop.launch("keyboard", self._make_keyboard, self.loop.hosts["operator"])

    def start_stopper(self) -> None:
        self.loop.launch("stopper", self._make_stopper, self.loop.hosts["operator"])

    def ask(self, kind: type[MotionRequest], **fields: Any) -> MotionRequest:
        """Ask for a motion, and wait for the answer."""
        self.run(0.1)  # a requester that has just started has heard no tick
        assert self.requester.tick is not None
        own, tick = self.requester.instance, self.requester.tick
        request = kind(by="a script", id=next(self._ids), instance=own, tick=tick, **fields)
        self.requester.ask(_QUERIES[kind], request)
        self._until(lambda: self.requester.answer is not None, 1.0)
        return request

    def begin(self, kind: type[MotionRequest], **fields: Any) -> MotionRequest:
        """Ask for a motion, and wait until it is under way."""
        request = self.ask(kind, **fields)
        assert self.requester.answer == MotionAnswer(accepted=True)
        asked = self.now
        self._until(lambda: self.driven_ms(asked) > 0, 3.0)
        return request

    def until_ended(self, within: float) -> None:
        """The motion, in whatever way."""
        self._until(lambda: self.state.stage == "ended", within)

    def cancel(self) -> None:
        """The requester asks for it, and holds on."""
        held = self.requester.id
        self.requester.ask(MOTION_CANCEL, MotionCancel(by="a script", id=held))
        self.requester.id = held

    def replay(self, *keys: str) -> None:
        """Carry all that was said on these keys again, in the order in which it was."""
        self.network.replay([said for said in self.network.history if said.message.key in keys], 1_000_000)

    def type(self, key: bytes, seconds: float) -> None:
        """Hold a key of the keyboard down."""
        until = self.now + seconds
        while self.now < until:
            self._desk.typed += key
            self.loop.processes["keyboard"].wake()
            self.run(REPEAT)

    def engage(self) -> None:
        self.stopper.ask(ESTOP_ENGAGE, EStopEngage(by="test", reason=Trouble("a cat")))

    def reset(self) -> None:
        newest = self.loop.newest
        self.stopper.ask(ESTOP_RESET, EStopReset(by="test", id=newest["estop"].id, tick=newest["tick"].time))

    def driven_ms(self, since: float, until: float | None = None) -> int:
        """For how long a motor had any duty between two moments, s."""
        record = self.loop.simulation.record
        return record.window(round(since * 1e6), round((self.now if until is None else until) * 1e6)).driven_ms

    def last_driven(self, since: float) -> float:
        """s from then to the end of the last millisecond with any duty."""
        last_us = self.loop.simulation.record.window(round(since * 1e6), round(self.now * 1e6)).last_driven_us
        return 0.0 if last_us is None else last_us * 1e-6 - since

    def _until(self, holds: Any, within: float) -> None:
        since = self.now
        while not holds():
            assert self.now - since < within, f"{self.requester.answer}, {self.loop.newest.get(MOTION.key)}"
            self.run(_LOOKS)

    def _make_requester(self, process: Process) -> Requester:
        self.requester = Requester(process)
        return self.requester

    def _make_keyboard(self, process: Process) -> Keyboard:
        return Keyboard(process, KeyboardConfig(), ROBOT, self._desk)

    def _make_stopper(self, process: Process) -> Stopper:
        self.stopper = Stopper(process)
        return self.stopper


@contextmanager
def stage(
    room: Room | None = None,
    services: Services | None = None,
    seed: int = 1,
    settings: Settings = SETTINGS,
    truth: Truth | None = None,
    step_us: int = COARSE_STEP_US,
) -> Iterator[Stage]:
    """`seed`: also of the link between the two machines, which takes up to 20 ms."""
    world = world_of(
        room or proving_room(),
        settings.robot,
        settings.base.drive,
        EXACT,
        StillHand(),
        seed,
        step_us,
        truth=truth or Truth(),
    )
    agenda = EventQueue()
    network = FaultyNetwork(agenda, Random(seed))
    with simulation(world, implementation=Implementation.HOST) as running:
        loop = ClosedLoop(running, settings, services, network, agenda=agenda)
        loop.kill("joystick")  # which would ask for the robot
        loop.start("motion")
        made = Stage(loop, network)
        made.run(_PROVES)
        yield made

"""The demonstration and those it gives way to, around the robot in simulated time."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Final, TypeVar

import msgspec

from giraff_cli.run.demonstration import Demonstration, JoystickHold
from giraff_core.io import Inbox, Service
from giraff_core.timer import Timer
from giraff_joystick.config import JoystickConfig
from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.service import Keyboard
from giraff_schemas.requests import EStopEngage, EStopReset
from giraff_schemas.services import DEMONSTRATION
from giraff_schemas.topics import ESTOP, ESTOP_ENGAGE, ESTOP_RESET, LEASE, OPERATOR_CMD_VEL
from giraff_schemas.trouble import Trouble
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.hosts.process import Process
from giraff_sim.settings import Settings
from giraff_sim.world.demo_hand import DemoHand
from giraff_sim.world.hand import StillHand
from tests.loop.loops import SeenRobot, closed_loop, spare_time
from tests.loop.people import REPEAT, Desk, Stopper
from tests.sim.robots import proving_room
from tests.support.robots import BASE, ROBOT

ServiceT = TypeVar("ServiceT", bound=Service)

LOOK: Final = 0.2
"""s between two looks of `giraff run`."""
SETTINGS: Final = Settings(robot=ROBOT, base=BASE, joystick=JoystickConfig(port="joystick", operator=DEMONSTRATION))
_WAYPOINTS: Final = [(2.5, 0.0), (0.0, 2.5), (-2.5, 0.0), (0.0, -2.5)]


class RunInPart:
    """What `giraff run` does of the demonstration: it looks now and then, and holds the joystick."""

    link = None

    def __init__(self, process: Process, every: float) -> None:
        self.demonstration = Demonstration()
        self.grips: list[tuple[float, JoystickHold]] = []
        """Each other grip, with the moment (simulated s) since which it is held."""
        self.looks = 0
        self._process = process
        self._heard: list[Inbox[Any]] = [process.inbox(topic) for topic in (OPERATOR_CMD_VEL, LEASE, ESTOP)]
        self.timers = (Timer(1.0 / every),)

    def turn(self, now: float) -> None:
        if not self.timers[0].due(now):
            return
        self.looks += 1
        for inbox in self._heard:
            for sample in inbox.pop_all():
                self.demonstration.on_sample(sample, now)
        grip = self.demonstration.grip(now)
        if not self.grips or grip != self.grips[-1][1]:
            seconds = self._process.loop.agenda.now_us * 1e-6
            world = self._process.loop.simulation.world
            world.hand = DemoHand(_WAYPOINTS, 1, seconds) if grip.drives else StillHand()
            world.button = grip.presses
            self.grips.append((seconds, grip))

    def end(self) -> None:
        """Nothing is left to say."""


class Scene(SeenRobot):
    """A demonstration that drives, a keyboard that merely runs, and an emergency stop at hand."""

    def __init__(self, loop: ClosedLoop, every: float) -> None:
        super().__init__(loop)
        self._desk = Desk()
        self.run_in_part = self._launch("run", lambda process: RunInPart(process, every))
        self._launch("keyboard", lambda process: Keyboard(process, KeyboardConfig(), ROBOT, self._desk))
        self._stopper = self._launch("stopper", Stopper)

    def _launch(self, name: str, make: Callable[[Process], ServiceT]) -> ServiceT:
        made: list[ServiceT] = []

        def start(process: Process) -> ServiceT:
            made.append(make(process))
            return made[0]

        self.loop.launch(name, start, self.loop.hosts["operator"])
        return made[0]

    @property
    def grip(self) -> JoystickHold:
        return self.run_in_part.grips[-1][1]

    def hold(self, key: bytes, seconds: float) -> None:
        """Hold a key of the keyboard down."""
        until = self.now + seconds
        while self.now < until:
            self.type(key)
            self.loop.run(REPEAT)

    def type(self, key: bytes) -> None:
        """One press of the keyboard."""
        self._desk.typed += key
        self.loop.processes["keyboard"].wake()

    def engage(self) -> None:
        self._stopper.ask(ESTOP_ENGAGE, EStopEngage(by="test", reason=Trouble("a cat")))

    def reset(self) -> None:
        newest = self.loop.newest
        self._stopper.ask(ESTOP_RESET, EStopReset(by="test", id=newest["estop"].id, tick=newest["tick"].time))

    def driven_ms(self, since: float, until: float | None = None) -> int:
        """For how long a motor had any duty between two moments, s."""
        record = self.loop.simulation.record
        return record.window(round(since * 1e6), round((self.now if until is None else until) * 1e6)).driven_ms

    def until_it_drives(self, within: float) -> float:
        """The moment, s, at which a motor gets its first duty."""
        since = self.now
        while not self.driven_ms(since):
            assert self.now - since < within, f"it does not drive: {self.loop.newest['base'].reason}"
            self.run(0.1)
        return self.now


@contextmanager
def scene(every: float = LOOK, idle_release: float = SETTINGS.guard.idle_release) -> Iterator[Scene]:
    """`every`: s between two looks of the run. `idle_release`: of the guard."""
    guard = msgspec.structs.replace(SETTINGS.guard, idle_release=idle_release)
    with closed_loop(proving_room(), msgspec.structs.replace(SETTINGS, guard=guard)) as loop:
        spare_time(loop)
        made = Scene(loop, every)
        made.until_it_drives(6.0)
        made.run(0.4)
        assert (made.driver, made.grip.drives) == (DEMONSTRATION, True)
        yield made

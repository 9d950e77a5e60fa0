"""Pages around the robot in simulated time: `giraff_web` itself, and browsers that do what its page does."""

import math
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from random import Random
from typing import Final, Literal

import msgspec

from giraff_core.timer import Timer
from giraff_schemas.messages import EStop
from giraff_schemas.trouble import Trouble
from giraff_sim.board import Implementation
from giraff_sim.bodies.registry import world_of
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.dst.network import FaultyNetwork, Link
from giraff_sim.hosts.event_queue import EventQueue
from giraff_sim.hosts.process import Process
from giraff_sim.simulation import simulation
from giraff_sim.truth import Truth
from giraff_sim.world.hand import StillHand
from giraff_web.config import WebConfig
from giraff_web.messages import (
    FromPage,
    Go,
    Hello,
    Input,
    LetGo,
    PageWish,
    Plan,
    Reading,
    Refused,
    Reset,
    RouteHold,
    State,
    ToPage,
)
from giraff_web.pages import Closed, Event, ForOnePage, Opened, Said, StopAsked
from giraff_web.service import Web
from tests.loop.loops import COARSE_STEP_US, GRAVITY, SETTINGS, SeenRobot
from tests.sim.robots import EXACT, proving_room
from tests.support.robots import ROBOT

FRAME: Final = 1.0 / 60.0
"""s between two animation frames, and between two readings of a phone."""
_PROVES: Final = 0.5
"""s after which each sensor was heard, and base and guard have told of themselves."""
_IDLE: Final = 0.1
"""s at least between two wishes that hold nothing of a page that does not drive."""
_ROUND_TRIP: Final = 0.02
"""s that a state takes to a page, and a wish back, together."""
_decoder: Final = msgspec.json.Decoder(FromPage)
_shown: Final = msgspec.json.Decoder(ToPage)


class Browser:
    """One page. What it says goes over JSON, as on the wire."""

    def __init__(self, number: int, device: str, *, may_drive: bool) -> None:
        self.number, self.device, self.may_drive = number, device, may_drive
        self.state: State | None = None
        self.hello: Hello | None = None
        self.refusals: list[Trouble] = []
        self.input: Input = "pad"
        self.hold = 0
        """Of the finger; 0: it is lifted."""
        self.asks = (0.0, 0.0)
        """Forward and left, each a share."""
        self.tilted = (0.0, 0.0)
        """Degrees that the phone dips forward and left."""
        self.hung = self.is_going = False
        self.plans: list[Plan] = []
        self.said: list[Said] = []
        """All of it, in its order."""
        self._holds = 0
        self._n = 0
        self._events: deque[Event] = deque()
        self._frames = 0
        self._wished: State | None = None
        self._wished_at = 0.0
        self._states: deque[tuple[float, State]] = deque()

    def touch(self) -> None:
        """Put a finger down, or press a key. The first wish of it is neutral."""
        self._holds += 1
        self.hold = self._holds
        self.asks = (0.0, 0.0)

    def let_go(self, why: Literal["finger", "hidden", "left"] = "finger") -> None:
        self.hold = 0
        self._n += 1
        self.say(LetGo(n=self._n, why=why))

    def say(self, message: PageWish | LetGo | Reset | Go | RouteHold) -> None:
        decoded = _decoder.decode(msgspec.json.encode(message))
        assert isinstance(decoded, PageWish | LetGo | Reset | Go | RouteHold)
        self.said.append(Said(self.number, decoded))
        self._events.append(self.said[-1])

    def go(self, place: str) -> None:
        """The second tap, on the question whether to go there. From now on the page holds on to that route."""
        assert self.state is not None
        assert self.state.tick is not None
        self.is_going = True
        self.say(Go(n=1, tick=self.state.tick, goal=place))

    def stop(self) -> None:
        self._events.append(StopAsked(self.device))

    def release(self) -> None:
        """The second tap, on the question that names the stop."""
        assert self.state is not None
        assert self.state.stop is not None
        stop = self.state.stop
        self.say(Reset(id=stop.id, engaged_ns=stop.engaged_ns, tick=self.state.tick))

    def push(self, event: Event) -> None:
        """As if it came from this page."""
        self._events.append(event)

    def frame(self, now: float) -> None:
        """One animation frame of a page that is visible and has the focus."""
        while self._states and self._states[0][0] <= now and not self.hung:
            self.state = self._states.popleft()[1]
            if self.is_going and self.state.tick is not None:
                self.say(RouteHold(tick=self.state.tick))
        if self.hung or self.state is None or self.state.tick is None or not self._is_due(self.state, now):
            return
        self._wished, self._wished_at = self.state, now
        self._n += 1
        self._frames += 1
        forward, left = self.asks if self.hold else (0.0, 0.0)
        self.say(
            PageWish(
                n=self._n,
                tick=self.state.tick,
                hold=self.hold,
                input=self.input,
                forward=forward if self.input != "tilt" else 0.0,
                left=left if self.input != "tilt" else 0.0,
                readings=(self._reading(),) if self.input == "tilt" else (),
            )
        )

    def shown(self, state: State, now: float) -> None:
        """What comes down to it arrives a little later."""
        decoded = _shown.decode(msgspec.json.encode(state))
        assert isinstance(decoded, State)
        self._states.append((now + _ROUND_TRIP, decoded))

    def pop_all(self) -> Iterator[Event]:
        while self._events:
            yield self._events.popleft()

    def _is_due(self, state: State, now: float) -> bool:
        """Whether the page says something in this frame: with each state while it drives and holds nothing."""
        if self.hold or self.input == "tilt":
            return True
        drives = state.page == self.number
        return self._holds > 0 and (state is not self._wished if drives else now - self._wished_at >= _IDLE)

    def _reading(self) -> Reading:
        """As a browser rounds it, from a hand that is never quite still."""
        forward, left = (math.radians(degrees + 0.3 * math.sin(self._frames)) for degrees in self.tilted)
        x, y = GRAVITY * math.sin(left), -GRAVITY * math.sin(forward)
        z = math.sqrt(max(0.0, GRAVITY**2 - x * x - y * y))
        return self._frames * FRAME, round(x, 1), round(y, 1), round(z, 1)


class Browsers:
    """All pages that are open, towards the service: `giraff_web.pages.Pages`."""

    def __init__(self) -> None:
        self.open: dict[int, Browser] = {}
        self._events: deque[Event] = deque()
        self._numbers = 0
        self.now = 0.0
        self.confirmed: list[EStop] = []

    def add(self, device: str = "phone", *, may_drive: bool = True) -> Browser:
        self._numbers += 1
        browser = self.open[self._numbers] = Browser(self._numbers, device, may_drive=may_drive)
        self._events.append(Opened(self._numbers, device, may_drive))
        return browser

    def drop(self, browser: Browser) -> None:
        """Its connection has ended."""
        self._events.extend(browser.pop_all())
        self._events.append(Closed(browser.number))
        del self.open[browser.number]

    def descriptor(self) -> int | None:
        return None

    def poll(self) -> Iterable[Event]:
        events = list(self._events)
        self._events.clear()
        for browser in self.open.values():
            events.extend(browser.pop_all())
        return events

    def show(self, state: State) -> None:
        for browser in self.open.values():
            browser.shown(state, self.now)

    def confirm(self, word: EStop) -> None:
        self.confirmed.append(word)

    def send_picture(self, page: int, data: bytes) -> None:
        raise AssertionError(f"page {page} does not look, and is sent {len(data)} bytes")

    def send(self, page: int, message: ForOnePage) -> None:
        if page not in self.open:
            return
        if isinstance(message, Hello):
            self.open[page].hello = message
        elif isinstance(message, Plan):
            self.open[page].plans.append(message)
        elif isinstance(message, Refused):
            self.open[page].refusals.append(message.why)


class _Frames:
    """What draws the frames of all pages."""

    link = None

    def __init__(self, loop: ClosedLoop, browsers: Browsers) -> None:
        self._loop, self._browsers = loop, browsers
        self.timers = (Timer(1.0 / FRAME),)

    def turn(self, now: float) -> None:
        if not self.timers[0].due(now):
            return
        self._browsers.now = now
        for browser in list(self._browsers.open.values()):
            browser.frame(now)
        if "web" in self._loop.processes:
            self._loop.processes["web"].wake()

    def end(self) -> None:
        """Nothing is left to say."""


class Room(SeenRobot):
    """A robot whose sensors have all been heard, at rest, and nobody but pages to drive it."""

    def __init__(self, loop: ClosedLoop, network: FaultyNetwork) -> None:
        super().__init__(loop)
        self.network = network
        self.browsers = Browsers()
        self.log: list[str] = []
        self.start_web()
        loop.launch("frames", lambda _: _Frames(loop, self.browsers), loop.hosts["operator"])

    def start_web(self) -> None:
        """Anew if it was killed; with the pages that are there."""
        for browser in list(self.browsers.open.values()):
            self.browsers.drop(browser)
        self.browsers.poll()
        self.loop.launch("web", self._make, self.loop.hosts["operator"])

    def _make(self, process: Process) -> Web:
        return Web(process, WebConfig(), ROBOT, self.browsers, self.log.append)

    @property
    def links(self) -> tuple[Link, Link]:
        """Between the web service's machine and the robot's, both ways."""
        operator, robot = self.loop.hosts["operator"], self.loop.hosts["robot"]
        return self.network.link(operator, robot), self.network.link(robot, operator)

    def is_stopped(self) -> bool:
        """By an emergency stop."""
        return bool(self.loop.newest["estop"].engaged)

    def drive(self, browser: Browser) -> None:
        """From the touch until it moves."""
        self.run(0.3)
        browser.touch()
        self.run(0.6)
        assert (self.driver, self.armed) == ("web", True), browser.state and browser.state.why
        self.go(browser)
        self.run(0.4)
        assert self.driven_ms(self.now - 0.1) > 90, browser.state and browser.state.why

    def go(self, browser: Browser) -> None:
        """Ask for motion, ahead."""
        browser.asks = (1.0, 0.0)
        browser.tilted = (25.0, 0.0)

    def driven_ms(self, since: float, until: float | None = None) -> int:
        """For how long a motor had any duty between two moments, s."""
        record = self.loop.simulation.record
        return record.window(round(since * 1e6), round((self.now if until is None else until) * 1e6)).driven_ms

    def last_driven(self, since: float) -> float:
        """s from then to the end of the last millisecond with any duty."""
        last_us = self.loop.simulation.record.window(round(since * 1e6), round(self.now * 1e6)).last_driven_us
        return 0.0 if last_us is None else last_us * 1e-6 - since


@contextmanager
def room(seed: int = 1) -> Iterator[Room]:
    """`seed`: also of the link between the two machines, which takes up to 20 ms."""
    world = world_of(
        proving_room(), SETTINGS.robot, SETTINGS.base.drive, EXACT, StillHand(), seed, COARSE_STEP_US, truth=Truth()
    )
    agenda = EventQueue()
    network = FaultyNetwork(agenda, Random(seed))
    with simulation(world, implementation=Implementation.HOST) as running:
        loop = ClosedLoop(running, SETTINGS, None, network, agenda=agenda)
        loop.kill("joystick")  # which would ask for the robot
        made = Room(loop, network)
        made.run(_PROVES)
        yield made

"""What every operator is: a hand, the robot's clock, who holds the lease, and commands that carry all three.

An operator's device is a `Hand`: it says what is asked now, and what was measured or pressed when. All else is done
here, once: hearing the robot, asking for the lease, publishing, telling why the robot does not obey, the last words.
"""

import math
from abc import ABC, abstractmethod
from typing import Final, NamedTuple, Protocol

from giraff_core.freshness import TickFilter
from giraff_core.io import Inbox, Publisher, Selectable
from giraff_core.lease import LeaseClient, unranked_notice
from giraff_core.timer import EarlyTimer, Timer
from giraff_schemas.messages import BaseState, DriveCommand, GuardState, Lease, RobotTime, Tick
from giraff_schemas.topics import LEASE, OPERATOR_CMD_VEL, TICK, SampleT, Topic
from giraff_schemas.trouble import NO_TROUBLE, Trouble

LINK_SILENCE: Final = 0.5
"""s without a new tick of the robot after which it counts as lost."""
_LINK_LOST: Final = Trouble(
    f"no tick of the robot for {LINK_SILENCE:g} s", "check that base runs and that both machines share a network"
)
_NO_GUARD: Final = Trouble("the guard is not heard", "check that giraff_guard runs on base's machine")
_NO_BASE: Final = Trouble("base is not heard", "check that giraff_base runs")
LEVEL: Final = 0.3
"""s of neutral commands after which base speaks of this lease and no earlier one: 0.2 s of them arm."""
ASKING: Final = (0.0, 0.1)
"""m/s, rad/s. Only a wish for motion takes the lease from a lower priority. What asks for the lease moves nothing."""
ASKS_NOTHING: Final = -1
"""Counter of a command that neither asks for the lease nor is given under one: real ones are never negative."""


class Wish(NamedTuple):
    """What a hand asks. Standing still is a wish, too: it is what arms the robot."""

    linear_x: float
    """m/s."""
    angular_z: float
    """rad/s."""
    tick: RobotTime | None
    """The newest when it was measured or pressed, and no newer one; None: the robot was not heard yet."""
    takes: bool = False
    """Somebody asks to drive now, which also asks for a lease that was lost."""


class Fault(NamedTuple):
    """The operator's side has lost the hand: the robot stops, and need not wait for silence."""

    trouble: Trouble
    tick: RobotTime | None
    is_told: bool = False
    """The service tells it as a fault of its own already."""


class RobotLink:
    """The robot's clock as it is heard elsewhere. Times are seconds of any one monotonic clock."""

    def __init__(self) -> None:
        self._clock = TickFilter()
        self.heard = -math.inf
        """When the newest tick came."""
        self.tick: RobotTime | None = None
        """The newest that was heard."""

    def on_tick(self, tick: Tick, now: float) -> None:
        """Take the robot's clock as it arrives."""
        if self._clock.is_newer(tick, now):
            self.tick, self.heard = tick.time, now

    def link_fault(self, now: float) -> Trouble:
        """Why the robot counts as lost; NO_TROUBLE: it is heard."""
        return _LINK_LOST if now - self.heard > LINK_SILENCE else NO_TROUBLE


class Operator(RobotLink):
    """One operator's process."""

    def __init__(self, name: str, instance: str, *, asks_from_start: bool = True) -> None:
        """`name`: as in `cmd_vel/<name>`; `asks_from_start`: for the lease, not only once a human wishes to drive."""
        super().__init__()
        self.name = name
        self.has_asked = asks_from_start
        """For the lease, at any time."""
        self._asks_from_start = asks_from_start
        self._lease = LeaseClient(instance)
        self.holder = ""
        """Name of the operator that holds the lease; empty: none."""
        self.lost_parameters = NO_TROUBLE
        """A saved limit of its service that may be lost. It asks for nothing then."""

    def fault(self, now: float) -> Trouble:
        """Return why this operator must not ask for motion. NO_TROUBLE: it may."""
        return self.lost_parameters or self.link_fault(now)

    @property
    def holds(self) -> bool:
        """Whether this process holds the lease."""
        return self._lease.holds

    @property
    def refusal(self) -> Trouble:
        """Why the robot does not obey this process, and who drives; NO_TROUBLE when it holds the lease."""
        return self._lease.refusal

    @property
    def rank_notice(self) -> Trouble:
        """Why persons take the robot from this operator, with the line to write; NO_TROUBLE where its name is
        ranked."""
        return unranked_notice(self.name) if self.name in self._lease.unranked else NO_TROUBLE

    def on_lease(self, lease: Lease) -> None:
        """Take what the guard says of who drives."""
        self._lease.on_lease(lease)
        self.holder = lease.operator

    def give_up(self) -> None:
        """Drive under this lease no more: another hand takes over here, and the robot must be armed anew by it."""
        self._lease.give_up()

    def say(self, asked: Wish | Fault) -> DriveCommand:
        """The command that says so, under the lease as it is known now."""
        if isinstance(asked, Fault):
            trouble, tick, _ = asked
            return DriveCommand(
                operator=self.name,
                lease_counter=self._counter(takes=False),
                linear_x=0.0,
                angular_z=0.0,
                source="fault",
                reason=trouble,
                tick=tick,
            )
        return DriveCommand(
            operator=self.name,
            lease_counter=self._counter(takes=asked.takes),
            linear_x=asked.linear_x,
            angular_z=asked.angular_z,
            source="hand",
            tick=asked.tick,
        )

    def last_words(self, tick: RobotTime | None) -> DriveCommand:
        """The command of a program that ends. `tick`: of what it has said last."""
        return self.say(Fault(Trouble(f"the {self.name} service has ended", "start it again"), tick))

    def _counter(self, *, takes: bool) -> int:
        if not (self._asks_from_start or takes or self.holds):
            return ASKS_NOTHING
        self.has_asked = True
        return self._lease.counter(wishes=takes)


class Hand(ABC):
    """An operator's device, or what stands for one."""

    link: Selectable | None = None
    """What its device is read from: bytes there wake the service. None: its pace is enough."""

    def __init__(self, operator: Operator) -> None:
        self.operator = operator
        """Its process: the newest tick, and who drives."""

    def read(self, now: float) -> bool:
        """Take what the device has said since the last call; whether a command is due at once for it. Never waits."""
        del now
        return False

    @abstractmethod
    def poll(self, now: float) -> Wish | Fault | None:
        """What it asks at `now`, s of any one monotonic clock; None: it has nothing to say.

        It is asked whenever a command is due, and by the screen of a person's device: there, asking changes nothing.
        """

    def trouble(self, now: float) -> Trouble:
        """Why the robot does not obey this hand, as far as its own side can tell; NO_TROUBLE: nothing is known."""
        asked = self.poll(now)
        return asked.trouble if isinstance(asked, Fault) else self.operator.refusal


class OperatorIO(Protocol):
    """What an operator needs of its `IO`."""

    lost_parameters: Trouble

    def inbox(self, topic: Topic[SampleT], limit: int = 200, *, wakes: bool = True) -> Inbox[SampleT]: ...
    def publisher(self, topic: Topic[SampleT]) -> Publisher[SampleT]: ...
    def set_notice(self, name: str, trouble: Trouble) -> None: ...


class OperatorService:
    """Runs a hand: a command for each of its readings, and at the pace of operators while there are none."""

    link: Selectable | None = None

    def __init__(self, io: OperatorIO, hand: Hand, *, wakes: bool = True) -> None:
        """`wakes`: what is heard of the robot makes a turn due."""
        self._health = io
        self._hand, self._operator = hand, hand.operator
        self.link = hand.link
        self._ticks, self._leases = io.inbox(TICK, limit=1, wakes=wakes), io.inbox(LEASE, limit=10, wakes=wakes)
        self._commands = io.publisher(OPERATOR_CMD_VEL.at(hand.operator.name))
        self.timer = EarlyTimer(OPERATOR_CMD_VEL.rate_hz)
        self.timers: tuple[Timer, ...] = (self.timer,)
        self._last: RobotTime | None = None
        self._speaks = False
        self._operator.lost_parameters = io.lost_parameters

    def turn(self, now: float) -> None:
        if self._hand.read(now):  # before the ticks: what was pressed is of one that was heard before
            self.timer.fire_now("hand", now)
        self.read_inboxes(now)
        self.say(now)

    def read_inboxes(self, now: float) -> None:
        """The robot's clock, and who drives."""
        for tick in self._ticks.pop_all():
            self.on_tick(tick, now)
        for lease in self._leases.pop_all():
            self.on_lease(lease, now)

    def on_tick(self, tick: Tick, now: float) -> None:
        """Take the robot's clock."""
        self._operator.on_tick(tick, now)

    def on_lease(self, lease: Lease, now: float) -> None:
        """Take what the guard says of who drives."""
        del now
        self._operator.on_lease(lease)

    def say(self, now: float) -> None:
        """What the hand asks, when it is time."""
        if not self.timer.due(now):
            return
        asked = self._hand.poll(now)
        self._speaks = asked is not None
        if asked is None:
            return
        if lost := self._operator.lost_parameters:  # whatever a hand makes of it
            asked = Fault(lost, asked.tick)
        self._last = asked.tick
        self._commands.put(self._operator.say(asked))
        self.on_said(asked, now)

    def on_said(self, asked: Wish | Fault, now: float) -> None:
        """A command was given: tell by the service's health why the robot may not obey it."""
        del now
        operator = self._operator
        self._health.set_notice("hand", asked.trouble if isinstance(asked, Fault) and not asked.is_told else NO_TROUBLE)
        self._health.set_notice("lease", operator.refusal if operator.has_asked else NO_TROUBLE)
        self._health.set_notice("rank", operator.rank_notice)

    def end(self) -> None:
        """Let go of the robot."""
        if self._speaks:
            self._commands.put(self._operator.last_words(self._last))


def what_stops(own: Trouble, base: BaseState | None, guard: GuardState | None) -> Trouble:
    """The first link of the chain that stops the robot; NO_TROUBLE: none does.

    `own`: what the operator itself says. None: that one is not heard.
    """
    if own:
        return own
    if guard is None:
        return _NO_GUARD
    if base is None:
        return _NO_BASE
    return guard.reason or base.reason

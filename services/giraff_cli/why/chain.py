"""What the links of the chain are judged by: who is in charge, what he asks for, and who is there at all.

No clock, no network: both come in.
"""

import math
from typing import Any, Final, Literal

import msgspec

from giraff_core.latest import Latest, LatestSamples
from giraff_schemas.actions import ANY, BY_OPERATOR, ActionWords
from giraff_schemas.health import Health
from giraff_schemas.messages import DirectionLimit, DriveCommand, Lease, RobotTime, Tilt
from giraff_schemas.topics import BASE, ESTOP, GUARD, LEASE, OPERATOR_CMD_VEL, TICK, TILT, SampleT, Topic
from giraff_schemas.trouble import Trouble

LinkStatus = Literal["ok", "limits", "idle", "waits", "STOPS", "missing"]
"""`limits`: the robot drives, but slowly or not everywhere. `idle`: nobody asks to drive. `waits`: another link is to
blame."""
_LEAST: Final = 0.5  # s of silence that a busy machine or a short dropout does not explain
_PERIODS: Final = 3.0


class Link(msgspec.Struct, frozen=True, kw_only=True):
    """One link of the chain from hand to wheel."""

    name: str
    status: LinkStatus
    text: str
    """What is so, with the way out where something is wrong."""
    age: float | None = None
    """s since the sample that tells it was heard."""

    @property
    def breaks(self) -> bool:
        return self.status in ("STOPS", "missing")


class Observation(LatestSamples):
    """What was heard of one robot for a moment: samples, liveliness tokens, answers. Times are any one clock's ns."""

    def __init__(self, robot: str, host: str = "", version: str = "") -> None:
        """`host`, `version`: of the command that listens."""
        super().__init__()
        self.robot, self.host, self.version = robot, host, version
        self.health: list[Health] = []
        self.hung: frozenset[str] = frozenset()
        """Services that were asked by their own name and did not answer in time."""
        self.now_ns = 0
        """The end of the listening."""

    @property
    def empty(self) -> bool:
        """Whether there was nothing to hear."""
        return not self._heard and not self.alive

    def of(self, topic: Topic[SampleT]) -> list[Latest[SampleT]]:
        """The newest sample of each key and maker that speaks of now, newest first."""
        longest = max(_LEAST, _PERIODS / topic.rate_hz if topic.rate_hz else math.inf)
        return [heard for heard in self.all(topic, self.now_ns) if heard.age <= longest]

    def newest(self, topic: Topic[SampleT]) -> Latest[SampleT] | None:
        """The newest sample of a topic that speaks of now."""
        return next(iter(self.of(topic)), None)

    def age(self, heard: Latest[Any], moment: RobotTime | None) -> float:
        """s from `moment`, which `heard` carries, to when it was heard, by the robot's clock; inf: nothing tells."""
        tick = self.newest(TICK)
        if moment is None or tick is None or moment.epoch != tick.sample.epoch:
            return math.inf
        then_ns = tick.sample.robot_ns + (tick.age - heard.age) * 1e9
        return max(0.0, (then_ns - moment.robot_ns) * 1e-9)

    @property
    def unanswered(self) -> frozenset[str]:
        """Services that are on the network and have not answered."""
        return self.alive - {health.service for health in self.health}

    def versions(self, service: str) -> tuple[str, ...]:
        """Return the versions of a service's processes; nothing without an answer."""
        return tuple(health.version for health in self.health if health.service == service)

    def faults(self, service: str) -> tuple[Trouble, ...]:
        """Return what the processes of a service say is wrong, with them or elsewhere; nothing without an answer."""
        told = [health for health in self.health if health.service == service]
        return tuple(fault for health in told for fault in (*health.faults, *health.notices))


class ChainState:
    """The newest of everything, and the links that are judged already."""

    def __init__(self, observation: Observation) -> None:
        self.observation = observation
        self.links: dict[str, Link] = {}
        self._told: dict[Trouble, str] = {}  # by which link
        self.clock = observation.newest(TICK)
        self.base = observation.newest(BASE)
        self.guard = observation.newest(GUARD)
        self.lease = observation.newest(LEASE)
        self.estop = next((heard for heard in observation.of(ESTOP) if heard.sample.engaged), observation.newest(ESTOP))
        self.operator = _in_charge(observation.of(OPERATOR_CMD_VEL), self.lease)
        self.tilt = self._tilt()
        self.words = self._words(observation.of(OPERATOR_CMD_VEL))
        """Words of the hand that drives, or of the only one that is there; of a shell, for the release."""

    @property
    def wants_to_move(self) -> bool:
        return self.operator is not None and not self.operator.sample.neutral

    @property
    def blocked(self) -> list[tuple[str, DirectionLimit]]:
        """The directions that the guard blocks and the hand asks for; of a level hand: both ways along x, or none."""
        if self.guard is None:
            return []
        state = self.guard.sample
        if self.operator is None or self.operator.sample.neutral:
            ways = [("forward", state.forward), ("backward", state.backward)]
            return ways if all(verdict.allowed == 0.0 for _, verdict in ways) else []
        command = self.operator.sample
        if command.linear_x != 0.0:
            asked = ("forward", state.forward) if command.linear_x > 0.0 else ("backward", state.backward)
        else:
            asked = ("turn left", state.turn_left) if command.angular_z > 0.0 else ("turn right", state.turn_right)
        return [asked] if asked[1].allowed == 0.0 else []

    def broken(self, *names: str) -> bool:
        """Whether any of these links, judged already, stops the robot."""
        return any(self.links[name].breaks for name in names)

    def tell(self, link: str, *troubles: Trouble) -> str:
        """Return these troubles in the words of the hand that drives, and remember that `link` tells them."""
        self._told |= dict.fromkeys(set(troubles) - self._told.keys(), link)
        return "; ".join(trouble.line(self.words) for trouble in troubles)

    def tell_once(self, link: str, trouble: Trouble) -> str:
        """Return the same, or where to read it when another link tells it."""
        told = self._told.get(trouble, link)
        return self.tell(link, trouble) if told == link else f"see {told}"

    def is_told(self, trouble: Trouble) -> bool:
        """Return True if a link tells it."""
        return trouble in self._told

    def process(self, service: str, topic: Topic[Any], how: str) -> Link | None:
        """What is wrong with a service as a process; None: exactly one of it runs and speaks."""
        makers = {heard.sample.instance for heard in self.observation.of(topic)}
        if len(makers) > 1:
            return Link(name=service, status="STOPS", text=several(f"giraff_{service}", makers))
        if makers:
            return None
        if service in self.observation.alive:
            return self.silent(service, service)
        return Link(name=service, status="missing", text=f"giraff_{service} is not running, or hangs; {how}")

    def silent(self, link: str, service: str) -> Link:
        """Return the link of a service that is on the network and sends no samples."""
        if service in self.observation.hung:
            why = "is on the network and does not answer; it hangs: restart it"
        elif service in self.observation.unanswered:
            why = "is on the network and has not answered yet; ask again"
        else:
            well = "answers that it is well, and sends nothing; ask again in a few seconds, then restart it"
            if theirs := {each for each in self.observation.versions(service) if each != self.observation.version}:
                well = f"is of version {', '.join(sorted(theirs))}, and this command of {self.observation.version}"
            why = self.tell(link, *self.observation.faults(service)) or well
        return Link(name=link, status="STOPS", text=f"giraff_{service}: {why}")

    def _words(self, commands: list[Latest[DriveCommand]]) -> ActionWords:
        holder = self.lease.sample.holder if self.lease is not None else ""
        names = {heard.sample.operator for heard in commands if not holder or heard.sample.instance == holder}
        name = names.pop() if len(names) == 1 else ""
        return {**BY_OPERATOR.get(name, ANY), "release": ANY["release"]}

    def _tilt(self) -> Latest[Tilt] | None:
        """The hand behind the operator in charge, where it is one that tilts."""
        maker = self.operator.sample.instance if self.operator is not None else ""
        return next((heard for heard in self.observation.of(TILT) if heard.sample.instance == maker), None)


def several(what: str, instances: set[str]) -> str:
    return f"{len(instances)} {what} run under this name ({', '.join(sorted(instances))}); end all but one"


def link_from(name: str, status: LinkStatus, heard: Latest[Any], text: str) -> Link:
    """The link that `heard` tells of."""
    return Link(name=name, status=status, text=text, age=round(heard.age, 3))


def _in_charge(commands: list[Latest[DriveCommand]], lease: Latest[Lease] | None) -> Latest[DriveCommand] | None:
    """The operator whom the lease names; else one who wants to move; else any."""
    holder = lease.sample.holder if lease is not None else ""

    def rank(heard: Latest[DriveCommand]) -> tuple[bool, bool, bool]:
        command = heard.sample
        return command.instance != holder, command.neutral, command.source == "fault"

    return min(commands, key=rank, default=None)

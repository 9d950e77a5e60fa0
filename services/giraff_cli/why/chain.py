"""What the links of the chain are judged by: who is in charge, what he asks for, and who is there at all."""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from giraff_cli.why.observation import Observation
from giraff_core.latest import Latest
from giraff_schemas.actions import ANY, BY_OPERATOR, ActionWords
from giraff_schemas.messages import DirectionLimit, DriveCommand, Lease, Tilt
from giraff_schemas.topics import BASE, ESTOP, GUARD, LEASE, OPERATOR_CMD_VEL, TICK, TILT, Topic
from giraff_schemas.trouble import Trouble

LinkStatus = Literal["ok", "limits", "idle", "waits", "STOPS", "missing"]
"""`limits`: the robot drives, but slowly or not everywhere. `idle`: nobody asks to drive. `waits`: another link is to
blame."""


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

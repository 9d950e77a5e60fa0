"""What `giraff doctor` has looked at: plain facts, from which `findings` concludes."""

from typing import Any, Final, Literal

import msgspec

from giraff_core.kinematics.calibration import Calibration
from giraff_schemas.health import Health
from giraff_schemas.messages import BaseState, EStop
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from giraff_tools.network.interfaces import Interface

Outcome = Literal["answers", "refused", "silent", "no way", "no name", "untrusted"]
"""Of a call to an address. `silent`: nothing came back; `no way`: it cannot be sent there; `no name`: the host's
name is not known here; `untrusted`: the certificates of both ends do not go together."""
_TROUBLE: Final = {*Trouble.__struct_fields__}


class Port(msgspec.Struct, frozen=True, kw_only=True):
    """A board's port of this machine whose service does not run anywhere."""

    service: str
    problem: Trouble
    """NO_TROUBLE: the right board answers."""


class Disk(msgspec.Struct, frozen=True, kw_only=True):
    """A folder that services or commands of this machine write to."""

    folder: str
    free_bytes: int
    total_bytes: int
    problem: Trouble = NO_TROUBLE


class Geometry(msgspec.Struct, frozen=True, kw_only=True):
    """Wheels and track, as the table [robot] has them."""

    track_width: float
    """m"""
    ticks_per_metre: float
    calibration: Calibration


class GeometryInUse(msgspec.Struct, frozen=True, kw_only=True):
    """What one process goes by: it has read its robot file once, when it started."""

    service: str
    host: str
    geometry: Geometry


class Machine(msgspec.Struct, frozen=True, kw_only=True):
    """This one."""

    host: str
    version: str
    interfaces: tuple[Interface, ...] = ()
    ipv6_alone: tuple[str, ...] = ()
    """Names of interfaces that have no IPv4 address."""
    services: tuple[str, ...] = ()
    """Parts of a robot that run on it, and meet each other at its Unix sockets."""
    ports: tuple[Port, ...] = ()
    disks: tuple[Disk, ...] = ()
    settings_problem: Trouble = NO_TROUBLE
    """Of robot file and environment."""
    loopback_problem: Trouble = NO_TROUBLE
    keys_problem: Trouble = NO_TROUBLE
    keys_expired: bool = False
    wiring_problem: Trouble = NO_TROUBLE
    """Why nobody knows yet whether the robot moves as it is asked."""
    unranked_hands: tuple[str, ...] = ()
    """Operator names of its robot file's hands that no priority names: persons take the robot from them."""
    geometry: Geometry | None = None
    """As its robot file has it now; None: it has none, or that of another robot than the one whose base runs here."""


class Probe(msgspec.Struct, frozen=True, kw_only=True):
    """An address, called once."""

    address: str
    outcome: Outcome
    detail: str = ""
    on_link: bool = True
    """It is in one of this machine's networks."""


class Network(msgspec.Struct, frozen=True, kw_only=True):
    """What this machine's session met."""

    has_doors: bool = True
    """Hosts find each other at doors. They do not where all keeps to the loopback, or by a session file."""
    problem: Trouble = NO_TROUBLE
    """Why there is no session."""
    calls: tuple[Probe, ...] = ()
    pages: tuple[Probe, ...] = ()
    """Where browsers reach the page of a web service on another machine."""
    door: str = ""
    """Address of the door that it is linked with; empty: none."""
    is_far: bool = False
    """That door is another machine's."""
    untold: tuple[str, ...] = ()
    """Addresses of this machine that its own door does not announce."""
    has_free_port: bool = True
    """A hand, or whatever else stays, can listen to other machines."""
    scouted: bool = False
    """Others were called by multicast."""
    is_found: bool = False
    """The door has answered to that."""
    protocols: tuple[str, ...] = ()
    """That those speak who have answered."""
    protocol: str = "tcp"
    """That this machine speaks."""
    robots: tuple[str, ...] = ()


class HealthReply(msgspec.Struct, frozen=True, kw_only=True):
    """A service that has told how it is."""

    health: Health
    ahead: float
    """s. Lead of its host's clock over this one's."""
    uncertainty: float = 0.0
    """s"""


class Rate(msgspec.Struct, frozen=True, kw_only=True):
    """How a key flowed."""

    key: str
    maker: str
    """The service that speaks there."""
    wanted_hz: float
    hz: float | None
    """None: it did not, or for too short a time."""
    heard: int = 0
    lost: int = 0


class Robot(msgspec.Struct, frozen=True, kw_only=True):
    """What was heard of one."""

    name: str
    seconds: float
    services: dict[str, int]
    """By service, how many of it are on the network."""
    answers: tuple[HealthReply, ...]
    rates: tuple[Rate, ...]
    unused: tuple[str, ...] = ()
    """Services that it does not need."""
    geometries: tuple[GeometryInUse, ...] = ()
    """Of those that have told it."""
    base: BaseState | None = None
    estop: EStop | None = None


class Inspection(msgspec.Struct, frozen=True, kw_only=True):
    """All of it."""

    machine: Machine
    network: Network
    robot: Robot | None = None
    """None: none was heard."""
    wanted: str = ""
    """The robot that was asked for; empty: whichever is there."""


def as_lines(told: Any) -> Any:
    """The same, each trouble as the line that programs have always read."""
    match told:
        case dict() if told.keys() == _TROUBLE:
            return str(Trouble(**told))
        case dict():
            return {name: as_lines(each) for name, each in told.items()}
        case list() | tuple():
            return [as_lines(each) for each in told]
    return told

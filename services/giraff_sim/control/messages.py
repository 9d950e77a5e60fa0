"""What goes over the control socket: one JSON object a line each way. SI units unless named."""

from typing import Annotated, Literal

import msgspec

from giraff_schemas.wire import Wiring
from giraff_sim.board import RunState
from giraff_sim.bodies.registry import DrawnBody
from giraff_sim.record import MotorWindow
from giraff_sim.truth import Truth
from giraff_sim.world.bno055 import Bno055Fault
from giraff_sim.world.body import Balance
from giraff_sim.world.sonar import SonarFault

BoardName = Literal["base", "joystick", "ranger"]
Wheel = Literal["left", "right"]


class Request(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="op"):
    """Something asked of the simulator."""


class Now(Request, frozen=True, kw_only=True, tag="now"):
    """The simulated time."""


class GetState(Request, frozen=True, kw_only=True, tag="state"):
    """Everything there is to know."""


class GetRoom(Request, frozen=True, kw_only=True, tag="room"):
    """What stands in the room."""


class GetTruth(Request, frozen=True, kw_only=True, tag="truth"):
    """How this robot differs from what its file says."""


class GetRecord(Request, frozen=True, kw_only=True, tag="record"):
    """The verdict on a window of the black box; without ends, on all that is kept."""

    since_us: int = 0
    until_us: int | None = None


class Tilt(Request, frozen=True, kw_only=True, tag="tilt"):
    """Hold the joystick so that its sensor feels this, m/s^2."""

    x: float
    y: float
    z: float


class SetHand(Request, frozen=True, kw_only=True, tag="hand"):
    """Give the joystick to another hand, from now on."""

    hand: str
    """"demo", "still", "laid_down", "shaken", "dropped", or the path of a tilt script."""


class Button(Request, frozen=True, kw_only=True, tag="button"):
    """Press the joystick's button, or let it go."""

    pressed: bool


class Place(Request, frozen=True, kw_only=True, tag="place"):
    """Set the robot down elsewhere, at rest. m, rad."""

    x: float
    y: float
    yaw: float = 0.0


class AddWall(Request, frozen=True, kw_only=True, tag="add_wall"):
    """Put up a wall."""

    name: str
    points: list[tuple[float, float]]
    closed: bool = False


class RemoveWall(Request, frozen=True, kw_only=True, tag="remove_wall"):
    """Take away every wall and post of a name."""

    name: str


class FailBno055(Request, frozen=True, kw_only=True, tag="bno055"):
    """Break the joystick's sensor, or mend it."""

    fault: Bno055Fault


class FailSonar(Request, frozen=True, kw_only=True, tag="sonar"):
    """Break one of the ranger's sensors, or mend it."""

    number: int
    fault: SonarFault
    wild_share: float = 0.0
    """Of the pings, for the fault `wild_some`."""


class CutBumper(Request, frozen=True, kw_only=True, tag="bumper"):
    """Cut a bumper's wire, or mend it."""

    number: int
    cut: bool


class CutEncoder(Request, frozen=True, kw_only=True, tag="encoder"):
    """Cut a wheel encoder's wires, or mend them."""

    wheel: Wheel
    cut: bool


class SlipEncoder(Request, frozen=True, kw_only=True, tag="encoder_slip"):
    """Let a wheel's encoder lose counts, or mend it."""

    wheel: Wheel
    lost_share: float
    """Share of the wheel's turning that is not counted; 0 mends it."""


class FlickerEncoder(Request, frozen=True, kw_only=True, tag="flicker"):
    """Let a wheel's encoder count to and fro while the wheel rests, or mend it."""

    wheel: Wheel
    flickers: bool


class CutSignal(Request, frozen=True, kw_only=True, tag="signal"):
    """Pull off the wire from a wheel's servo output to the motor driver, or put it back."""

    wheel: Wheel
    cut: bool


class BlockWheel(Request, frozen=True, kw_only=True, tag="block"):
    """Hold a wheel so that it does not turn whatever its motor gets, or let it go."""

    wheel: Wheel
    blocked: bool


class BrakeWheel(Request, frozen=True, kw_only=True, tag="brake"):
    """Hold a wheel back, as a hand does, or let it go."""

    wheel: Wheel
    brake: float
    """m/s² at its rim, against its motion; 0 lets it go."""


class Rewire(Request, frozen=True, kw_only=True, tag="rewire"):
    """Rewire motors and encoders."""

    wiring: Annotated[int, msgspec.Meta(ge=0, le=int(~Wiring(0)))]
    """What `configure.wiring` must then be for the robot to drive well."""


class Battery(Request, frozen=True, kw_only=True, tag="battery"):
    """Set the battery's voltage with nothing connected."""

    volts: float


class Push(Request, frozen=True, kw_only=True, tag="push"):
    """Push a robot that balances, for 0.2 s."""

    impulse: float
    """N s, forward positive."""
    height: float = 0.8
    """m above the axle."""


class Unplug(Request, frozen=True, kw_only=True, tag="unplug"):
    """Pull a board's serial cable. The board keeps its power."""

    board: BoardName


class Plug(Request, frozen=True, kw_only=True, tag="plug"):
    """Plug it in again."""

    board: BoardName


class Reset(Request, frozen=True, kw_only=True, tag="reset"):
    """Reset a board's processor."""

    board: BoardName
    cause: Literal["power_on", "external", "brown_out", "watchdog"] = "external"


AnyRequest = (
    Now
    | GetState
    | GetRoom
    | GetTruth
    | GetRecord
    | Tilt
    | SetHand
    | Button
    | Place
    | AddWall
    | RemoveWall
    | FailBno055
    | FailSonar
    | CutBumper
    | CutEncoder
    | SlipEncoder
    | FlickerEncoder
    | CutSignal
    | BlockWheel
    | BrakeWheel
    | Rewire
    | Battery
    | Push
    | Unplug
    | Plug
    | Reset
)


class BoardState(msgspec.Struct, frozen=True, kw_only=True):
    """One board."""

    state: RunState
    plugged: bool
    resets: int
    """Of every kind, since the start."""
    sent: int
    """Bytes the board has sent."""
    taken: int
    """Bytes that have arrived at the board."""
    lost: int
    """Bytes of the board that reached nobody."""
    complaints: int
    """Of the simulator about the board."""
    complaint: str
    """The last one."""


class BaseSays(msgspec.Struct, frozen=True, kw_only=True):
    """The base board's newest telemetry; names as in firmware/common/protocol.h."""

    boot_id: int
    session: int
    drive_state: str
    latch: str
    last_refusal: str
    left_ticks: int
    right_ticks: int
    left_pwm_counts: int
    right_pwm_counts: int
    accepted: int
    refused: int
    line_errors: int


class Surfaces(msgspec.Struct, frozen=True, kw_only=True):
    """Walls and posts, m."""

    version: int
    """Changes with the room."""
    walls: list[tuple[str, float, float, float, float]]
    """A name and both ends."""
    posts: list[tuple[str, float, float, float]]
    """A name, the middle and the radius."""


class State(msgspec.Struct, frozen=True, kw_only=True):
    """The simulated robot as it truly is."""

    now_us: int
    x: float
    y: float
    yaw: float
    left_speed: float
    """m/s of the true rim."""
    right_speed: float
    speed: float
    """m/s at which the wheels carry the centre."""
    turn: float
    """rad/s at which they turn the body."""
    lean: float
    """rad that it leans forward about its axle."""
    pivot: float
    """m of that axle above the floor."""
    room_version: int
    """Version of the room. It changes with the room's surfaces."""
    path_length: float
    clearance: float
    """m between the robot's disc and what is nearest to it."""
    closest: float
    """The smallest clearance so far."""
    contacts: int
    battery_volts: float
    skew: float
    """s by which simulated time has slipped behind the wall's."""
    pings: dict[int, int]
    """Of each sonar."""
    boards: dict[str, BoardState]
    base: BaseSays | None
    """None before its first telemetry."""
    balance: Balance | None
    """None: it cannot fall over."""
    drawn: DrawnBody | None
    """Difference between body and file. Of `truth` only what is not its body applies. None: all of it does."""


class Reply(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """The answer to any request."""

    ok: bool
    error: str = ""
    """Why not."""
    now_us: int = 0
    """When the request was done; what it changed acts from the next millisecond on."""
    state: State | None = None
    room: Surfaces | None = None
    truth: Truth | None = None
    record: MotorWindow | None = None

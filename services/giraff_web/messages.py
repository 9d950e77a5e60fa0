"""What page and service say to each other on the WebSocket: JSON objects, each with its `type`.

Numbers of 64 bits travel as decimal strings, since a page's own numbers are exact to 2^53 only. SI units, REP-103. The
page says each `Trouble` in its own words; where its `what` is empty, nothing is wrong.
"""

from typing import Annotated, Final, Literal

import msgspec

from giraff_schemas.messages import RobotTime
from giraff_schemas.places import FARTHEST, Place, require_place_name
from giraff_schemas.trouble import NO_TROUBLE, Trouble

LARGEST: Final = 8192
"""Bytes of a message of a page."""

_Number = Annotated[int, msgspec.Meta(ge=0, lt=1 << 53)]
_Digits = Annotated[str, msgspec.Meta(pattern=r"^[0-9]{1,20}\Z")]
Moment = tuple[_Digits, _Digits]
"""A tick: epoch and robot_ns, as the state has them; the page gives it back unchanged."""

_Seconds = Annotated[float, msgspec.Meta(ge=0.0, le=1e9)]
_Acceleration = Annotated[float, msgspec.Meta(ge=-1e4, le=1e4)]
Reading = tuple[_Seconds, _Acceleration, _Acceleration, _Acceleration]
"""When (s, of the page's own clock) and DeviceMotion's accelerationIncludingGravity (x, y, z; m/s²)."""

Input = Literal["tilt", "pad", "keys", "gamepad"]


def moment(tick: RobotTime | None) -> Moment | None:
    """As a page is told it."""
    return None if tick is None else (str(tick.epoch), str(tick.robot_ns))


def robot_time(tick: Moment | None) -> RobotTime | None:
    """As a page gives it back. Raises ValueError."""
    return None if tick is None else RobotTime(epoch=int(tick[0]), robot_ns=int(tick[1]))


class _FromPage(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="type"):
    """Each message of a page."""


class PageWish(_FromPage, frozen=True, kw_only=True, tag="wish"):
    """What the hand asks, made in one animation frame of a page that is visible and has the focus."""

    n: _Number
    """Counts the wishes of this page's connection upwards."""
    tick: Moment | None
    """Newest the page held at the newest event that this stands on (`tilt`: of the newest reading; else this frame)."""
    hold: _Number
    """Counts the touches (or presses, when no key was down) since the page was loaded; 0: nothing is held now."""
    input: Input
    forward: Annotated[float, msgspec.Meta(ge=-1.0, le=1.0)] = 0.0
    """Of pad, keys or gamepad: share of their full speed, backwards negative. 0 in the first wish of each hold."""
    left: Annotated[float, msgspec.Meta(ge=-1.0, le=1.0)] = 0.0
    """The same of their turn, counter-clockwise positive."""
    readings: Annotated[tuple[Reading, ...], msgspec.Meta(max_length=40)] = ()
    """Of `tilt`: those since the last wish, oldest first, also while nothing is held."""
    angle: Literal[0, 90, 180, 270] = 0
    """screen.orientation.angle: by how much the screen's content is turned in the device."""


class LetGo(_FromPage, frozen=True, kw_only=True, tag="let_go"):
    """The hold has ended. `finger`: on purpose. Else the page has lost the hand, and why is told."""

    n: _Number
    """Goes on counting the wishes."""
    why: Literal["finger", "cancelled", "hidden", "focus", "turned", "idle", "stalled", "left", "gamepad"]
    """`cancelled`: the browser took the touch for itself; `idle`: 1 s without an event; `stalled`: the page stood
    still; `turned`: the screen; `left`: the page is being closed; `gamepad`: the one that held is not heard, or no
    hand moves it."""


class Stop(_FromPage, frozen=True, kw_only=True, tag="stop"):
    """The emergency stop."""

    off: bool = False
    """STOP is held: the stop is to be off."""


class Reset(_FromPage, frozen=True, kw_only=True, tag="reset"):
    """Release the emergency stop that is shown: a second tap, on a question that names it."""

    id: _Digits
    engaged_ns: _Digits
    tick: Moment | None
    """Newest that the page held at the tap."""

    def __post_init__(self) -> None:
        if max(int(self.id), int(self.engaged_ns)) >= 1 << 63:
            raise ValueError(f"id {self.id}, engaged_ns {self.engaged_ns}: no stop is called so")


class StateSeen(_FromPage, frozen=True, kw_only=True, tag="seen"):
    """The page has shown the state of this number: it may be sent newer ones."""

    n: _Number


class End(_FromPage, frozen=True, kw_only=True, tag="end"):
    """End another page and its device's session. Only a page that may drive is heard."""

    page: Annotated[int, msgspec.Meta(ge=1, lt=1 << 53)]
    """Its number."""


class Look(_FromPage, frozen=True, kw_only=True, tag="look"):
    """A person switches the camera's picture on or off. Only a page that may drive is heard."""

    on: bool


class PictureSeen(_FromPage, frozen=True, kw_only=True, tag="picture_seen"):
    """The page has shown the picture of this number: it may be sent the next one."""

    n: Annotated[int, msgspec.Meta(ge=0, lt=1 << 32)]


_Metre = Annotated[float, msgspec.Meta(ge=-FARTHEST, le=FARTHEST)]
Spot = str | tuple[_Metre, _Metre]  # msgspec 0.22 crashes by a str with limits beside a tuple
"""Name of a place, or a point (x, y; m) of the floor plan."""


class Go(_FromPage, frozen=True, kw_only=True, tag="go"):
    """Asks for a route: a second tap, on a question that names its goal."""

    n: _Number
    """Counts the routes that this page asks for, from 1."""
    tick: Moment
    """Newest that the page held at the tap."""
    goal: Spot

    def __post_init__(self) -> None:
        if isinstance(self.goal, str):
            require_place_name(self.goal)


class RouteHold(_FromPage, frozen=True, kw_only=True, tag="route_hold"):
    """The page that has asked for a route is still in front, and has heard the robot just now."""

    tick: Moment


class RouteCancel(_FromPage, frozen=True, kw_only=True, tag="route_cancel"):
    """Ends the route. Every page is heard, as with a stop."""

    n: _Number = 0
    """Number of this page's `Go`; 0: whichever route goes on."""


FromPage = PageWish | LetGo | Stop | Reset | StateSeen | End | Look | PictureSeen | Go | RouteHold | RouteCancel


class _ToPage(msgspec.Struct, frozen=True, kw_only=True, tag_field="type"):
    """Each message to a page."""


Lines = tuple[tuple[tuple[float, float], ...], ...]
"""Polylines, m."""


class Room(msgspec.Struct, frozen=True, kw_only=True):
    """The room of a simulated robot, in `odom` as it was when the robot began."""

    walls: Lines
    map: str = ""
    """Name of the floor plan that is this room; empty: there is none."""
    start: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """x, y (m) and yaw (rad) of the robot's start on that floor plan."""


class Hello(_ToPage, frozen=True, kw_only=True, tag="hello"):
    """The first message of each connection."""

    page: int
    """Number of this connection."""
    device: str
    """What this device is called here."""
    may_drive: bool
    """It has shown a token: it may drive and reset."""
    robot: str
    radius: float
    """m, of the robot's footprint."""
    track: float
    """m between its wheels."""
    slow_speed: float
    trail: tuple[tuple[float, float], ...]
    """The path so far, m in odom, oldest first; the page goes on with the poses of the states."""
    room: Room | None = None


class Plan(_ToPage, frozen=True, kw_only=True, tag="plan"):
    """The floor plan that the robot is on, when a page opens and whenever it changes."""

    map: str
    walls: Lines
    """m, in `map`."""
    places: tuple[Place, ...] = ()
    no_go: Lines = ()
    """m, in `map`. Lines that no route crosses."""


class Direction(msgspec.Struct, frozen=True, kw_only=True):
    """The guard's verdict on one way."""

    clearance: str
    """free, slow, creep or blocked."""
    allowed: float
    """m/s or rad/s."""
    sensor: str
    reason: Trouble


class Latch(msgspec.Struct, frozen=True, kw_only=True):
    """The emergency stop, as base says it."""

    engaged: bool
    off: bool
    word: str
    """Whose word it is, where it is shown as confirmed."""
    by: str
    reason: Trouble
    id: str
    engaged_ns: str


class SensorView(msgspec.Struct, frozen=True, kw_only=True):
    """A sensor's newest sample, whatever its type, in words and on the floor. Places are in `base_link`."""

    state: str
    """free, seen, near (close to the robot's rim), or fault: it tells nothing, or was not heard of late."""
    text: str
    reason: Trouble
    """Cause of a fault."""
    free: Lines
    """Outlines of the floor where nothing stands; of a fault, of all the floor that it senses."""
    seen: Lines = ()
    """Lines along what stands there. A line of one place is a point."""


class Balance(msgspec.Struct, frozen=True, kw_only=True):
    """How a robot that balances holds itself. Leaning forward is positive."""

    posture: str
    """off, stands or sits down."""
    cause: str
    """Why it is off or sits down."""
    lean: float
    """rad, by gyroscope and accelerometer together."""
    accelerometer_lean: float
    """rad, by the accelerometer alone."""
    rate: float
    """rad/s."""
    torque: float
    """N m of both motors."""
    wheels: tuple[float, float] | None
    """m/s of the left and the right wheel."""


class CameraView(msgspec.Struct, frozen=True, kw_only=True):
    """The robot's camera, as every page is told of it. Its pictures come as binary messages (`giraff_web.camera`)."""

    askers: tuple[str, ...]
    """Who looks now; empty: the camera is off."""
    why: Trouble
    """Cause, where something is wrong with it."""


class MapView(msgspec.Struct, frozen=True, kw_only=True):
    """Where localization takes the robot to be."""

    state: str
    map: str
    """Name of the floor plan; empty: there is none."""
    pose: tuple[float, float, float]
    """x, y (m) and yaw (rad) on that floor plan."""
    covariance: tuple[float, float, float]
    """m². xx, xy and yy of `pose`."""
    yaw_sd: float
    """rad. Standard deviation of the yaw."""
    why: Trouble
    """Cause, where the sensors do not confirm the pose."""
    odom: tuple[float, float, float]
    """x, y (m) and yaw (rad) of the frame `odom` on that floor plan."""


class State(_ToPage, frozen=True, kw_only=True, tag="state"):
    """All that is shown, 25 times a second at most; None: it is not heard."""

    n: int
    tick: Moment | None
    """Newest of the robot; None: it is lost."""
    age: float | None
    """s since one was heard here; None: none was."""
    operator: str
    """Who drives, by the name on its commands; empty: nobody."""
    device: str
    """Whose page it is that drives, when it is one of this service's; empty: none."""
    page: int
    """Number of that page; 0: none."""
    armed: bool | None
    why: Trouble
    """Cause, where the robot does not drive as this service's hand asks, or would not."""
    stop: Latch | None
    stop_outcome: Trouble
    """Outcome of a stop or a release that was asked for here. `NO_TROUBLE`: nothing is open."""
    directions: dict[str, Direction] | None
    """By forward, backward, turn_left, turn_right."""
    evidence: dict[str, SensorView]
    """By sensor of the robot file."""
    pose: tuple[float, float, float] | None
    """x, y (m) and yaw (rad) in odom."""
    covariance: tuple[float, float, float] | None
    """m². xx, xy and yy of `pose`."""
    segment: str
    """Another one: the pose was set from outside, and the path begins anew."""
    speed: tuple[float, float] | None
    """m/s and rad/s, by the wheels."""
    path: float | None
    """m travelled."""
    battery: float | None
    """V."""
    round_trip: float | None
    """s from the hand to the wheels."""
    since_charge: float | None = None
    """s since base last saw a charge of the battery."""
    balance: Balance | None = None
    """None: it is no robot that balances."""
    camera: CameraView | None = None
    """None: no camera was heard."""
    map: MapView | None = None
    """None: localization is not heard."""
    room_fits: bool = True
    """The robot's start is still the origin of `odom`. Otherwise only the map tells where the room is."""


class Refused(_ToPage, frozen=True, kw_only=True, tag="refused"):
    """This page's hold does not count, or does again."""

    why: Trouble
    """`NO_TROUBLE`: it counts, or there is none."""
    route: bool = False
    """It is about this page's route instead: that did not begin, or nobody tells how it goes on."""


class Route(_ToPage, frozen=True, kw_only=True, tag="route"):
    """The route that goes on, or has ended a while ago, for every page; whenever it changes."""

    stage: str = "idle"
    """As `RouteState` has it. `asking`: nobody has answered yet; `idle`: there is nothing to show."""
    page: int = 0
    """Number of the page that has asked for it, by its `Go` of number `n`; 0: none of this service's."""
    n: int = 0
    by: str = ""
    goal: Spot | None = None
    end: tuple[float, float] | None = None
    """m, in `map`; None: nobody has told where the goal is. `at`: of what is in the way."""
    corners: tuple[tuple[float, float], ...] = ()
    """m, in `map`: from the end of this leg to the goal."""
    at: tuple[float, float] | None = None
    leg: int = 0
    legs: int = 0
    come: float = 0.0
    """m that the robot has come, of `way`."""
    way: float = 0.0
    outcome: str = ""
    why: Trouble = NO_TROUBLE
    """Cause, where it waits, or has not arrived."""


class Looking(_ToPage, frozen=True, kw_only=True, tag="looking"):
    """Whether this page is sent the camera's picture."""

    on: bool
    why: Trouble
    """Cause, where it is off and no person has switched it."""


class OpenPage(msgspec.Struct, frozen=True, kw_only=True):
    """A page that is open."""

    page: int
    """Number of its connection, never again another's."""
    device: str
    """As people know it: `Android phone at 192.168.1.7`."""
    may_drive: bool
    age: float
    """s since it was opened."""


class OpenPages(_ToPage, frozen=True, kw_only=True, tag="pages"):
    """All pages that are open. Only those that may drive are told, when others have come or gone."""

    pages: tuple[OpenPage, ...]


ToPage = Hello | State | Plan | Route | Refused | Looking | OpenPages

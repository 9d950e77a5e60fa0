"""Motions by metres and radians: what giraff_motion is asked, what it answers, and what it says of how it goes.

Poses are of `base_link`; axes are REP-103's. A yaw here counts whole turns.
"""

import math
from typing import Literal

import msgspec

from giraff_schemas.checks import require_finite
from giraff_schemas.messages import RobotTime, Sample
from giraff_schemas.trouble import NO_TROUBLE, Trouble


class Move(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag="move"):
    """Straight on."""

    distance: float
    """m; negative: backward."""

    def __post_init__(self) -> None:
        require_finite(self, self.distance)


class Turn(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag="turn"):
    """On the spot."""

    angle: float
    """rad, left positive; any number of turns."""

    def __post_init__(self) -> None:
        require_finite(self, self.angle)


class Arc(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag="arc"):
    """Along a circle whose middle is beside the robot: to its left where `angle` is positive, else to its right."""

    radius: float
    """m."""
    angle: float
    """rad along the circle; any number of turns."""

    def __post_init__(self) -> None:
        require_finite(self, self.radius, self.angle)


class GoTo(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag="go_to"):
    """Turn to a point, and straight to it. No way around anything is planned."""

    x: float
    """m, in `frame`."""
    y: float
    frame: Literal["odom", "map"] = "odom"
    """`map`: it begins only while the robot is localized, and ends where that is over."""

    def __post_init__(self) -> None:
        require_finite(self, self.x, self.y)


Step = Move | Turn | Arc | GoTo


class MotionRequest(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What each request for a motion has.

    What is not known is refused: a limit that is spelt otherwise would be none. Who asks says `MotionHold` once it is
    accepted, 25 times a second: without it nothing moves.
    """

    by: str
    id: int
    """Random, of this wish, never 0: asked again with the same one, nothing is begun again."""
    instance: str
    """Instance that the requester's `MotionHold` carries, never empty: nobody else's hold keeps the motion going."""
    tick: RobotTime
    """The newest that was heard when it was wished: an old request begins nothing."""
    speed: float | None = None
    """m/s at most; None: as `[motion]` has it."""
    turn_speed: float | None = None
    """rad/s at most, on the spot; None: as `[motion]` has it."""
    time_limit: float | None = None
    """s after which it ends, wherever it is; None: twice what it takes when nothing is in the way."""

    def __post_init__(self) -> None:
        require_finite(self, *(value for value in (self.speed, self.turn_speed, self.time_limit) if value is not None))


class MotionMove(MotionRequest, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Asks for a `Move`."""

    distance: float


class MotionTurn(MotionRequest, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Asks for a `Turn`."""

    angle: float


class MotionArc(MotionRequest, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Asks for an `Arc`."""

    radius: float
    angle: float


class MotionGo(MotionRequest, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Asks for steps, one after the other: each begins where the one before it was to end."""

    steps: tuple[Step, ...]


def steps_of(request: MotionRequest) -> tuple[Step, ...]:
    """What it asks for. Raises ValueError where a number is none."""
    match request:
        case MotionMove():
            return (Move(distance=request.distance),)
        case MotionTurn():
            return (Turn(angle=request.angle),)
        case MotionArc():
            return (Arc(radius=request.radius, angle=request.angle),)
        case MotionGo():
            return request.steps
        case _:
            raise TypeError(f"{type(request).__name__} asks for no motion")


class MotionCancel(msgspec.Struct, frozen=True, kw_only=True):
    """Asks to stop at once, and to end the motion."""

    by: str
    id: int = 0
    """Of the request that is to end; 0: whichever goes on."""


class MotionAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """What became of a request: how it ends is said by `MotionState`."""

    accepted: bool
    reason: Trouble = NO_TROUBLE
    """Cause of a refusal."""


class MotionHold(Sample, frozen=True, kw_only=True):
    """Who has asked for a motion is still there, and has heard the robot just now: a hand that holds a key down."""

    id: int
    """Of the request."""
    tick: RobotTime
    """The newest of the robot that the requester has heard: never renewed on its way."""


class Displacement(msgspec.Struct, frozen=True, kw_only=True):
    """From where a motion began, seen from there."""

    path: float
    """m along the way: forward counts positive, backward negative."""
    x: float
    y: float
    yaw: float
    """rad, whole turns counted."""

    def __post_init__(self) -> None:
        require_finite(self, self.path, self.x, self.y, self.yaw)


NOWHERE = Displacement(path=0.0, x=0.0, y=0.0, yaw=0.0)

Stage = Literal["idle", "arming", "moving", "waiting", "stopping", "ended"]
"""`waiting`: something is in the way of a route, and it is not asked to move; `stopping`: it is over, and the robot
still rolls: what was achieved is not known yet."""
Outcome = Literal[
    "",
    "arrived",
    "blocked",
    "cancelled",
    "lost_lease",
    "time_limit",
    "lost_requester",
    "disarmed",
    "lost_odometry",
    "lost_localization",
    "no_room",
    "no_way",
    "too_narrow",
    "forbidden",
]
"""Reason of its end; empty: it goes on. The last four are of routes: the robot cannot stand at the goal, walls are all
round, each way has a gap that is too narrow, each way crosses a no-go line."""


class MotionState(Sample, frozen=True, kw_only=True):
    """How the motion goes on, or how the last one ended: until the next one begins."""

    id: int
    """Of the request; 0: there was none yet."""
    by: str
    stage: Stage
    step: int
    """Which of the steps it is at, from 1; 0: none yet."""
    steps: int
    asked: Displacement
    achieved: Displacement
    """By odometry."""
    covariance: tuple[float, float, float, float, float, float]
    """Of `achieved` (x, y, yaw), what odometry may err by on this way: xx, xy, xyaw, yy, yyaw, yawyaw."""
    elapsed: float
    """s since it was accepted."""
    time_limit: float
    """s."""
    outcome: Outcome
    sensor: str
    """Of the guard's, which blocks the way; empty: none does."""
    reason: Trouble = NO_TROUBLE
    """Cause, where the robot does not move now, or has not arrived at the end."""

    def __post_init__(self) -> None:
        require_finite(self, *self.covariance, self.elapsed, self.time_limit)

    @property
    def standard_deviations(self) -> tuple[float, float, float]:
        """Of x (m), y (m) and yaw (rad) of `achieved`."""
        xx, _, _, yy, _, tt = self.covariance
        return math.sqrt(max(0.0, xx)), math.sqrt(max(0.0, yy)), math.sqrt(max(0.0, tt))


IDLE = MotionState(
    id=0,
    by="",
    stage="idle",
    step=0,
    steps=0,
    asked=NOWHERE,
    achieved=NOWHERE,
    covariance=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    elapsed=0.0,
    time_limit=0.0,
    outcome="",
    sensor="",
)
"""Nobody has asked for a motion yet."""

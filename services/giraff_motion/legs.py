"""The way of a motion: straight pieces, turns on the spot and arcs, each from where the one before it was to end.

So what one of them missed is made good by the next. Poses are m, m, rad in `odom`; a yaw counts whole turns.
"""

import math
from collections.abc import Iterable
from typing import Final, NamedTuple, Protocol

from giraff_core.bounds import Bounds
from giraff_core.kinematics.pose import Pose
from giraff_schemas.messages import Direction
from giraff_schemas.motion import Arc, Displacement, GoTo, Move, Step, Turn

_LONGEST: Final = Bounds(-1000.0, 1000.0, "m")
_MOST_TURN: Final = Bounds(-100.0 * math.tau, 100.0 * math.tau, "rad")
_RADII: Final = Bounds(0.05, 100.0, "m", "0 would be a turn on the spot")
_MOST_STEPS: Final = 1000
_SETTLING_TIME: Final = 1.0
"""s at the end of a piece."""
_THERE: Final = 0.005
"""m from a point at which its direction says nothing."""

_HEADING_GAIN: Final = 2.0
"""1/s: how fast a heading that is off comes back."""
_LATERAL_GAIN: Final = 1.5
"""rad/m: how far the robot turns to the line that it is beside of."""
_MOST_OFF: Final = 0.4
"""rad, of that."""
_FADES: Final = 0.25
"""m before the end, from which on it looks ahead rather than to the line."""
_MOST_CORRECTION: Final = 0.6
"""rad/s"""


class Leg(Protocol):
    """One piece of the way."""

    @property
    def turns(self) -> bool:
        """It is a turn on the spot, and measured in rad; else in m."""
        ...

    @property
    def length(self) -> float:
        """m or rad, never negative."""
        ...

    def error(self, pose: Pose) -> float:
        """m ahead or rad to the left that are missing; negative: it went too far."""
        ...

    def direction(self, way: float) -> Direction:
        """For the guard. `way`: as `error`."""
        ...

    def twist(self, pose: Pose, speed: float) -> tuple[float, float]:
        """m/s and rad/s that keep to it, at a signed speed of m/s or rad/s."""
        ...


class Straight(NamedTuple):
    """From `start`, ahead or back."""

    start: Pose
    distance: float
    """m"""

    @property
    def turns(self) -> bool:
        return False

    @property
    def length(self) -> float:
        return abs(self.distance)

    def error(self, pose: Pose) -> float:
        return self.distance - self.start.ahead(pose, 0.0)

    def direction(self, way: float) -> Direction:
        return _along(way)

    def twist(self, pose: Pose, speed: float) -> tuple[float, float]:
        _, beside = self.start.sees(pose.x, pose.y)
        return speed, _correction(self.start.yaw - pose.yaw, beside, speed, abs(self.error(pose)))


class Rotation(NamedTuple):
    """To a heading. Where the robot is meanwhile is left to the next piece."""

    begin: float
    """rad"""
    end: float
    """rad"""

    @property
    def turns(self) -> bool:
        return True

    @property
    def length(self) -> float:
        return abs(self.end - self.begin)

    def error(self, pose: Pose) -> float:
        return self.end - pose.yaw

    def direction(self, way: float) -> Direction:
        return "turn_left" if way > 0.0 else "turn_right"

    def twist(self, pose: Pose, speed: float) -> tuple[float, float]:
        del pose
        return 0.0, speed


class Circle(NamedTuple):
    """Forward from `start` about a middle beside it."""

    start: Pose
    radius: float
    """m"""
    angle: float
    """rad, left positive."""

    @property
    def turns(self) -> bool:
        return False

    @property
    def length(self) -> float:
        return self.radius * abs(self.angle)

    def error(self, pose: Pose) -> float:
        return self.length - self._gone(pose)[0] * self.radius

    def direction(self, way: float) -> Direction:
        return _along(way)

    def twist(self, pose: Pose, speed: float) -> tuple[float, float]:
        gone, outside = self._gone(pose)
        side = math.copysign(1.0, self.angle)
        heading = self.start.yaw + side * gone
        correction = _correction(heading - pose.yaw, -side * outside, speed, abs(self.error(pose)))
        return speed, side * speed / self.radius + correction

    def _gone(self, pose: Pose) -> tuple[float, float]:
        """rad along the circle, and m outside it. Whole turns are told by the heading."""
        side = math.copysign(1.0, self.angle)
        ahead, left = self.start.sees(pose.x, pose.y)
        inward = self.radius - side * left
        by_heading = side * (pose.yaw - self.start.yaw)
        by_place = math.atan2(ahead, inward)
        gone = by_heading + math.remainder(by_place - by_heading, math.tau)
        return gone, math.hypot(ahead, inward) - self.radius


class Limits(NamedTuple):
    """m/s and m/s² of a piece along the floor, rad/s and rad/s² of a turn."""

    top: float
    least: float
    deceleration: float
    tolerance: float
    """m or rad."""


class Planned(NamedTuple):
    """One piece of a way."""

    step: int
    """That it belongs to, from 1."""
    leg: Leg
    limits: Limits

    @property
    def seconds(self) -> float:
        """That it takes when nothing is in the way."""
        limits = self.limits
        return self.leg.length / limits.top + limits.top / limits.deceleration + _SETTLING_TIME


class Plan(NamedTuple):
    """All of it."""

    legs: tuple[Planned, ...]
    asked: Displacement


def plan(steps: Iterable[Step], start: Pose, floor: Limits, spot: Limits, first: int = 1) -> Plan:
    """The way of these steps in `odom` from `start`, along the floor and on the spot; `first`: number of the first.

    Raises ValueError where they are none.
    """
    steps = tuple(steps)
    if len(steps) > _MOST_STEPS:
        raise ValueError(f"these are {len(steps)} steps: give {_MOST_STEPS} at most")
    legs: list[Planned] = []
    here, path = start, 0.0
    for number, step in enumerate(steps, first):
        try:
            pieces, here = _pieces(step, here)
        except ValueError as error:
            raise ValueError(f"step {number}: {error}" if len(steps) > 1 else str(error)) from error
        legs += [Planned(number, piece, _limits(piece, floor, spot)) for piece in pieces]
        path += sum(_signed(piece) for piece in pieces if not piece.turns)
    x, y = start.sees(here.x, here.y)
    return Plan(tuple(legs), Displacement(path=path, x=x, y=y, yaw=here.yaw - start.yaw))


def _pieces(step: Step, here: Pose) -> tuple[list[Leg], Pose]:
    """The pieces of one step, and where it ends."""
    match step:
        case Move(distance=distance):
            _LONGEST.require("distance", distance)
            end = Pose(here.x + distance * math.cos(here.yaw), here.y + distance * math.sin(here.yaw), here.yaw)
            return [Straight(here, distance)] if distance else [], end
        case Turn(angle=angle):
            _MOST_TURN.require("angle", angle)
            return [Rotation(here.yaw, here.yaw + angle)] if angle else [], here._replace(yaw=here.yaw + angle)
        case Arc(radius=radius, angle=angle):
            _RADII.require("radius", radius)
            _MOST_TURN.require("angle", angle)
            side = math.copysign(1.0, angle)
            middle = Pose(here.x - side * radius * math.sin(here.yaw), here.y + side * radius * math.cos(here.yaw), 0.0)
            yaw = here.yaw + angle
            end = Pose(middle.x + side * radius * math.sin(yaw), middle.y - side * radius * math.cos(yaw), yaw)
            # A robot that still curves when it is told to stop turns a little on: what is off is made good on the spot.
            return [Circle(here, radius, angle), Rotation(yaw, yaw)] if angle else [], end
        case GoTo(x=x, y=y):
            distance = math.hypot(x - here.x, y - here.y)
            _LONGEST.require("the way to x, y", distance)
            if distance < _THERE:
                return [], here
            turn = math.remainder(math.atan2(y - here.y, x - here.x) - here.yaw, math.tau)
            begin = here._replace(yaw=here.yaw + turn)
            return [Rotation(here.yaw, begin.yaw), Straight(begin, distance)], Pose(x, y, begin.yaw)


def _limits(leg: Leg, floor: Limits, spot: Limits) -> Limits:
    """A curve is so slow that the robot turns no faster than on the spot; but not below the least speed."""
    if isinstance(leg, Circle):
        return floor._replace(top=max(floor.least, min(floor.top, leg.radius * spot.top)))
    return spot if leg.turns else floor


def _signed(leg: Leg) -> float:
    return math.copysign(leg.length, leg.distance) if isinstance(leg, Straight) else leg.length


def _along(way: float) -> Direction:
    return "forward" if way > 0.0 else "backward"


def _correction(off: float, beside: float, speed: float, remaining: float) -> float:
    """rad/s that bring the robot back to a heading it is `off` by (rad), and to a line it is `beside` of (m, left)."""
    looks = min(1.0, remaining / _FADES)
    towards = -math.copysign(looks, speed) * max(-_MOST_OFF, min(_MOST_OFF, _LATERAL_GAIN * beside))
    return max(-_MOST_CORRECTION, min(_MOST_CORRECTION, _HEADING_GAIN * (off + towards)))

"""A wish for a motion of giraff_motion or a route of giraff_places, and the keys of each."""

from collections.abc import Sequence
from typing import Any, Final, NamedTuple

from giraff_schemas.messages import RobotTime
from giraff_schemas.motion import MotionCancel, MotionGo, MotionHold, Step
from giraff_schemas.places import Goal, PlacesGo
from giraff_schemas.services import MOTION as MOTION_SERVICE
from giraff_schemas.services import PLACES as PLACES_SERVICE
from giraff_schemas.topics import (
    MOTION,
    MOTION_CANCEL,
    MOTION_GO,
    MOTION_HOLD,
    PLACES_CANCEL,
    PLACES_GO,
    PLACES_HOLD,
    ROUTE,
    Query,
    Topic,
)


class AskedService(NamedTuple):
    """Service that is asked, and its keys."""

    service: str
    """Package of it, for people."""
    go: Query[Any, Any]
    cancel: Query[MotionCancel, Any]
    hold: Topic[MotionHold]
    state: Topic[Any]
    """Topic of samples that are a `MotionState`."""
    silence: float
    """s without a state after which nobody knows what becomes of it. For want of holds the robot has stopped before."""


OF_MOTION: Final = AskedService(MOTION_SERVICE.package, MOTION_GO, MOTION_CANCEL, MOTION_HOLD, MOTION, 1.0)
OF_PLACES: Final = AskedService(PLACES_SERVICE.package, PLACES_GO, PLACES_CANCEL, PLACES_HOLD, ROUTE, 4.0)


class Wish(NamedTuple):
    """Steps, one after the other."""

    steps: Sequence[Step]
    speed: float | None = None
    """m/s at most; None: as `[motion]` has it."""
    turn_speed: float | None = None
    """rad/s at most, on the spot; None: as `[motion]` has it."""
    time_limit: float | None = None
    """s; None: as motion has it."""

    @property
    def asked(self) -> AskedService:
        """Service that is asked."""
        return OF_MOTION

    def request(self, by: str, wish: int, instance: str, tick: RobotTime) -> MotionGo:
        """Return what to ask. Raises ValueError where a number is none."""
        return MotionGo(
            by=by,
            id=wish,
            instance=instance,
            tick=tick,
            steps=tuple(self.steps),
            speed=self.speed,
            turn_speed=self.turn_speed,
            time_limit=self.time_limit,
        )


class RouteWish(NamedTuple):
    """A place, by a way that is planned."""

    goal: str | Goal

    @property
    def asked(self) -> AskedService:
        """Service that is asked."""
        return OF_PLACES

    def request(self, by: str, wish: int, instance: str, tick: RobotTime) -> PlacesGo:
        """Return what to ask."""
        return PlacesGo(by=by, id=wish, instance=instance, tick=tick, goal=self.goal)

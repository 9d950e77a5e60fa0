"""Ways from a trip to the robot."""

from collections.abc import Callable
from typing import Any, NamedTuple

from giraff_core.retry import RetriedRequest
from giraff_places.route.planner import NoRoute, Route
from giraff_schemas.localization import MapPose
from giraff_schemas.motion import MotionHold
from giraff_schemas.places import Goal
from giraff_schemas.topics import Query
from giraff_schemas.trouble import Trouble


class Motions(NamedTuple):
    """The way to giraff_motion."""

    ask: Callable[[Query[Any, Any], Any], RetriedRequest[Any]]
    hold: Callable[[MotionHold], object]
    token: Callable[[], int]
    instance: str


class Robot(NamedTuple):
    """Ways from a trip to the robot and to giraff_motion."""

    pose: Callable[[float], MapPose | Trouble]
    """Returns where the robot is at a moment, or why that is not known."""
    plan: Callable[[Goal, float, bool], Route | NoRoute | Trouble]
    """Returns the way to a goal. True: not through what is seen there now."""
    seen: Callable[[float], tuple[float, float] | None]
    """Returns where on the map something stands before the robot."""
    motions: Motions

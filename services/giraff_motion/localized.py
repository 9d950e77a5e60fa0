"""Whether a motion may go by where the robot is on the map, and how far a goal has moved since it was placed.

A step in `map` is driven in `odom`, where it is placed when it begins. Localization corrects itself a little all the
time, by a degree or two: what has become too much in total places the goal anew. What comes at once, between two of its
words, is no correction: it has taken the robot to be elsewhere, and what it says may be right or wrong. That ends it.
"""

import math
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple, TypeGuard

from giraff_core.kinematics.pose import Pose
from giraff_core.kinematics.pose_history import Segment
from giraff_core.motion.map_pose import HeardMapPose
from giraff_schemas.localization import MapPose, MapWalls
from giraff_schemas.messages import Odometry, RobotTime
from giraff_schemas.motion import GoTo, Step
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_COUNTS: Final = 1.0
"""s of the robot's own time, from the odometry in a pose on."""
_AHEAD: Final = 0.1
"""s by which the odometry in it may be newer than the newest tick here."""
_MOST_SHIFT: Final = 0.2
"""m"""
_MOST_TURN: Final = math.radians(10.0)

_OLD: Final = Trouble(
    "the pose on the map is from before this start of base or odometry, or old", "wait for localization"
)


class Localized:
    """The newest pose on the map. Times are s of any one monotonic clock."""

    def __init__(self) -> None:
        self._heard = HeardMapPose()
        self._map: MapWalls | None = None
        self._segment = Segment()

    def on_pose(self, pose: MapPose, now: float) -> None:
        """Take where the robot is on the map."""
        self._heard.on_pose(pose, now)

    def hear_map(self, plan: MapWalls) -> None:
        """Keep the newest floor plan: goals are judged by it."""
        self._map = plan

    def hear_odometry(self, odometry: Odometry) -> None:
        """Take since when `odom` is where it is: what was said of it before places nothing."""
        self._segment.on_odometry(odometry)

    @property
    def odom(self) -> Pose:
        """Where `odom` is in `map`; as long as there is no `fault`."""
        if (pose := self._heard.pose) is None:
            raise ValueError(self._heard.fault(0.0))
        return Pose(pose.odom.x, pose.odom.y, pose.odom.yaw)

    def fault(self, age: Callable[[RobotTime | None], float], now: float) -> Trouble:
        """Why no motion may go by it.

        `age`: s that a tick is old by the robot's own time; infinite: of another start of base.
        """
        pose = self._heard.pose
        if (fault := self._heard.fault(now)) or pose is None:
            return fault
        is_now = -_AHEAD <= age(pose.tick) <= _COUNTS and self._segment.holds(pose.tick)
        return NO_TROUBLE if is_now else _OLD

    def goal_fault(self, steps: Sequence[Step]) -> Trouble:
        """Return why the robot cannot stand at a goal in `map`. Goals are not judged without the plan of the pose."""
        plan, pose = self._map, self._heard.pose
        if plan is None or plan.free is None or pose is None or plan.instance != pose.instance:
            return NO_TROUBLE
        return next(filter(None, (plan.free.fault(step.x, step.y) for step in steps if is_in_map(step))), NO_TROUBLE)

    def placed(self, step: GoTo) -> "Placed":
        """A step in `map`. Raises ValueError where nothing was heard of it."""
        odom = self.odom
        goal = Pose(step.x, step.y, 0.0).seen_from(odom)
        return Placed(odom, GoTo(x=goal.x, y=goal.y))


class Placed(NamedTuple):
    """A goal in `map` that is driven to in `odom`."""

    odom: Pose
    """Where that was in `map`."""
    goal: GoTo
    """In `odom`."""

    def correction(self, odom: Pose, robot: Pose) -> "Correction":
        """Of what was known then, now that `odom` is there in `map`, and the robot in it."""
        moved = odom.seen_from(self.odom)
        points = (Pose(self.goal.x, self.goal.y, 0.0), robot)
        shifts = [math.dist(point.placed_in(moved)[:2], point[:2]) for point in points]
        return Correction(max(shifts), abs(moved.yaw))


class Correction(NamedTuple):
    """Of where things are in `map`."""

    shift: float
    """m, of the farther one of goal and robot."""
    turn: float
    """rad, without a sign."""

    @property
    def is_large(self) -> bool:
        return self.shift > _MOST_SHIFT or self.turn > _MOST_TURN


def is_in_map(step: Step) -> TypeGuard[GoTo]:
    """Whether it needs to be known where the robot is on the map."""
    return isinstance(step, GoTo) and step.frame == "map"

"""Which routes are driven: one at a time, of whoever asks in time. No I/O and no clock."""

import math
from typing import Any, Final

import msgspec

from giraff_core.kinematics.pose import Pose
from giraff_core.motion.timely import AnswersOnce, untimely
from giraff_core.operator import RobotLink
from giraff_core.robot import RobotConfig
from giraff_places.driving.robot import Motions, Robot
from giraff_places.driving.things import Things
from giraff_places.driving.trip import WAITS, Trip
from giraff_places.policy import PlacesPolicy
from giraff_places.route.planner import NoRoute, Route
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import EStop, Lease, Tick
from giraff_schemas.motion import MotionAnswer, MotionCancel, MotionHold, MotionState
from giraff_schemas.places import NO_ROUTE, Goal, PlacesGo, RouteState
from giraff_schemas.services import MOTION
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_TURNS: Final = 0.02
"""rad between two poses of a robot that turns too fast to tell where an echo came from."""
_JUMPED: Final = 0.3
"""m between two poses after which the things are elsewhere, too."""
_AHEAD: Final = 0.6
"""m before the robot's middle, where the guard stops it."""
_LINES: Final = Trouble("the no-go lines have become others", "wait: it plans anew")


class Driving:
    """Times are s of any one monotonic clock."""

    def __init__(self, places: PlacesPolicy, robot: RobotConfig, motions: Motions) -> None:
        self._places, self._motions = places, motions
        self._things = None if places.planner is None else Things(robot, places.planner.floor)
        self._link = RobotLink()
        self._answers = AnswersOnce()
        self._trip: Trip | None = None
        """The one that goes on, or the last one."""
        self._estop: EStop | None = None
        self._motion: MotionState | None = None
        self._lines = places.known.no_go
        self._driver = ""
        """Name of the operator that holds the lease."""
        self._pose: MapPose | None = None
        self._is_turning = True

    @property
    def is_active(self) -> bool:
        """Tell whether a route goes on, or the robot still rolls at its end."""
        return self._trip is not None and self._trip.stage != "ended"

    def on_tick(self, tick: Tick, now: float) -> None:
        """Take the robot's clock."""
        self._link.on_tick(tick, now)

    def on_pose(self, pose: MapPose, now: float) -> None:
        """Take where the robot is."""
        if self._trip is not None:
            self._trip.on_pose(now)
        if (last := self._pose) is not None:
            self._is_turning = abs(pose.yaw - last.yaw) > _TURNS
            if self._things is not None and abs(pose.x - last.x) + abs(pose.y - last.y) > _JUMPED:
                self._things.clear()
        self._pose = pose

    def on_sample(self, sample: Any, now: float) -> None:
        """Take what a sense tells, while a route goes on."""
        pose = self._places.pose(now)
        if self._things is not None and self.is_active and not self._is_turning and isinstance(pose, MapPose):
            self._things.on_sample(sample, Pose(pose.x, pose.y, pose.yaw), now)

    def on_request(self, request: PlacesGo, now: float) -> MotionAnswer:
        """Begin a route, or say why not. Asked again, it is the answer of the first time."""
        return self._answers.answer(request.id, lambda: self._begin(request, now))

    def on_cancel(self, request: MotionCancel, now: float) -> MotionAnswer:
        """End the route at once, whoever asks for it."""
        trip = self._trip
        if trip is None or not trip.goes_on or request.id not in (0, trip.id):
            return MotionAnswer(accepted=False, reason=Trouble("no such route goes on"))
        trip.cancel(request.by, now)
        return MotionAnswer(accepted=True)

    def on_hold(self, hold: MotionHold, now: float) -> None:
        """Take that who has asked still wishes it."""
        if self._trip is not None:
            self._trip.on_hold(hold, now)

    def on_state(self, state: MotionState, now: float) -> None:
        """Take how the motion goes."""
        self._motion = state
        if self._trip is not None:
            self._trip.on_state(state, now)

    def on_lease(self, lease: Lease, now: float) -> None:
        """Take who drives."""
        self._driver = lease.operator
        if self._trip is not None:
            self._trip.on_lease(lease.operator, now)

    def on_estop(self, estop: EStop, now: float) -> None:
        """Take whether the robot is stopped."""
        self._estop = estop
        if self._trip is not None:
            self._trip.on_estop(estop, now)

    def turn(self, now: float) -> None:
        """Do what is due."""
        if (trip := self._trip) is None:
            return
        if trip.goes_on and (reason := self._places.reason(now)):
            trip.end_for(reason, now)
        if self._lines != self._places.known.no_go:
            self._lines = self._places.known.no_go
            trip.hold_up(_LINES, now)
        trip.turn(now)

    def state(self, now: float) -> RouteState:
        """Return how the route goes on, or how the last one ended."""
        return NO_ROUTE if self._trip is None else self._trip.state(now)

    def _begin(self, request: PlacesGo, now: float) -> Trouble:
        """Return why not; NO_TROUBLE: it has begun."""
        if why := self._link.link_fault(now) or untimely(request, self._link.tick) or self._places.reason(now):
            return why
        if (trip := self._trip) is not None and self.is_active:
            return Trouble(f"a route of {trip.by} goes on", "wait for its end, or cancel it")
        if self._estop is not None and self._estop.engaged:
            return self._estop.reason.of(f"emergency stop, engaged by {self._estop.by}")
        if self._motion is not None and self._motion.stage not in {"idle", "ended"}:
            return Trouble(f"a motion of {self._motion.by} goes on", "wait for its end, or cancel it")
        if self._driver not in ("", MOTION.name):
            return Trouble(f"{self._driver} drives", "wait until it rests, or end it; then ask again")
        if isinstance(pose := self._places.pose(now), Trouble):
            return pose
        goal, name = request.goal, ""
        if isinstance(goal, str):
            name, place = goal, self._places.goal(goal)
            if isinstance(place, Trouble):
                return place
            goal = Goal(x=place.x, y=place.y, yaw=place.yaw)
        if goal.yaw is not None:
            goal = msgspec.structs.replace(goal, yaw=math.remainder(goal.yaw, math.tau))
        robot = Robot(self._places.pose, self._plan, self._seen, self._motions)
        self._lines = self._places.known.no_go
        self._trip = Trip(request, name, goal, robot, now)
        return NO_TROUBLE

    def _plan(self, goal: Goal, now: float, avoids: bool) -> Route | NoRoute | Trouble:
        """Plan a way, around what was seen lately where it `avoids` that."""
        places, pose = self._places, self._places.pose(now)
        if (reason := places.reason(now)) or isinstance(pose, Trouble) or places.planner is None:
            return reason or (pose if isinstance(pose, Trouble) else places.no_plan)
        ends = Pose(pose.x, pose.y, pose.yaw), Pose(goal.x, goal.y, goal.yaw or 0.0)
        if self._things is None or not avoids:
            return places.planner.route(*ends, places.known.no_go)
        things, near = self._things.walls(now), self._things.walls_near(ends[0], now)
        found = places.planner.route(*ends, places.known.no_go, things + near)
        # What nobody has seen for some seconds may have gone.
        for walls in (things, self._things.walls(now, WAITS)):
            if isinstance(found, NoRoute):
                found = places.planner.route(*ends, places.known.no_go, walls)
        return found

    def _seen(self, now: float) -> tuple[float, float] | None:
        """Return where something stands before the robot, m."""
        if self._things is None or self._pose is None:
            return None
        pose = self._pose
        x, y = pose.x + _AHEAD * math.cos(pose.yaw), pose.y + _AHEAD * math.sin(pose.yaw)
        found = self._things.nearest(x, y, now)
        return found if found is not None and math.dist(found, (x, y)) <= _AHEAD else None

"""Rviz's `/goal_pose` as a motion that this service asks for and holds: if it ends, the robot stops.

Where giraff_places is there, it plans the way to a goal in `map`. To any other goal no way is planned: the robot turns
to it, drives straight, and turns as the goal has it.
"""

import math
from typing import Any, Final

from giraff_core.io import IO
from giraff_core.motion.requester import HeldMotion, MotionRequester
from giraff_core.motion.wish import OF_MOTION, OF_PLACES, RouteWish, Wish
from giraff_core.operator import RobotLink
from giraff_core.retry import RetriedRequest
from giraff_ros2.answers import Answers
from giraff_ros2.hand.publisher import OLD, PublisherClock
from giraff_ros2.port import OTHER_LIBRARY, USE_RMW_ZENOH, Received
from giraff_schemas.frames import MAP_FRAME, ODOM_FRAME
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import Odometry, Sample, Tick
from giraff_schemas.motion import GoTo, MotionState, Step, Turn
from giraff_schemas.places import FARTHEST, Goal, Places
from giraff_schemas.services import MOTION as MOTION_SERVICE
from giraff_schemas.text import printable
from giraff_schemas.topics import Query
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_NEAR: Final = 0.05  # m; a goal so near is a turn alone
_ALIGNED: Final = math.radians(1.0)
_LEVEL: Final = 0.05  # of a quaternion's x and y
_BEGINS_WITHIN: Final = 3.0
"""s after which a goal is too old to be asked for. The lease of this service's own hand ends after 1 s."""
_POSE_COUNTS: Final = 1.0  # s
_PLACES_COUNT: Final = 3.0  # s; they come once a second
AWAKE: Final = 1.0
"""s for which the process of a goal's publisher must have been awake before the goal came."""
_STOOD_STILL: Final = 0.4
"""s that this process may stand still, or its host be suspended, before a goal that waits may be an old one."""
_MOST: Final = 32  # publishers whose clocks are remembered
_TOLD_FOR: Final = 30.0
"""s for which the end of a motion is told that has not arrived."""

_STILL: Final = "giraff_ros2, its host or its link to the robot stood still, and the goal may be an old one"


class Goals:
    """One goal at a time. Times are monotonic, s."""

    def __init__(self, io: IO, by: str) -> None:
        """`by`: who asks, for people."""
        self._io, self._by = io, by
        self._holds = {asked.service: io.publisher(asked.hold) for asked in (OF_MOTION, OF_PLACES)}
        self._poses: dict[str, tuple[float, tuple[float, float, float]]] = {}  # when it was heard; x, y, yaw
        self._routes_until = -math.inf
        """s. Time until which giraff_places counts as one that can plan."""
        self._goal: tuple[str, float, float, float] | None = None  # frame, x, y, yaw
        self._given_at = -math.inf
        self._requester: MotionRequester | None = None
        self._motion: HeldMotion | None = None
        self._trouble, self._told_at = NO_TROUBLE, -math.inf
        self._now = math.inf  # of the last turn; there was none
        self._clocks: dict[bytes, PublisherClock] = {}  # by the publisher's id
        self._link = RobotLink()
        self._behind = math.inf
        """s. This host's clock minus the robot's at the newest tick. A suspended host's clock stands still."""
        self._woke_at = -math.inf

    @property
    def is_active(self) -> bool:
        """Tell whether a goal is driven to, or is about to be."""
        return self._goal is not None or self._motion is not None

    @property
    def trouble(self) -> Trouble:
        """Why the newest goal is not driven to; NO_TROUBLE: it is, or was, or there was none lately."""
        return self._trouble if self._now - self._told_at < _TOLD_FOR else NO_TROUBLE

    def on_goal(self, received: Received, answers: Answers | None, now: float) -> None:
        """Take a goal. It replaces the one before it. `answers`: of its publisher's process; None: it has no token."""
        self._notice_standstill(now)
        pose, frame = received.message.pose, received.message.header.frame_id
        at, turned = pose.position, pose.orientation
        norm = math.hypot(turned.z, turned.w)
        if not all(map(math.isfinite, (at.x, at.y, turned.x, turned.y, norm))):
            self._report("a number of it is not finite", now)
        elif max(abs(at.x), abs(at.y)) > FARTHEST:
            self._report(f"it is beyond {FARTHEST:g} m from (0, 0): goals are in metres", now)
        elif frame not in (ODOM_FRAME, MAP_FRAME):
            self._report(f"its frame is {printable(frame)!r}, and goals are in odom or map", now)
        elif max(abs(turned.x), abs(turned.y)) > _LEVEL or not 0.9 < norm < 1.1:
            self._report("its orientation is no turn on the floor", now)
        elif answers is None:
            self._report(
                f"no token has the id of its publisher, which has ended, or {OTHER_LIBRARY}", now, USE_RMW_ZENOH
            )
        elif why := self._age_fault(received, answers, now):
            self._report(f"{why}; give it again", now)
        else:
            self.cancel("another goal was given", now)
            self._trouble = NO_TROUBLE
            self._goal = frame, at.x, at.y, math.remainder(2.0 * math.atan2(turned.z, turned.w), math.tau)
            self._given_at = received.at

    def on_refused(self, trouble: Trouble, now: float) -> None:
        """Take that a sample was no goal."""
        self._trouble, self._told_at = trouble, now

    def cancel(self, why: str, now: float) -> None:
        """Let go of the goal."""
        if self._goal is not None:
            self._goal = None
            self._report(why, now)
        if self._motion is not None and not self._motion.is_cancelled:
            self._report(why, now)
            self._motion.cancel(now)

    def on_tick(self, tick: Tick, now: float) -> None:
        """Take the robot's clock."""
        newest = self._link.tick
        self._link.on_tick(tick, now)
        if self._link.tick is not newest:
            before, self._behind = self._behind, now - tick.robot_ns * 1e-9
            if before - self._behind > _STOOD_STILL and newest is not None:
                self._on_standstill(now)
        if self._requester is not None:
            self._requester.on_tick(tick, now)

    def on_sample(self, sample: Sample, now: float) -> None:
        """Take where the robot is, how the motion or route goes, and that giraff_places is there."""
        match sample:
            case Odometry():
                self._poses[ODOM_FRAME] = now, (sample.x, sample.y, sample.yaw)
            case MapPose() if sample.state in ("localized", "told"):
                self._poses[MAP_FRAME] = now, (sample.x, sample.y, sample.yaw)
            case MapPose():  # its pose is a guess
                self._poses.pop(MAP_FRAME, None)
            case Places():
                self._routes_until = now + _PLACES_COUNT
            case MotionState() if self._requester is not None:
                # A route is a state of this kind, too, and each of its legs is a motion that somebody else asked for.
                if type(sample) is self._requester.wish.asked.state.schema:
                    self._requester.on_state(sample, now)

    def turn(self, now: float, driver: str) -> None:
        """Ask, hold and end. `driver`: name of the operator that holds the lease; empty: none."""
        self._notice_standstill(now)
        self._now = now
        if self._motion is not None:
            self._go_on(self._motion, now)
        elif self._goal is not None:
            self._begin(*self._goal, now, driver)

    def _notice_standstill(self, now: float) -> None:
        """Notice by the time since the last turn that this process was frozen."""
        if now - self._now > _STOOD_STILL:
            self._on_standstill(now)

    def _on_standstill(self, now: float) -> None:
        """Drop a goal that has waited meanwhile, and refuse others for a while."""
        self._woke_at = now
        is_asked = self._motion is not None and self._motion.has_asked
        if self.is_active and not is_asked:
            self._goal = self._requester = self._motion = None
            self._report(f"{_STILL}; give it again", now)

    def _age_fault(self, received: Received, answers: Answers, now: float) -> str:
        """Return why nobody knows that a goal was given just now; empty: it was.

        The publisher's clock tells that a goal is later than others. It says nothing of the first one, nor of a click
        that a frozen process publishes when it wakes, with the time of then. Its answers do.
        """
        if received.gid not in self._clocks and len(self._clocks) >= _MOST:
            del self._clocks[next(iter(self._clocks))]
        clock = self._clocks.setdefault(received.gid, PublisherClock())
        if clock.lateness(received.sent_ns, received.at) > OLD:
            return f"it is more than {OLD:g} s older than those before it, or the clock of its host was set back"
        if now - self._woke_at < AWAKE:
            return _STILL
        if math.isinf(answers.newest):
            return "its process answers no question, as those of rmw_zenoh do, and nobody knows how old it is"
        if received.at - answers.prompt_since(received.at) < AWAKE:
            return f"its process has not been seen awake for {AWAKE:g} s without a break, and it may be an old one"
        return "the robot is not heard" if self._link.link_fault(now) else ""

    def _is_late(self, now: float) -> bool:
        """Return whether the newest goal is too old to be asked for: nobody expects the robot to move by it."""
        return now - self._given_at > _BEGINS_WITHIN

    def _begin(self, frame: str, x: float, y: float, yaw: float, now: float, driver: str) -> None:
        is_free = driver in ("", MOTION_SERVICE.name)
        if self._is_late(now):
            self.cancel("it could not begin in time; give it again" if is_free else f"{driver} drives", now)
        if self._goal is None or not is_free:
            return
        heard, pose = self._poses.get(frame, (-math.inf, (0.0, 0.0, 0.0)))
        if now - heard > _POSE_COUNTS:
            self.cancel(f"nobody knows where the robot is in {frame}", now)
            return
        self._goal = None
        if steps := _steps(pose, frame, x, y, yaw):
            has_route = frame == MAP_FRAME and now < self._routes_until
            wish = RouteWish(Goal(x=x, y=y, yaw=yaw)) if has_route else Wish(steps)
            self._requester = MotionRequester(self._io.token(), wish, self._by, self._io.instance)
            self._motion = HeldMotion(self._requester, self._ask, self._holds[wish.asked.service].put)

    def _ask(self, query: Query[Any, Any], request: Any) -> RetriedRequest[Any]:
        return self._io.ask(query, request, lambda _: True)

    def _go_on(self, motion: HeldMotion, now: float) -> None:
        if not (motion.has_asked or motion.is_cancelled) and self._is_late(now):
            self._requester = self._motion = None
            self._report("the robot is not heard; give it again", now)
        elif (result := motion.turn(now)) is not None:
            self._requester = self._motion = None
            if not (result.arrived or motion.is_cancelled):
                self._report(result.reason, now)

    def _report(self, why: str, now: float, remedy: str = "give another goal when that is over") -> None:
        self._trouble, self._told_at = Trouble(f"/goal_pose is not driven to: {why}", remedy), now


def _steps(pose: tuple[float, float, float], frame: str, x: float, y: float, yaw: float) -> tuple[Step, ...]:
    """Return the way from a pose to a goal, both in `frame`; m and rad. Empty: it is there."""
    ahead_x, ahead_y, heading = x - pose[0], y - pose[1], pose[2]
    steps: list[Step] = []
    if math.hypot(ahead_x, ahead_y) >= _NEAR:
        steps.append(GoTo(x=x, y=y, frame="map" if frame == MAP_FRAME else "odom"))
        heading = math.atan2(ahead_y, ahead_x)
    angle = math.remainder(yaw - heading, math.tau)
    if abs(angle) >= _ALIGNED:
        steps.append(Turn(angle=angle))
    return tuple(steps)

"""One route, driven leg by leg, from its request to its end. No I/O and no clock.

Each leg is a motion that is asked of giraff_motion as anybody asks for one. It is held with the ticks that the route's
own requester has sent, and with no other: a requester that is gone stops the robot as a hand that is gone does. The
guard alone decides what is safe.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Final

import msgspec

from giraff_core.kinematics.differential_drive import CREEP
from giraff_core.kinematics.pose import Pose
from giraff_core.motion.requester import HeldMotion, MotionRequester
from giraff_core.motion.wish import Wish
from giraff_core.operator import LINK_SILENCE
from giraff_places.driving.arrival import AT_GOAL, NEAR, Off, is_doubtful
from giraff_places.driving.progress import Progress
from giraff_places.driving.robot import Robot
from giraff_places.route.planner import NoRoute, Route
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import EStop, RobotTime, Tick
from giraff_schemas.motion import NOWHERE, Displacement, GoTo, MotionHold, MotionState, Outcome, Stage, Step, Turn
from giraff_schemas.places import NO_ROUTE, Goal, PlacesGo, RouteState
from giraff_schemas.services import MOTION
from giraff_schemas.text import brief
from giraff_schemas.trouble import NO_TROUBLE, Trouble

WAITS: Final = 5.0
"""s before another way is planned: a person may step aside."""
TRIES: Final = 5
"""Ways that are planned anew on one route."""
ANNOUNCES: Final = 1.0
"""s for which it says that it goes on, before it does."""
CAREFUL: Final = 0.3
"""m at creep after a wait."""
_CREEP_TURN: Final = 0.35
"""rad/s; the guard's own creep, unless somebody has set it lower."""
_HELD_WITHIN: Final = 1.0
"""s from the acceptance to the requester's first hold."""
_SETTLES: Final = 1.0
"""s at rest at the goal, until localization has caught up."""
_UNSURE: Final = 0.25
"""m, standard deviation from which it creeps."""
_SILENT: Final = 1.0
"""s without a word of localization after which no leg and no turn goes on."""
_BEYOND: Final = 0.5
"""m that the wheels may have rolled beyond the length of a leg."""
_IDLE: Final = 5
"""Legs that may bring it no nearer to its goal."""
_CORRECTIONS: Final = 2
_LEAST_LEG: Final = 0.03
"""m"""
_LONGEST_NAME: Final = 100
_LONGEST_LEG: Final = 600.0
"""s; the robot is given up when it is stuck, long before."""

_NOT_HELD: Final = Trouble("who asked for it does not say any more that it is wished", "check its link and its program")
_GOES_ON: Final = Trouble("it goes on slowly in a second")
_LOOKS: Final = "in a second it turns round once, to see where it is"
_NO_POSE: Final = Trouble("no pose on the map is heard any more", "check giraff_localization")
_SEES: Final = Trouble("it turns round, to see where it is")
_STOPPED: Final = Trouble("the robot comes no nearer", "see what holds it, or what its sensors see")
_NOT_THERE: Final = Trouble(
    "it cannot be told where on the map the robot has stopped", "say where it is", "run", "giraff localize --at X,Y,YAW"
)
_LIKE_MOTION: Final[dict[str, Outcome]] = {
    "cancelled": "cancelled",
    "lost_lease": "lost_lease",
    "lost_requester": "lost_requester",
    "lost_odometry": "lost_odometry",
}


class Trip:
    """Times are s of any one monotonic clock."""

    def __init__(self, request: PlacesGo, place: str, goal: Goal, robot: Robot, now: float) -> None:
        self.id = request.id
        self.by = brief(request.by, _LONGEST_NAME)
        self.stage: Stage = "arming"
        self.outcome: Outcome = ""
        self.reason = NO_TROUBLE
        self.at: tuple[float, float] | None = None
        """m, in `map`; of what is in the way, or where it has ended."""
        self._owner = request.instance
        self._place, self._goal, self._robot = place, goal, robot
        self._began = self._ended_at = now
        self._held_at: float | None = None
        self._held: RobotTime | None = None
        """Tick of the newest hold."""
        self._corners: tuple[tuple[float, float], ...] = ()
        self._way = self._length = 0.0
        self._legs = 0
        self._requester: MotionRequester | None = None
        self._motion: HeldMotion | None = None
        self._next: Callable[[float], None] | None = self._begin
        """Step to do at `_due`, while no motion goes on."""
        self._due = now
        self._done: Callable[[float], None] = self._plan
        """Step to do when the motion has arrived."""
        self._tries = self._corrections = self._idle = 0
        self._shortest = math.inf
        """m; of what was left of the way."""
        self._careful = self._leg = 0.0
        """m still to go at creep, and m of this leg."""
        self._has_looked = False
        self._progress = Progress(now)
        self._stuck = NO_TROUBLE
        """Cause, where a motion was ended because the robot came nowhere."""
        self._words = NO_TROUBLE
        self._pose: MapPose | None = None
        self._heard_at = now
        """Moment when localization was last heard, whatever it knew."""

    @property
    def goes_on(self) -> bool:
        """Tell whether it has not ended."""
        return not self.outcome

    def on_hold(self, hold: MotionHold, now: float) -> None:
        """Take that the requester still wishes it. Its tick is passed on as it is, and never a newer one."""
        old, new = self._held, hold.tick
        is_newer = old is None or old.epoch != new.epoch or old.robot_ns < new.robot_ns
        if self.outcome or hold.id != self.id or hold.instance != self._owner or not is_newer:
            return
        self._held_at, self._held = now, new
        if self._requester is not None:
            self._requester.on_tick(Tick(epoch=hold.tick.epoch, robot_ns=hold.tick.robot_ns), now)

    def on_pose(self, now: float) -> None:
        """Take that localization speaks."""
        self._heard_at = now

    def on_state(self, state: MotionState, now: float) -> None:
        """Take how the motion goes. Another's, while it waits, has ended it: the robot is elsewhere then."""
        if self._requester is not None:
            self._requester.on_state(state, now)
        elif state.stage in {"arming", "moving"}:
            self._end("lost_lease", Trouble(f"a motion of {state.by} goes on", "ask again when it has ended"), now)

    def hold_up(self, why: Trouble, now: float) -> None:
        """Have it stand, and plan anew after a wait."""
        if self._motion is not None and self.goes_on and not self._stuck:
            self._stuck = why
            self._motion.cancel(now)

    def end_for(self, why: Trouble, now: float) -> None:
        """End it: its plan or its places do not count any more."""
        self._end("disarmed", why, now)

    def cancel(self, by: str, now: float) -> None:
        """End it, whoever asks for it."""
        self._end("cancelled", Trouble(f"cancelled by {brief(by, _LONGEST_NAME)}"), now)

    def on_lease(self, driver: str, now: float) -> None:
        """Take who drives. Whoever has taken the robot while it waits has ended it."""
        if self._motion is None and driver not in ("", MOTION.name):
            self._end("lost_lease", Trouble(f"{driver} drives", "ask again when it rests"), now)

    def on_estop(self, estop: EStop, now: float) -> None:
        """Take a stop: its release must not have the robot go on."""
        if estop.engaged:
            self._end("disarmed", estop.reason.of(f"emergency stop, engaged by {estop.by}"), now)

    def turn(self, now: float) -> None:
        """Do what is due."""
        if isinstance(pose := self._robot.pose(now), MapPose):
            self._pose = pose
        if self._is_let_go(now):
            self._end("lost_requester", _NOT_HELD, now)
        if self._motion is not None and now - self._heard_at > _SILENT:
            self._end("lost_localization", _NO_POSE, now)
        if self._motion is not None:
            self._follow(self._motion, now)
        elif self.goes_on and self._next is not None and now >= self._due and self._held_at is not None:
            self._next(now)
        if self.outcome and self._motion is None:
            self.stage = "ended"

    def state(self, now: float) -> RouteState:
        """Return it as it is told."""
        pose, way = self._pose, self._way + self._come
        return msgspec.structs.replace(
            NO_ROUTE,
            id=self.id,
            by=self.by,
            stage=self.stage,
            step=self._legs,
            steps=self._legs + max(0, len(self._corners) - 2),
            asked=_path(self._way + self._length),
            achieved=_path(min(way, self._way + self._length)),
            covariance=NO_ROUTE.covariance if pose is None else pose.covariance,
            elapsed=(now if self.goes_on else self._ended_at) - self._began,
            outcome=self.outcome,
            reason=self.reason,
            place=self._place,
            goal=self._goal,
            corners=self._corners,
            at=self.at,
        )

    def _is_let_go(self, now: float) -> bool:
        """Tell whether the requester is silent."""
        since, most = (self._began, _HELD_WITHIN) if self._held_at is None else (self._held_at, LINK_SILENCE)
        return now - since > most

    @property
    def _come(self) -> float:
        """m that the robot has come on this leg."""
        return math.dist(self._corners[0], (self._pose.x, self._pose.y)) if self._corners and self._pose else 0.0

    def _begin(self, now: float) -> None:
        """Turn round first where somebody has said where it is: the sensors confirm it then, or contradict it."""
        pose, found = self._robot.pose(now), self._robot.plan(self._goal, now, False)
        if isinstance(pose, MapPose) and pose.state == "told" and isinstance(found, Route):
            self._ask(Turn(angle=math.tau), self._plan, now, _SEES)
        else:
            self._plan(now)

    def _plan(self, now: float) -> None:
        """Plan the way from here, and go its first leg, or wait."""
        pose = self._robot.pose(now)
        if isinstance(pose, Trouble):
            self._look_round(pose, now)
            return
        was_blocked = self._tries > 0 and self.stage == "waiting"
        found = self._robot.plan(self._goal, now, True)
        if isinstance(found, NoRoute) and not was_blocked:  # what stands there may be gone when the robot comes
            found = self._robot.plan(self._goal, now, False)
        if isinstance(found, Trouble):
            self._end("lost_localization", found, now)
        elif isinstance(found, NoRoute) and was_blocked:
            self._wait(Trouble(f"no other way: {found.trouble.what}", found.trouble.remedy), self.at, now)
        elif isinstance(found, NoRoute):
            self.at = found.x, found.y
            self._end(found.reason, found.trouble, now)
        else:
            self._way += self._come
            self._corners, self._length = found.corners, found.length
            self._idle = 0 if self._length < self._shortest - _LEAST_LEG else self._idle + 1
            self._shortest = min(self._shortest, self._length)
            if was_blocked and self._is_at_goal:
                self._corrections = _CORRECTIONS
                self._announce(self._turn_at_goal, _GOES_ON, now)
            elif was_blocked:
                self._announce(self._go_leg, _GOES_ON, now)
            elif self._idle > _IDLE:
                self._wait(_STOPPED, self._in_the_way(now), now)
            else:
                self._go_leg(now)

    def _announce(self, step: Callable[[float], None], words: Trouble, now: float) -> None:
        """Move by a step that is said before it is done, and slowly at first."""
        self._careful, self._leg = CAREFUL, 0.0
        self.stage, self.reason = "waiting", words
        self._next, self._due = step, now + ANNOUNCES

    def _go_leg(self, now: float) -> None:
        pose = self._robot.pose(now)
        if isinstance(pose, Trouble):
            self._look_round(pose, now)
            return
        here, (x, y) = Pose(pose.x, pose.y, pose.yaw), self._corners[min(1, len(self._corners) - 1)]
        if (far := math.dist((here.x, here.y), (x, y))) <= _LEAST_LEG:
            self._turn_at_goal(now) if len(self._corners) <= 2 else self._plan_on(now)
            return
        part = 1.0 if self._careful <= 0.0 else min(1.0, self._careful / far)
        self._leg = part * far
        step = GoTo(x=here.x + part * (x - here.x), y=here.y + part * (y - here.y), frame="map")
        is_last = len(self._corners) <= 2 and part == 1.0
        self._ask(step, self._turn_at_goal if is_last else self._plan_on, now)

    def _plan_on(self, now: float) -> None:
        """Go on from the end of a leg."""
        self._careful, self._leg = self._careful - self._leg, 0.0
        if self._careful < _LEAST_LEG:
            self._careful = 0.0
        self._plan(now)

    def _turn_at_goal(self, now: float) -> None:
        pose = self._robot.pose(now)
        if isinstance(pose, Trouble) or abs(turn := Off.of(pose, self._goal).turn) < NEAR.turn:
            self._settle(now)
        else:
            self._ask(Turn(angle=turn), self._settle, now)

    def _settle(self, now: float) -> None:
        self._next, self._due = self._judge, now + _SETTLES

    def _judge(self, now: float) -> None:
        """Tell whether it is there, once localization has caught up."""
        pose = self._robot.pose(now)
        if isinstance(pose, Trouble) or is_doubtful(pose, has_looked=self._has_looked):
            self._look_round(pose if isinstance(pose, Trouble) else _NOT_THERE, now)
            return
        off = Off.of(pose, self._goal)
        if not off.is_within(NEAR) and self._corrections < _CORRECTIONS:
            self._corrections += 1
            self._plan(now)
        elif off.is_within(AT_GOAL):
            self._end("arrived", NO_TROUBLE, now)
        else:
            self._end("lost_localization", _NOT_THERE, now)

    def _look_round(self, why: Trouble, now: float) -> None:
        """Turn round once, so that localization sees more: then go on, or end."""
        if self._has_looked or now - self._heard_at > _SILENT:
            self._end("lost_localization", why, now)
            return
        self._has_looked = True
        self._announce(
            partial(self._ask, Turn(angle=math.tau), self._plan_on, words=_SEES), Trouble(f"{why.what}: {_LOOKS}"), now
        )

    def _ask(self, step: Step, done: Callable[[float], None], now: float, words: Trouble = NO_TROUBLE) -> None:
        """Ask for one motion. `words`: told meanwhile."""
        self._words = words
        creeps = self._careful > 0.0 or self._is_unsure
        wish = Wish(
            (step,), CREEP if creeps else None, _CREEP_TURN if self._careful > 0.0 else None, time_limit=_LONGEST_LEG
        )
        motions = self._robot.motions
        self._requester = MotionRequester(motions.token(), wish, self.by, motions.instance)
        self._motion = HeldMotion(self._requester, motions.ask, motions.hold)
        self._done, self._stuck = done, NO_TROUBLE
        self._leg = self._leg if isinstance(step, GoTo) else 0.0
        self._progress = Progress(now)
        self._legs += isinstance(step, GoTo)
        self.stage, self.reason, self.at = "moving", NO_TROUBLE, None

    @property
    def _is_at_goal(self) -> bool:
        """Whether it stands so near the goal that it need not come nearer."""
        return self._pose is not None and Off.of(self._pose, self._goal).metres <= AT_GOAL.metres

    @property
    def _is_unsure(self) -> bool:
        return self._pose is not None and max(self._pose.standard_deviations[:2]) > _UNSURE

    def _follow(self, motion: HeldMotion, now: float) -> None:
        """Have the motion go on, and go by its end."""
        result = motion.turn(now)
        if result is None:
            state = None if self._requester is None else self._requester.state
            if self.goes_on:
                self.reason = self._words if state is None else state.reason or self._words
            is_over = state is not None and (
                self._progress.is_over(state.achieved, now) or state.achieved.path > self._leg + _BEYOND
            )
            if self.goes_on and not self._stuck and is_over:
                self.hold_up(self.reason or _STOPPED, now)
            return
        self._motion = self._requester = None
        if not self.goes_on:
            return
        why = self._stuck or Trouble(result.reason)
        match "blocked" if self._stuck and not result.arrived else result.outcome:
            case "arrived":
                self._done(now)
            case "blocked" | "time_limit":
                self._wait(why, self._in_the_way(now), now)
            case "lost_localization":
                self._look_round(why, now)
            case "lost_robot":  # it is heard by the requester's ticks alone
                self._end("lost_requester", _NOT_HELD, now)
            case ending:
                self._end(_LIKE_MOTION.get(ending, "disarmed"), why, now)

    def _in_the_way(self, now: float) -> tuple[float, float] | None:
        here = None if self._pose is None else (self._pose.x, self._pose.y)
        return self._robot.seen(now) or here

    def _wait(self, why: Trouble, at: tuple[float, float] | None, now: float) -> None:
        """Wait for what is in the way to go, then plan anew; the last time, end."""
        self.at = at
        if self._tries >= TRIES:
            self._end("blocked", why, now)
            return
        self._tries += 1
        self.stage, self.reason = "waiting", why
        self._next, self._due = self._plan, now + WAITS

    def _end(self, outcome: Outcome, reason: Trouble, now: float) -> None:
        """For good; the motion is ended, too."""
        if self.outcome:
            return
        self.outcome, self.reason, self._ended_at, self.stage = outcome, reason, now, "stopping"
        self._next = None
        if self.at is None and self._pose is not None:
            self.at = self._pose.x, self._pose.y
        if self._motion is not None:
            self._motion.cancel(now)


def _path(metres: float) -> Displacement:
    return msgspec.structs.replace(NOWHERE, path=metres)

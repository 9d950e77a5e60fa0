"""A giraff_places that drives a robot in simulated time, with a giraff_motion that does as a test has it."""

import math
from collections.abc import Callable
from typing import Any, Final, Literal, NamedTuple

import msgspec

from giraff_core.kinematics.pose import Pose
from giraff_core.retry import RetriedRequest
from giraff_maps.floor_plan import FloorPlan
from giraff_places.driving.driving import Driving
from giraff_places.driving.robot import Motions
from giraff_places.policy import PlacesPolicy, PlanFile
from giraff_schemas.codec import stamped
from giraff_schemas.localization import LocalizationState
from giraff_schemas.messages import EStop, Lease, Range, RobotTime, Tick
from giraff_schemas.motion import (
    NOWHERE,
    Displacement,
    GoTo,
    MotionAnswer,
    MotionCancel,
    MotionGo,
    MotionHold,
    MotionState,
    Outcome,
    Stage,
    Step,
    Turn,
)
from giraff_schemas.places import Goal, PlacesGo, RouteState
from giraff_schemas.topics import MOTION_GO, Query
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from tests.support.map_poses import map_pose
from tests.support.robots import ROBOT
from tests.unit.places.homes import walls_of

OUTER: Final = ((0.0, 0.0, 6.0, 0.0), (6.0, 0.0, 6.0, 4.0), (6.0, 4.0, 0.0, 4.0), (0.0, 4.0, 0.0, 0.0))
HOUSE: Final = FloorPlan("home", (*OUTER, (3.0, 0.0, 3.0, 2.6)))
"""A wall stands between the left and the right half; the way leads round its upper end."""
START: Final = Pose(1.0, 1.0, 0.0)
FAR: Final = Goal(x=5.0, y=1.0)
"""Beyond the wall."""
NEAR: Final = Goal(x=1.0, y=3.0)
"""Straight ahead, after a turn."""
ME: Final = "mine"
"""Instance of the requester."""
MINE: Final = 5
"""Id of its request."""
STEP: Final = 0.02
"""s"""
TAKES: Final = 0.4
"""s that each motion takes."""
LAG: Final = 5
"""Ticks of the robot by which the requester's are older than those that giraff_places hears."""
_EPOCH: Final = 7
_SENSED: Final = 5
"""Steps between two samples of a sense."""

End = Outcome | Literal["refused", "unheard", "stuck"]
"""End of a motion. `refused`: it is not begun; `unheard`: no state of it is told; `stuck`: the robot does not move;
empty: it goes on."""


class Asked(NamedTuple):
    """A motion that was asked for."""

    at: float
    """s"""
    go: MotionGo

    @property
    def step(self) -> Step:
        (step,) = self.go.steps
        return step

    @property
    def creeps(self) -> bool:
        """Whether it is as slow as the guard's own creep."""
        return (self.go.speed, self.go.turn_speed) == (0.1, 0.35)


class _Answered(RetriedRequest[MotionAnswer]):
    """Request that is answered at once."""

    def __init__(self, answer: Callable[[], MotionAnswer]) -> None:
        super().__init__(lambda _: True)
        self._answer = answer

    def _attempt(self) -> None:
        self.on_answer(self._answer())


class Ride:
    """A robot in a house, one requester, and what was asked of giraff_motion."""

    def __init__(self, *ends: End, plan: FloorPlan | Trouble = HOUSE, start: Pose = START) -> None:
        """`ends`: of the motions, one after the other. Those after the last arrive."""
        self.now = 100.0
        self.pose: Pose = start
        self.explained = 0.9
        """Share of the readings that localization's place explains."""
        self.spread = 0.05
        """m and rad; standard deviations of localization."""
        self.slip = Pose(0.0, 0.0, 0.0)
        """Place where a motion ends, seen from its goal."""
        self.state: LocalizationState = "localized"
        self.stays = False
        """Each motion that arrives leaves the robot where it is."""
        self.is_located = True
        """Localization speaks."""
        self.rolls = 1.0
        """m of way that the wheels count in each second."""
        self.driver = ""
        """Name of the operator that has taken the robot."""
        self.holds: Callable[[MotionHold], MotionHold] | None = lambda hold: hold
        """Changes what the requester says; None: it is silent."""
        self.senses: list[Range] = []
        """Samples that come with each pose."""
        self.asked: list[Asked] = []
        self.held: list[tuple[RobotTime, RobotTime | None]] = []
        """Ticks of the holds that giraff_motion got, each with the requester's newest."""
        self.cancelled: list[MotionCancel] = []
        self.told: list[tuple[float, RouteState]] = []
        """States of the route, one each step, with s."""
        self.policy = PlacesPolicy(plan if isinstance(plan, Trouble) else PlanFile(plan, "home.toml"), ROBOT)
        if isinstance(plan, FloorPlan):
            self.policy.on_map(walls_of(plan))
        self.driving = Driving(self.policy, ROBOT, Motions(self._ask, self._on_hold, self._token, "places"))
        self._ends = list(ends)
        self._end: End = ""
        self._motion: MotionState | None = None
        self._steps = 0
        self._sent: RobotTime | None = None
        self.run(0.2)

    @property
    def route(self) -> RouteState:
        """State of the route, as it was told last."""
        return self.told[-1][1]

    def go(self, goal: str | Goal = FAR, id_: int = MINE, age: float = 0.0) -> MotionAnswer:
        """Ask for a route, with a tick that is so many s old."""
        return self.driving.on_request(
            PlacesGo(by="me", id=id_, instance=ME, tick=self._tick(round(age / STEP)), goal=goal), self.now
        )

    def begin(self, goal: str | Goal = FAR) -> None:
        """Ask for a route that is accepted."""
        assert self.go(goal).accepted

    def run(self, seconds: float) -> None:
        """Let time pass."""
        for _ in range(round(seconds / STEP)):
            self._turn()

    def until(self, reached: Callable[[], bool], within: float = 120.0) -> None:
        """Let time pass until something holds."""
        for _ in range(round(within / STEP)):
            if reached():
                return
            self._turn()
        raise AssertionError(self.route)

    def end(self, within: float = 120.0) -> RouteState:
        """Let time pass until the route has ended, and then some more: nothing may be asked of motion any more."""
        self.until(lambda: self.route.stage == "ended", within)
        asked = len(self.asked)
        self.run(8.0)
        assert len(self.asked) == asked
        return self.route

    def until_waiting(self, announced: bool = False) -> None:
        """Let time pass until it waits, or until it says that it goes on."""
        words = "in a second" if announced else ""
        self.until(lambda: self.route.stage == "waiting" and words in str(self.route.reason))

    def announced(self, asked: Asked) -> float:
        """Return s for which it had said that it goes on, before a motion was asked for."""
        last = max((each.at for each in self.asked if each.at < asked.at), default=0.0)
        says = (at for at, told in self.told if last < at < asked.at and "in a second" in str(told.reason))
        return asked.at - min(says, default=asked.at)

    def stop(self, engaged: bool = True) -> None:
        """Engage the emergency stop, or release it."""
        self.driving.on_estop(EStop(engaged=engaged, id=1, by="me", reason=Trouble("pressed")), self.now)

    def _turn(self) -> None:
        self._steps += 1
        self.now += STEP
        driving = self.driving
        self._move()
        pose = stamped(map_pose(self.pose, Pose(0.0, 0.0, 0.0), None, self.state), self._steps, 0, "a")
        variance = self.spread * self.spread
        pose = msgspec.structs.replace(
            pose, covariance=(variance, 0.0, 0.0, variance, 0.0, variance), explained=self.explained
        )
        if self.is_located:
            self.policy.on_pose(pose, self.now)
            driving.on_pose(pose, self.now)
        driving.on_tick(Tick(epoch=_EPOCH, robot_ns=self._tick().robot_ns), self.now)
        driver = self.driver or ("motion" if self._moves else "")
        driving.on_lease(Lease(holder="x", operator=driver, counter=1), self.now)
        if self._motion is not None and self._end != "unheard":
            driving.on_state(self._motion, self.now)
        for sample in self.senses if self._steps % _SENSED == 0 else ():
            driving.on_sample(sample, self.now)
        if self.holds is not None and self._steps % 2 == 0:
            self._sent = self._tick(LAG)
            hold = stamped(MotionHold(id=MINE, tick=self._sent), self._steps, 0, ME)
            driving.on_hold(self.holds(hold), self.now)
        driving.turn(self.now)
        self.told.append((self.now, driving.state(self.now)))

    def _tick(self, before: int = 0) -> RobotTime:
        return RobotTime(epoch=_EPOCH, robot_ns=10**12 + (self._steps - before) * 20_000_000)

    def _token(self) -> int:
        return 1000 + len(self.asked)

    def _ask(self, query: Query[Any, Any], request: Any) -> RetriedRequest[Any]:
        if query is not MOTION_GO:
            return _Answered(lambda: self._cancel(request))
        self.asked.append(Asked(self.now, request))
        self._end = self._ends.pop(0) if self._ends else "arrived"
        refused = self._end == "refused"
        if not refused:
            self._motion = stamped(_state_of(request), 0, 0, "motion")
        return _Answered(lambda: MotionAnswer(accepted=not refused, reason=Trouble("unfit" if refused else "")))

    def _cancel(self, request: MotionCancel) -> MotionAnswer:
        self.cancelled.append(request)
        if self._moves:
            self._change("ended", "cancelled")
        return MotionAnswer(accepted=True)

    def _on_hold(self, hold: MotionHold) -> None:
        self.held.append((hold.tick, self._sent))

    @property
    def _moves(self) -> bool:
        return self._motion is not None and self._motion.stage != "ended"

    def _move(self) -> None:
        """Have the motion go on."""
        if self._moves:
            since = self.now - self.asked[-1].at
            match self._end:
                case "" | "refused" | "stuck" | "unheard":
                    is_over = False
                case outcome:
                    if is_over := since >= TAKES:
                        self._change("ended", outcome)
            if is_over and self._end == "arrived" and not self.stays:
                self._arrive(self.asked[-1].step)
            elif not is_over:
                self._change("moving", "", 0.0 if self._end == "stuck" else self.rolls * since)

    def _change(self, stage: Stage, outcome: Outcome, path: float = 0.0) -> None:
        """Have the motion be at a stage. `path`: m that it has come."""
        assert self._motion is not None
        self._motion = msgspec.structs.replace(
            self._motion,
            seq=self._motion.seq + 1,
            stage=stage,
            outcome=outcome,
            achieved=Displacement(path=path, x=0.0, y=0.0, yaw=0.0),
            reason=NO_TROUBLE if outcome in ("", "arrived") else Trouble(f"motion says {outcome}"),
        )

    def _arrive(self, step: Step) -> None:
        x, y, yaw = self.pose
        match step:
            case GoTo():
                self.pose = self.slip.placed_in(Pose(step.x, step.y, math.atan2(step.y - y, step.x - x)))
            case Turn():
                self.pose = Pose(x, y, math.remainder(yaw + step.angle + self.slip.yaw, math.tau))
            case _:
                raise AssertionError(step)


def _state_of(go: MotionGo) -> MotionState:
    return MotionState(
        id=go.id,
        by=go.by,
        stage="arming",
        step=1,
        steps=1,
        asked=NOWHERE,
        achieved=NOWHERE,
        covariance=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        elapsed=0.0,
        time_limit=0.0,
        outcome="",
        sensor="",
    )

"""What giraff_motion decides: whom it obeys, when it moves, and why it ends. No I/O and no clock.

It is an operator whose hand is the requester's: each command carries the tick that the requester has sent last, and no
newer one. A requester that is gone stops the robot as a hand that is gone does, whatever goes on here.
"""

import math
from typing import Final

from giraff_core.live import Live
from giraff_core.motion.timely import AHEAD, WISH_COUNTS, AnswersOnce, age_of, untimely
from giraff_core.operator import LEVEL, Fault, Hand, Operator, Wish
from giraff_core.robot import RobotConfig
from giraff_motion.config import MotionConfig
from giraff_motion.driver import STANDS
from giraff_motion.goal import Goal
from giraff_motion.localized import Localized, is_in_map
from giraff_motion.pilot import Pilot
from giraff_schemas.localization import MapPose, MapWalls
from giraff_schemas.messages import BaseState, EStop, GuardState, Lease, Odometry, RobotTime
from giraff_schemas.motion import (
    IDLE,
    MotionAnswer,
    MotionCancel,
    MotionHold,
    MotionRequest,
    MotionState,
    Outcome,
    steps_of,
)
from giraff_schemas.services import MOTION
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_HOLD_COUNTS: Final = 0.4
"""s after which the requester's last word counts for nothing: no operator's does."""
_ODOMETRY_COUNTS: Final = 0.3
"""s"""
_STATES_COUNT: Final = 1.0
"""s; guard and base tell their state ten times a second."""
_ARMS_WITHIN: Final = 2.5
"""s"""
_LAST_WORDS: Final = 0.3
"""s for which it says that it has let go: one word may be lost."""

_NO_GUARD: Final = Trouble("the guard is not heard", "check that giraff_guard runs on base's machine")
_NO_BASE: Final = Trouble("base is not heard", "check that giraff_base runs")
_NO_ODOMETRY: Final = Trouble("odometry is not heard", "check that giraff_odometry runs")
_JUMPED: Final = Trouble("the pose was set while it moved, or board or odometry began anew", "ask again")
_NO_REQUESTER: Final = Trouble(
    f"who asked for it has not said for {_HOLD_COUNTS:g} s that it is still wished", "check its link and its program"
)


class MotionPolicy(Hand):
    """One motion at a time. Times are seconds of any one monotonic clock."""

    def __init__(self, live: Live[MotionConfig], robot: RobotConfig, instance: str) -> None:
        super().__init__(Operator(MOTION.name, instance, asks_from_start=False))
        self._localized = Localized()
        self._pilot = Pilot(live, robot, self._localized)
        self._answers = AnswersOnce()
        self._odometry: Odometry | None = None
        self._base: tuple[BaseState | None, float] = None, -math.inf
        self._guard: tuple[GuardState | None, float] = None, -math.inf
        self._estop: EStop | None = None
        self._told_who_drives = -math.inf
        self._motion: Goal | None = None
        """The one that goes on, or the last one."""
        self._told: tuple[object, ...] = ()

    def on_lease(self, lease: Lease, now: float) -> None:
        """Take what the guard says of who drives."""
        self.operator.on_lease(lease)
        self._told_who_drives = now

    def on_base(self, base: BaseState, now: float) -> None:
        """Take whether the robot is armed."""
        self._base = base, now

    def on_estop(self, estop: EStop) -> None:
        """Take whether the robot is stopped: what is asked for meanwhile must not begin with its release."""
        self._estop = estop

    def on_guard(self, guard: GuardState, now: float) -> None:
        """Take which ways are free."""
        self._guard = guard, now

    def on_hold(self, hold: MotionHold) -> None:
        """Take that who has asked still wishes it."""
        motion = self._going_on
        if motion is not None and hold.id == motion.id and -AHEAD <= self._age(hold.tick) <= _HOLD_COUNTS:
            motion.hold(hold.tick, hold.instance)

    def on_odometry(self, odometry: Odometry, now: float) -> None:
        """Take where the robot is."""
        last, self._odometry = self._odometry, odometry
        self._localized.hear_odometry(odometry)
        motion = self._motion
        if motion is None or last is None:
            return
        if odometry.segment == last.segment and odometry.boot_id == last.boot_id:
            motion.add(odometry, now)
        elif motion.goes_on:
            motion.end("lost_odometry", _JUMPED, now)

    def on_pose(self, pose: MapPose, now: float) -> None:
        """Take where the robot is on the map."""
        self._localized.on_pose(pose, now)

    def on_map(self, plan: MapWalls) -> None:
        """Take the floor plan, and where on it the robot can stand."""
        self._localized.hear_map(plan)

    def on_request(self, request: MotionRequest, now: float) -> MotionAnswer:
        """Begin a motion, or say why not. Asked again, it is the answer of the first time."""
        return self._answers.answer(request.id, lambda: self._begin(request, now))

    def on_cancel(self, request: MotionCancel, now: float) -> MotionAnswer:
        """Stop at once, whoever asks for it."""
        motion = self._going_on
        if motion is None or request.id not in (0, motion.id):
            return MotionAnswer(accepted=False, reason=Trouble("no such motion goes on"))
        motion.end("cancelled", Trouble(f"cancelled by {request.by}"), now)
        return MotionAnswer(accepted=True)

    def poll(self, now: float) -> Wish | Fault | None:
        """What to say next, fifty times a second; None: this operator has nothing to say."""
        motion = self._motion
        if motion is None:
            return None
        if motion.goes_on:
            self._review(motion, now)
        if not motion.goes_on:
            motion.settle(now)
        if motion.tick is None or (not motion.goes_on and now - motion.ended_at > _LAST_WORDS):
            return None
        if not motion.goes_on:
            return Fault(Trouble(f"its motion has ended: {motion.outcome}", "ask for the next"), motion.tick)
        linear_x, angular_z = self._twist(motion, now)
        # Who merely waits takes the robot from nobody: it asks while nobody has it, and with a command that is neutral.
        wishes = motion.stage == "arming" and not self.operator.holder
        return Wish(linear_x, angular_z, motion.tick, takes=wishes)

    def has_news(self) -> bool:
        """Whether the state has become another than the one that was told."""
        motion = self._motion
        return motion is not None and self._told != motion.news

    def state(self, now: float) -> MotionState:
        """How it goes on, or how the last one ended."""
        motion = self._motion
        if motion is None:
            return IDLE
        self._told = motion.news
        return motion.state(now)

    @property
    def _going_on(self) -> Goal | None:
        return self._motion if self._motion is not None and self._motion.goes_on else None

    def _begin(self, request: MotionRequest, now: float) -> Trouble:
        """Why not; NO_TROUBLE: it has begun."""
        if why := self._unfit(now) or untimely(request, self.operator.tick):
            return why
        if (other := self._motion) is not None and other.stage != "ended":
            return Trouble(f"a motion of {other.by} goes on", "wait for its end, or cancel it")
        if self.operator.holder and not self.operator.holds:
            return Trouble(f"{self.operator.holder} drives", "wait until it rests, or end it; then ask again")
        if (odometry := self._odometry) is None or not self._knows_where:
            return _NO_ODOMETRY
        try:
            if any(map(is_in_map, steps_of(request))) and (fault := self._localized.fault(self._age, now)):
                return fault
            if fault := self._localized.goal_fault(steps_of(request)):
                return fault
            self._motion = self._pilot.begin(request, odometry, now)
        except ValueError as error:
            return Trouble(str(error))
        return NO_TROUBLE

    def _unfit(self, now: float) -> Trouble:
        """What is missing of the robot."""
        if fault := self.operator.fault(now):
            return fault
        if now - min(self._guard[1], self._told_who_drives) > _STATES_COUNT:
            return _NO_GUARD
        base, heard = self._base
        if base is None or now - heard > _STATES_COUNT:
            return _NO_BASE
        if self._estop is not None and self._estop.engaged:
            return self._estop.reason.of(f"emergency stop, engaged by {self._estop.by}")
        return NO_TROUBLE if base.board.connected else base.reason

    def _review(self, motion: Goal, now: float) -> None:
        """End what must not go on; begin to move once the robot is armed."""
        why = self._robot_fault(motion, now) or self._requester_fault(motion, now) or self._lease_fault(motion)
        why = why or self._map_fault(motion, now)
        if why is not None:
            motion.end(*why, now)
        elif now - motion.began > motion.time_limit:
            late = motion.delay(now) if motion.stage == "moving" else self._base_trouble
            motion.end("time_limit", late.of(f"not there after {motion.time_limit:.1f} s"), now)
        elif motion.stage == "arming":
            self._arm(motion, now)

    @property
    def _base_trouble(self) -> Trouble:
        base, _ = self._base
        return NO_TROUBLE if base is None else base.reason

    def _robot_fault(self, motion: Goal, now: float) -> tuple[Outcome, Trouble] | None:
        if reason := self._unfit(now):
            return "disarmed", reason
        lost = motion.stage == "moving" and not self._knows_where
        return ("lost_odometry", _NO_ODOMETRY) if lost else None

    @property
    def _knows_where(self) -> bool:
        return self._odometry is not None and self._age(self._odometry.tick) <= _ODOMETRY_COUNTS

    def _requester_fault(self, motion: Goal, now: float) -> tuple[Outcome, Trouble] | None:
        never = motion.tick is None
        lost = now - motion.began > WISH_COUNTS if never else self._age(motion.tick) > _HOLD_COUNTS
        return ("lost_requester", _NO_REQUESTER) if lost else None

    def _lease_fault(self, motion: Goal) -> tuple[Outcome, Trouble] | None:
        """While it is free one that is not armed yet may ask for it."""
        if not self.operator.holds:
            lost = motion.stage == "moving" or self.operator.holder
            return ("lost_lease", self.operator.refusal) if lost else None
        base, _ = self._base
        if motion.stage == "moving" and base is not None and not base.armed:
            return "disarmed", base.reason
        return None

    def _map_fault(self, motion: Goal, now: float) -> tuple[Outcome, Trouble] | None:
        if not motion.needs_map:
            return None
        reason = self._localized.fault(self._age, now) or motion.follow(self._localized.odom)
        return ("lost_localization", reason) if reason else None

    def _arm(self, motion: Goal, now: float) -> None:
        base, heard = self._base
        if not self.operator.holds:
            motion.restart_hold()
        is_armed = self.operator.holds and motion.has_held_still(LEVEL, heard, now) and base is not None and base.armed
        if is_armed and self._knows_where:
            motion.move()
        elif now - motion.began > _ARMS_WITHIN and is_armed:
            motion.end("lost_odometry", _NO_ODOMETRY, now)
        elif now - motion.began > _ARMS_WITHIN:
            reason = base.reason if base is not None and self.operator.holds else self.operator.refusal
            motion.end("disarmed", reason, now)

    def _twist(self, motion: Goal, now: float) -> tuple[float, float]:
        guard, _ = self._guard
        if motion.stage != "moving" or guard is None or self._odometry is None:
            return STANDS
        twist = motion.twist(self._odometry, guard, self._base_trouble, now)
        if motion.is_blocked(now):
            motion.end("blocked", motion.reason, now)
        elif motion.has_arrived:
            motion.end("arrived", NO_TROUBLE, now)
        return twist

    def _age(self, tick: RobotTime | None) -> float:
        """Return the age of a tick, s, by the newest that was heard."""
        return age_of(tick, self.operator.tick)

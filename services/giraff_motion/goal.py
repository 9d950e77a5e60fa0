"""One motion, from its request to its end."""

import math
from collections.abc import Mapping
from typing import Final

from giraff_core.kinematics.calibration import Covariance
from giraff_core.kinematics.dead_reckoning import Estimate, advance, chord_ratio
from giraff_core.kinematics.pose import Pose
from giraff_core.kinematics.systematic_error import SystematicError
from giraff_core.robot import RobotConfig
from giraff_motion.driver import STANDS, Coast, Driver, Rest
from giraff_motion.route import Route
from giraff_schemas.messages import Direction, DirectionLimit, GuardState, Odometry, RobotTime
from giraff_schemas.motion import Displacement, MotionRequest, MotionState, Outcome, Stage
from giraff_schemas.text import brief
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_RESTS_WITHIN: Final = 1.5
"""s"""
_LONGEST_NAME: Final = 100
_LONGEST_TEXT: Final = 300
"""Letters that others may put into what all are told, ten times a second."""
_LONGER: Final = "give it a longer time limit"
_GUARD_SLOWED: Final = Trouble("the guard slowed it where its sensors see little", _LONGER)
_SLOWED_SHARE: Final = 0.2
"""Share of a motion's turns in which it must have been slowed for that to be why it is late."""
_ARMS: Final = Trouble("holds still until the robot is armed")


class Travel:
    """What the robot has made of a motion so far, by odometry, and how sure that is.

    It begins at one sample of odometry, without doubt: what it errs by later is what has come to it on this way.
    The way of each wheel is told from two poses, as if it had been an arc, and makes the same covariance of it that
    odometry makes.
    """

    def __init__(self, robot: RobotConfig, start: Odometry) -> None:
        self.start = Pose(start.x, start.y, start.yaw)
        self.pose = self.start
        """In `odom`; its yaw counts whole turns from here on."""
        self._path = 0.0
        self._drive, self._wheel_noise = robot.kinematics, robot.wheel_noise
        self._random = Estimate()
        self._systematic = SystematicError(robot.calibration, robot.kinematics)

    def add(self, odometry: Odometry) -> None:
        """Go on to a later sample of the same segment."""
        last = self.pose
        turn = math.remainder(odometry.yaw - last.yaw, math.tau)
        self.pose = Pose(odometry.x, odometry.y, last.yaw + turn)
        distance = last.ahead(self.pose, turn / 2.0) / chord_ratio(turn)
        self._path += distance
        left, right = self._drive.wheel_speeds(distance, turn)
        self._random = advance(self._random, left, right, self._drive, self._wheel_noise)
        self._systematic.advance(left, right)

    @property
    def displacement(self) -> Displacement:
        """From the start, seen from there."""
        x, y = self.start.sees(self.pose.x, self.pose.y)
        return Displacement(path=self._path, x=x, y=y, yaw=self.pose.yaw - self.start.yaw)

    @property
    def covariance(self) -> Covariance:
        """Of its x, y and yaw."""
        both = zip(self._random.covariance, self._systematic.covariance(), strict=True)
        xx, xy, xt, yy, yt, tt = (one + other for one, other in both)
        return xx, xy, xt, yy, yt, tt


class _Delay:
    """How long one service slowed the motion, and its newest reason."""

    def __init__(self) -> None:
        self.turns = 0
        self.trouble = NO_TROUBLE

    def note(self, trouble: Trouble) -> None:
        """Take its reason in this turn. NO_TROUBLE: it does not slow the motion."""
        if trouble:
            self.turns, self.trouble = self.turns + 1, trouble


class Goal:
    """Times are s of any one monotonic clock."""

    def __init__(
        self,
        request: MotionRequest,
        way: Route,
        travel: Travel,
        rest: Rest,
        coasts: Mapping[bool, Coast],
        patience: float,
        time_limit: float,
        now: float,
    ) -> None:
        """`coasts`: along the floor, and of turns; `patience`, `time_limit`: s."""
        self.id = request.id
        self.by = brief(request.by, _LONGEST_NAME)
        self.began = now
        self.ended_at = now
        self._rolled_at = now
        self.time_limit = time_limit
        self.tick: RobotTime | None = None
        """The newest that the requester has sent."""
        self._requester = request.instance
        """Instance of the requester. Nobody else holds the motion, although its id is told to all."""
        self.stage: Stage = "arming"
        self.outcome: Outcome = ""
        self.reason = _ARMS
        self._route = way
        self._travel = travel
        self._rest = rest
        self._coasts = coasts
        self._patience = patience
        self._driver: Driver | None = None
        self._level_since: float | None = None
        self._blocked_since: float | None = None
        self._blocked: DirectionLimit | None = None
        self._stopping_since: float | None = None
        self._turns = 0  # in which it moved
        self._base = _Delay()
        self._guard = _Delay()

    @property
    def goes_on(self) -> bool:
        return self.stage in {"arming", "moving"}

    @property
    def pose(self) -> Pose:
        """Where the robot is, in `odom`."""
        return self._travel.pose

    @property
    def has_arrived(self) -> bool:
        return self._route.is_done

    @property
    def needs_map(self) -> bool:
        """Whether what is left of it goes by where the robot is on the map."""
        return self._route.needs_map

    def follow(self, odom: Pose) -> Trouble:
        """Go by where `odom` is in `map` now, or say why it cannot."""
        if (jump := self._route.jump(odom, self.pose)) is not None:
            by = f"{jump.shift:.2f} m and {math.degrees(jump.turn):.0f}°"
            jumped = f"localization has moved its goal or the robot by {by} at once"
            return Trouble(jumped, "see that it is right, and ask again")
        if self._route.is_off(odom, self.pose):
            self._driver = None
        return NO_TROUBLE

    @property
    def news(self) -> tuple[object, ...]:
        """What is said at once when it becomes another."""
        return self.id, self.stage, self.outcome, self.reason, self._route.at

    def hold(self, tick: RobotTime, instance: str) -> None:
        """The requester is there, and has sent this tick. An older one says nothing, nor does anybody else's."""
        if instance != self._requester:
            return
        if self.tick is None or tick.epoch != self.tick.epoch or tick.robot_ns > self.tick.robot_ns:
            self.tick = tick

    def add(self, odometry: Odometry, now: float) -> None:
        """Take where the robot is: also while it rolls to rest."""
        if self.stage != "ended":
            self._travel.add(odometry)
        if not self._rest.holds(odometry):
            self._rolled_at = now

    def has_held_still(self, since: float, heard: float, now: float) -> bool:
        """Whether it has held still under its lease for `since` s when base's state was `heard`."""
        if self._level_since is None:
            self._level_since = now
        return heard - self._level_since >= since

    def restart_hold(self) -> None:
        """The lease is not its own, or not yet."""
        self._level_since = None

    def move(self) -> None:
        """It is armed."""
        self.stage, self.reason = "moving", NO_TROUBLE

    def twist(self, odometry: Odometry, guard: GuardState, base: Trouble, now: float) -> tuple[float, float]:
        """Return m/s and rad/s to ask for now. `base`: why it does less than the guard let through."""
        self._turns += 1
        self._base.note(base)
        while not self.has_arrived and (self._driver is None or self._driver.is_done):
            self._next()
        if self._driver is None or self.has_arrived:
            return STANDS
        if not self._driver.is_stopping:
            self._stopping_since = None
        elif self._stopping_since is None:
            self._stopping_since = now
        verdict = _verdict_of(guard, self._driver.direction)
        self._guard.note(NO_TROUBLE if verdict.clearance == "free" else _GUARD_SLOWED)
        if not self._driver.is_stopping and verdict.clearance == "blocked":
            self._wait(verdict, now)
            return STANDS
        self._blocked_since, self._blocked, self.reason = None, None, NO_TROUBLE
        return self._driver.twist(self.pose, odometry, now)

    def is_blocked(self, now: float) -> bool:
        """Whether its way has been blocked for longer than its patience."""
        return self._blocked_since is not None and now - self._blocked_since > self._patience

    def delay(self, now: float) -> Trouble:
        """Return why it takes longer than it may: what slowed it longest counts, not what does at the end."""
        longest = max((self._base, self._guard), key=lambda each: each.turns)
        slowed = longest.trouble if longest.turns >= _SLOWED_SHARE * self._turns else NO_TROUBLE
        if slowed and longest is self._base:
            return slowed
        if self._stopping_since is not None and now - self._stopping_since > _RESTS_WITHIN:
            return Trouble("the robot does not come to rest", "see what moves it, and check the encoders")
        if self._driver is not None and self._driver.is_stuck:
            return Trouble("the robot stands although it is asked to move", "check its motors and what holds it")
        return slowed or Trouble("it was still on its way", _LONGER)

    def end(self, outcome: Outcome, reason: Trouble, now: float) -> None:
        """For good."""
        if len(line := str(reason)) > _LONGEST_TEXT:
            reason = Trouble(line[:_LONGEST_TEXT])
        self.stage, self.outcome, self.reason, self.ended_at = "stopping", outcome, reason, now
        if outcome != "blocked":
            self._blocked = None
        if outcome == "lost_lease":  # what the robot goes from now on is another's
            self.stage = "ended"
        self.settle(now)

    def settle(self, now: float) -> None:
        """It has ended for good when the robot rests, or when nobody tells that it does."""
        if self.stage == "stopping" and (
            now - self._rolled_at >= self._rest.time or now - self.ended_at > _RESTS_WITHIN
        ):
            self.stage = "ended"

    def state(self, now: float) -> MotionState:
        """As it is said."""
        way, until = self._route, now if self.goes_on else self.ended_at
        return MotionState(
            id=self.id,
            by=self.by,
            stage=self.stage,
            step=way.step if self.stage != "arming" else 0,
            steps=way.steps,
            asked=way.asked,
            achieved=self._travel.displacement,
            covariance=self._travel.covariance,
            elapsed=until - self.began,
            time_limit=self.time_limit,
            outcome=self.outcome,
            sensor=self._blocked.sensor if self._blocked is not None else "",
            reason=self.reason,
        )

    def _next(self) -> None:
        """Begin the next piece, if there is one."""
        if (planned := self._route.next(self.pose)) is not None:
            _, leg, limits = planned
            self._driver = Driver(leg, limits, self._rest, self._coasts[leg.turns], self.pose)

    def _wait(self, verdict: DirectionLimit, now: float) -> None:
        if self._blocked_since is None:
            self._blocked_since = now
        self._blocked, self.reason = verdict, verdict.reason


def _verdict_of(guard: GuardState, direction: Direction) -> DirectionLimit:
    """What the guard allows there."""
    verdict: DirectionLimit = getattr(guard, direction)
    return verdict

"""Bumpers as a sense of the guard: one that is pushed stops its way, until the robot has moved away from there."""

import math
from typing import Final

from giraff_core.freshness import age
from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import Bumper
from giraff_guard.config import GuardConfig
from giraff_guard.limits import OTHER, SIGN, DriveDirection, Limits
from giraff_guard.motion import RecentTravel
from giraff_schemas.bumper import Bump
from giraff_schemas.messages import DirectionLimit, RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_TURNED_AWAY: Final = math.pi / 2.0
"""rad, from which on a bumper of half the rim looks elsewhere."""
_NEVER: Final = "start giraff_ranger, and flash the ranger board if it is older than its bumpers"


class BumperSource:
    """All bumpers of one robot: a `Source`."""

    takes = Bump

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig) -> None:
        self._limits = Limits(live, robot)
        self.names = {name: _Switch(name, bumper) for name, bumper in robot.of(Bumper).items()}

    def on_sample(self, sample: Bump, motion: RecentTravel, now: RobotTime) -> None:
        """What one says."""
        del now
        self.names[sample.sensor].on_bump(sample, motion)

    def forget(self) -> None:
        """Begin anew. Where one was pushed something may still stand: the robot has to move away from where it is."""
        for switch in self.names.values():
            switch.forget()

    def lose_place(self) -> None:
        """The robot may have come nearer: it has to move away from where it is now."""
        for switch in self.names.values():
            switch.lose_place()

    def straight(self, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> DirectionLimit:
        """Full speed, or none. A robot that rolls back as it drives off creeps where a bumper behind it is unheard."""
        limits, config = self._limits, self._limits.config
        if blocked := self._blocked(way, motion, now):
            return blocked
        if config.room_behind > 0.0:
            for switch in self._of(OTHER[way]):
                if why := switch.push(motion, config.touch_distance):
                    return limits.block(
                        switch.name, Trouble(f"{why.what}, and driving {way} rolls the robot back first")
                    )
            for switch in self._of(OTHER[way]):
                if blindness := switch.blindness(config.range_budget, now):
                    return limits.creep(switch.name, blindness)
        return limits.allow(limits.most)

    def curve(self, way: DriveDirection, curvature: float, motion: RecentTravel, now: RobotTime) -> None:
        """It looks nowhere."""

    def room(self, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> float:
        """It knows only whether something touches it."""
        return 0.0 if self._blocked(way, motion, now) else math.inf

    def turn(self, motion: RecentTravel) -> None:
        """Turning is how one gets away from what it has touched."""

    def relied_on(self, way: DriveDirection, now: RobotTime) -> RobotTime | None:
        """The oldest word of this way's bumpers."""
        never = RobotTime(epoch=now.epoch, robot_ns=0)
        ticks = (switch.tick or never for switch in self._of(way))
        return min(ticks, key=lambda tick: tick.robot_ns, default=None)

    def troubles(self, motion: RecentTravel, now: RobotTime) -> dict[str, Trouble]:
        """By bumper: why it is not known whether it is pushed."""
        del motion
        budget = self._limits.config.range_budget
        return {name: switch.blindness(budget, now) for name, switch in self.names.items()}

    def freer_side(self, way: DriveDirection) -> str:
        """It looks nowhere."""
        del way
        return ""

    def _blocked(self, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> DirectionLimit | None:
        limits = self._limits
        for switch in self._of(way):
            if why := switch.blindness(limits.config.range_budget, now) or switch.push(
                motion, limits.config.touch_distance
            ):
                return limits.block(switch.name, why)
        return None

    def _of(self, way: DriveDirection) -> "list[_Switch]":
        return [switch for switch in self.names.values() if switch.way == way]


class _Switch:
    def __init__(self, name: str, bumper: Bumper) -> None:
        self.name = name
        self.way: DriveDirection = bumper.way
        self._newest: Bump | None = None
        self._touched: Pose | None = None
        """Where the robot was when it was pushed last, until it has moved away from there."""
        self._place_is_lost = False

    @property
    def tick(self) -> RobotTime | None:
        return self._newest.tick if self._newest is not None else None

    def on_bump(self, sample: Bump, motion: RecentTravel) -> None:
        self._newest = sample
        if sample.pressed:
            self._touch(motion)

    def lose_place(self) -> None:
        self._place_is_lost = True

    def forget(self) -> None:
        self._newest, self._place_is_lost = None, True

    def blindness(self, budget: float, now: RobotTime) -> Trouble:
        """Why it is not known whether it is pushed. `budget`: s that its word counts."""
        if self._newest is None:
            return Trouble(f"{self.name} has not been heard yet", _NEVER)
        if (old := age(self._newest.tick, now)) > budget:
            last = f"{old:.1f} s old" if math.isfinite(old) else "of no known age"
            return Trouble(f"{self.name} is stale ({last})", "check giraff_ranger and its board")
        return NO_TROUBLE

    def push(self, motion: RecentTravel, touch_distance: float) -> Trouble:
        """Why something stands at it; NO_TROUBLE: nothing does. `touch_distance`: m; twice as much is away."""
        if self._newest is not None and self._newest.pressed:
            return Trouble(f"{self.name} is pushed: something touches it, or its wire is cut")
        touched = self._touched
        if touched is None:
            return NO_TROUBLE
        if self._place_is_lost or not motion.heard:
            touched = self._touch(motion)
        axis = 0.0 if SIGN[self.way] > 0.0 else math.pi
        backed = -touched.ahead(motion.place, axis)
        if backed >= 2.0 * touch_distance or abs(motion.place.yaw - touched.yaw) >= _TURNED_AWAY:
            self._touched = None
            return NO_TROUBLE
        return Trouble(f"{self.name} was pushed here, and the robot has not come {2.0 * touch_distance:g} m away")

    def _touch(self, motion: RecentTravel) -> Pose:
        """Take where the robot is for where it was pushed. While no wheels are heard, that place is not certain."""
        self._touched, self._place_is_lost = motion.place, not motion.heard
        return motion.place

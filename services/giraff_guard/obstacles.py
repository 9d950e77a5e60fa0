"""Obstacles and blind directions: what ranges and wheels allow, and what is let through of a twist."""

import math
from typing import Final, Literal, NamedTuple

import msgspec

from giraff_core.freshness import age
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import Sensed
from giraff_guard.config import GuardConfig
from giraff_guard.judge.direction import Direction
from giraff_guard.judge.memory import Echoes
from giraff_guard.judge.points import touches
from giraff_guard.judge.silence import silence
from giraff_guard.limits import SIGN, DriveDirection, Limits
from giraff_guard.motion import RecentTravel
from giraff_guard.registry import sources_of
from giraff_guard.source import Source
from giraff_schemas.messages import Attitude, DirectionLimit, RobotTime, Side, Wheels
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_BACK: Final[dict[DriveDirection, str]] = {"forward": "back up", "backward": "drive forward"}
_UNJUDGED: Final = DirectionLimit(
    allowed=0.0, clearance="blocked", sensor="", reason=Trouble("nothing is judged yet", "wait")
)


class Verdicts(NamedTuple):
    """What is allowed in each direction now."""

    forward: DirectionLimit
    backward: DirectionLimit
    turn_left: DirectionLimit
    turn_right: DirectionLimit


class Limited(NamedTuple):
    """What is let through of a twist."""

    linear_x: float
    angular_z: float
    reason: Trouble
    """Why it is less than asked."""
    range_tick: RobotTime | None
    """Oldest moment of the readings that the motion asked for relies on, whatever passes; None: it relies on none."""


class Obstacles:
    """Feed it admitted samples of sensors and wheel reports; judge, then limit, once a decision."""

    def __init__(self, live: Live[GuardConfig], robot: RobotConfig) -> None:
        """Raises ValueError for a robot that has a sensor of a type that nobody knows here."""
        self._live = live
        self._robot = robot
        self._limits = Limits(live, robot)
        self._sources: list[Source] = sources_of(live, robot)
        self._begin()

    def on_sensed(self, sample: Sensed, now: RobotTime) -> bool:
        """Take a sample that is newer than the last of its sensor. A sensor that the robot file lacks says nothing.

        True: less may pass now than has passed last.
        """
        heard = (each for each in self._sources if sample.sensor in each.names and isinstance(sample, each.takes))
        source = next(heard, None)
        if source is None:
            return False
        self._motion.update(now)
        self._ticks[sample.sensor] = sample.tick
        beams = source.on_sample(sample, self._motion, now)
        for direction in self._directions.values():
            direction.on_sample(sample.sensor, now if sample.tick is None else sample.tick, beams)
        for beam in beams if self._motion.heard else ():
            self._echoes.on_beam(beam, self._motion.travel)
        if self._asked == (0.0, 0.0):
            return False
        self.judge(now)
        allowed, passed = self._limited(*self._asked, now), self._passed
        return abs(allowed.linear_x) < abs(passed.linear_x) or abs(allowed.angular_z) < abs(passed.angular_z)

    def on_wheels(self, wheels: Wheels, now: RobotTime) -> None:
        """A report newer than the last; one of no known age says nothing."""
        if not math.isfinite(age(wheels.tick, now)):
            return
        breaks = self._motion.breaks
        self._motion.on_wheels(wheels)
        if self._motion.breaks != breaks:
            self._echoes.clear()
            for source in self._sources:
                source.lose_place()
        self._motion.update(now)

    @property
    def travel(self) -> float:
        """m the robot has made since the epoch began, backwards counted too."""
        return self._motion.travel

    def on_attitude(self, attitude: Attitude) -> None:
        """A report newer than the last."""
        self._motion.on_attitude(attitude)

    def forget(self) -> None:
        """A new epoch: nothing that was remembered has a known age."""
        for source in self._sources:
            source.forget()
        self._begin()

    @property
    def verdicts(self) -> Verdicts:
        """Return the verdict for each direction, as `judge` found it last."""
        return self._verdicts

    def troubles(self, now: RobotTime) -> dict[str, Trouble]:
        """Return why a sensor is not trusted, by its name."""
        budget = self._limits.config.range_budget
        return {
            name: silence(name, source.service, self._ticks[name], budget, now)
            or source.trouble(name, self._motion, now)
            for source in self._sources
            for name in source.names
        }

    def judge(self, now: RobotTime) -> Verdicts:
        """The verdict for each direction now."""
        self._motion.update(now)
        self._echoes.forget(now.robot_ns, self._motion.travel)
        for direction in self._directions.values():
            direction.update(self._motion, now)
        ahead, behind = self._directions["forward"], self._directions["backward"]
        forward = ahead.judge(behind, self._echoes, self._motion, now)
        backward = behind.judge(ahead, self._echoes, self._motion, now)
        turn = self._turn()
        self._verdicts = Verdicts(
            forward=self._with_remedy("forward", forward, other=backward),
            backward=self._with_remedy("backward", backward, other=forward),
            turn_left=turn,
            turn_right=turn,
        )
        return self._verdicts

    def free_side(self, now: RobotTime) -> Side:
        """Return the side to which a robot that sits down has room, as of the last `judge`.

        What no sensor knows to be free is not.
        """
        room = self._live.config.sit_room
        sides: tuple[Literal["forward", "backward"], ...] = ("forward", "backward")
        for side in sides:
            if self._directions[side].room(self._echoes, self._motion, now) >= room:
                return side
        return "none"

    def limit(self, linear_x: float, angular_z: float, now: RobotTime) -> Limited:
        """What is let through of a twist, by the verdicts of this turn."""
        limited = self._limited(linear_x, angular_z, now)
        self._asked, self._passed = (linear_x, angular_z), limited
        self._motion.on_passed(limited.linear_x, limited.angular_z, now)
        return limited

    def _limited(self, linear_x: float, angular_z: float, now: RobotTime) -> Limited:
        """What may be let through of a twist."""
        linear, angular, reason = self._within_the_robots_means(linear_x, angular_z)
        range_tick = None
        if linear != 0.0:
            way: DriveDirection = "forward" if linear > 0.0 else "backward"
            verdict = self._verdicts.forward if linear > 0.0 else self._verdicts.backward
            allowed, why = self._on_this_path(verdict, way, angular / linear, now)
            if allowed == 0.0:
                # Nothing is left of the curve: the rotation is judged alone, and passes slowly. Never a trap.
                linear = 0.0
                angular = math.copysign(min(abs(angular), self._live.config.creep_angular), angular)
                reason = why.of(f"{way} blocked")
            elif allowed < abs(linear):
                share = allowed / abs(linear)  # of both: the curvature is the operator's
                linear, angular = linear * share, angular * share
                why = why or Trouble(f"this robot drives at {allowed:g} m/s at most")
                reason = why.of(f"{way} slowed")
            range_tick = self._directions[way].relied_on(now)
        if linear == 0.0:
            turn = self._verdicts.turn_left
            if abs(angular) > turn.allowed:
                angular = math.copysign(turn.allowed, angular)
                reason = reason or turn.reason.of("turning slowed")
        return Limited(linear, angular, reason, range_tick)

    def _begin(self) -> None:
        self._motion = RecentTravel(self._live, self._robot)
        self._ticks: dict[str, RobotTime | None] = {name: None for source in self._sources for name in source.names}
        self._echoes = Echoes(self._limits)
        self._directions = {way: Direction(way, self._limits, self._sources, self._ticks) for way in SIGN}
        self._verdicts = Verdicts(_UNJUDGED, _UNJUDGED, _UNJUDGED, _UNJUDGED)
        self._asked = (0.0, 0.0)  # when it was limited last, and what has passed of it
        self._passed = Limited(0.0, 0.0, NO_TROUBLE, None)

    def _turn(self) -> DirectionLimit:
        """Turning in place sweeps nothing beyond the footprint's disc; what touches that is turned past slowly."""
        creep, largest, place = self._limits.config.creep_angular, self._robot.max_angular_speed, self._motion.place
        seen = (each for direction in self._directions.values() for each in direction.sights)
        sensor = self._echoes.touching(place) or next(
            (sight.sensor for sight in seen if touches(sight, place, self._limits)), ""
        )
        if not sensor or creep >= largest:
            return DirectionLimit(allowed=largest, clearance="free", sensor="")
        reason = f"{sensor} has seen something that touches the robot's side"
        return DirectionLimit(allowed=creep, clearance="creep", sensor=sensor, reason=Trouble(reason))

    def _with_remedy(self, way: DriveDirection, verdict: DirectionLimit, *, other: DirectionLimit) -> DirectionLimit:
        """A blocked verdict with what the operator can do instead."""
        if verdict.clearance != "blocked":
            return verdict
        side = self._directions[way].freer_side()
        turn = f"turn {side}".strip()
        remedy = f"{turn} or {_BACK[way]}" if other.allowed > 0.0 else turn
        remedy = ", or ".join(filter(None, (verdict.reason.remedy, remedy)))
        return msgspec.structs.replace(verdict, reason=msgspec.structs.replace(verdict.reason, remedy=remedy))

    def _within_the_robots_means(self, linear: float, angular: float) -> tuple[float, float, Trouble]:
        largest = self._robot.max_angular_speed
        if abs(angular) <= largest:
            return linear, angular, NO_TROUBLE
        share = largest / abs(angular)
        slower = Trouble(f"slowed: this robot turns at {largest:g} rad/s at most")
        return linear * share, math.copysign(largest, angular), slower

    def _on_this_path(
        self, verdict: DirectionLimit, way: DriveDirection, curvature: float, now: RobotTime
    ) -> tuple[float, Trouble]:
        """The speed along a curve and why: a curve sweeps what straight ahead does not."""
        allowed, why = verdict.allowed, verdict.reason
        swept = self._directions[way].curve(curvature, self._echoes, self._motion, now)
        if swept is not None and swept[0] < allowed:
            allowed, why = swept
            allowed = allowed if allowed >= self._live.config.min_speed else 0.0
        return allowed, why

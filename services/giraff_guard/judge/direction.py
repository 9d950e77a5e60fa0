"""How fast the robot may drive forward or backward by what its senses tell, and why not faster."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from giraff_core.freshness import age
from giraff_guard.judge.memory import Echoes
from giraff_guard.judge.nearest import Nearest
from giraff_guard.judge.points import in_the_way, with_reading
from giraff_guard.judge.recent import RecentObstacles
from giraff_guard.judge.silence import silence, unusable
from giraff_guard.limits import OTHER, SIGN, DriveDirection, Limits
from giraff_guard.motion import RecentTravel
from giraff_guard.source import Beam, Sight, Source
from giraff_schemas.messages import DirectionLimit, RobotTime
from giraff_schemas.trouble import Trouble

Ticks = Mapping[str, RobotTime | None]

ALONG: Final = 0.7
"""Cosine between an axis and a direction, from which on a sensor looks along it."""
_ASIDE: Final = 0.10
"""m of difference between left and right from which one side counts as the freer one."""
_LOOKS_NS: Final = 100_000_000
"""Time between two looks that count after a block: a sensor that looks more often opens no way sooner."""
_UNMEASURED: Final = Trouble("deceleration has not been measured", "measure it, and set it in [guard]")
_SPEEDS_UP: Final = Trouble("this way was blocked until just now", "wait, it speeds up by itself")


class Direction:
    """One way along x, judged by all sensors that cover it.

    A way that was blocked is released to creep, and each further look of the sensor that blocked it adds speed.
    """

    def __init__(self, way: DriveDirection, limits: Limits, sources: Sequence[Source], ticks: Ticks) -> None:
        """`ticks`: moment of the newest sample of each sensor, kept by whoever hears them."""
        self._way: DriveDirection = way
        self._limits = limits
        self._ticks = ticks
        self._covering = [(source, sensor) for source in sources for sensor in source.covers(way)]
        self.is_seen = any(source.sees_ahead for source, _ in self._covering)
        """A sensor tells what stands there before the robot touches it."""
        self._nearest = Nearest(limits)
        self._recent = RecentObstacles(way, limits)
        self.sights: list[Sight] = []
        """What the sensors tell now."""
        self._blocked = True
        self._blocker = ""
        """The sensor that blocked this way last; empty: none has yet, and each one's looks count."""
        self._regained = 0.0
        """m/s beyond creeping that its looks since then allow."""
        self._looked_ns = -_LOOKS_NS
        """Moment of the last look that counted."""

    def on_sample(self, sensor: str, tick: RobotTime, beams: Sequence[Beam]) -> None:
        """Take what a sensor tells. `tick`: moment of its look."""
        if not self._blocked and self._blocker in ("", sensor) and tick.robot_ns - self._looked_ns >= _LOOKS_NS:
            self._regained += self._limits.config.recovery_step
            self._looked_ns = tick.robot_ns
        for beam in beams:
            if SIGN[self._way] * math.cos(beam.mount.yaw) > ALONG:
                self._recent.on_beam(beam)

    def update(self, motion: RecentTravel, now: RobotTime) -> None:
        """Ask each sensor what it tells now."""
        self.sights = [
            with_reading(self._sight(source, sensor, motion, now), motion.place, self._way, self._limits)
            for source, sensor in self._covering
        ]

    def _sight(self, source: Source, sensor: str, motion: RecentTravel, now: RobotTime) -> Sight:
        budget = self._limits.config.range_budget
        if unheard := silence(sensor, source.service, self._ticks[sensor], budget, now):
            return Sight(sensor, blind=unheard, touch=source.touch(sensor, self._way, motion))
        sight = source.sight(sensor, self._way, motion, now)
        why = unusable(sight, sees_ahead=source.sees_ahead)
        return Sight(sensor, blind=why, touch=sight.touch) if why else sight

    def judge(self, behind: "Direction", echoes: Echoes, motion: RecentTravel, now: RobotTime) -> DirectionLimit:
        """Return the verdict by the last `update`. `behind`: the other way."""
        limits, place, sights = self._limits, motion.place, self.sights
        stops_within = limits.stops_within(motion.speed(SIGN[self._way]))
        verdicts = [
            self._nearest.verdict(sight, age(self._ticks[sight.sensor], now), stops_within, blocked=self._blocked)
            for sight in sights
        ]
        verdicts.extend(echoes.verdicts(place, self._way, now.robot_ns))
        self._recent.forget(now.robot_ns)
        if silent := [sight for sight in sights if sight.silent_s is not None]:
            verdicts.extend(self._recent.verdicts(silent, motion))
        if not self.is_seen:
            verdicts.append(limits.creep("", Trouble(f"no sensor looks {self._way}")))
        if limits.config.room_behind > 0.0:
            verdicts.extend(self._rolling_back(behind))
        if limits.config.deceleration is None:
            verdicts.append(limits.creep("", _UNMEASURED))
        verdict = min(verdicts, key=lambda each: each.allowed)
        self._blocked = verdict.clearance == "blocked"
        if self._blocked:
            self._blocker, self._regained, self._looked_ns = verdict.sensor, 0.0, -_LOOKS_NS
        elif (allowed := limits.config.creep_linear + self._regained) < verdict.allowed:
            return limits.allow(allowed, verdict.sensor, _SPEEDS_UP)
        return verdict

    def _rolling_back(self, behind: "Direction") -> Iterator[DirectionLimit]:
        """Yield limits by what stands behind, or may: driving off, and after a stop, the robot rolls back."""
        if not behind.is_seen:
            yield self._limits.creep(
                "", Trouble(f"no sensor looks {OTHER[self._way]}, where the robot first rolls back")
            )
        for sight in behind.sights:
            blocked = self._blocked and self._blocker == sight.sensor
            if verdict := self._nearest.opposite(sight, blocked=blocked):
                yield verdict

    def curve(
        self, curvature: float, echoes: Echoes, motion: RecentTravel, now: RobotTime
    ) -> tuple[float, Trouble] | None:
        """Return m/s and why, where a curve (angular_z / linear_x, 1/m) meets what straight ahead does not."""
        swept = list(echoes.in_the_way(motion.place, self._way, now.robot_ns, curvature))
        for sight in self.sights:
            swept += in_the_way(sight, motion.place, self._way, self._limits, curvature)
        obstruction = min(swept, key=echoes.speed_towards, default=None)
        if obstruction is None:
            return None
        side = "left" if obstruction.bearing > 0.0 else "right"
        what = f"this curve sweeps what {obstruction.sensor} has seen to the {side}"
        return echoes.speed_towards(obstruction), Trouble(what, "turn the other way")

    def room(self, echoes: Echoes, motion: RecentTravel, now: RobotTime) -> float:
        """Return m beyond the footprint that are known to be free; 0 where no sensor looks."""
        if not self.is_seen or not self.sights:
            return 0.0
        rooms = [self._nearest.room(sight) for sight in self.sights]
        rooms += [each.distance for each in echoes.in_the_way(motion.place, self._way, now.robot_ns)]
        if any(sight.silent_s is not None for sight in self.sights) and (heard := self._recent.ahead(motion.place)):
            rooms.append(heard.distance)
        return min(rooms)

    def relied_on(self, now: RobotTime) -> RobotTime | None:
        """Return the oldest of the newest moments of this way's sensors, robot_ns 0 for one that never came."""
        never = RobotTime(epoch=now.epoch, robot_ns=0)
        moments = (self._ticks[sensor] or never for _, sensor in self._covering)
        return min(moments, key=lambda tick: tick.robot_ns, default=None)

    def freer_side(self) -> str:
        """Return where the sensors see farther: left, right, or neither."""
        left = [sight.newest for sight in self.sights if sight.newest is not None and sight.aside > 0.0]
        right = [sight.newest for sight in self.sights if sight.newest is not None and sight.aside < 0.0]
        difference = min(left, default=0.0) - min(right, default=0.0)
        if not left or not right or abs(difference) < _ASIDE:
            return ""
        return "left" if difference > 0.0 else "right"

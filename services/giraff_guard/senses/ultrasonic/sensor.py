"""What one ultrasonic sensor is believed to say. docs/obstacles.md has the rules and why they are so."""

import math
from collections import deque
from typing import Final

from giraff_core.freshness import age
from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_core.senses import Ultrasonic
from giraff_guard.config import GuardConfig
from giraff_guard.motion import LEVEL, Lean, RecentTravel
from giraff_guard.senses.ultrasonic.level import floor_from, level_distance
from giraff_guard.senses.ultrasonic.self_test import SelfTest
from giraff_guard.senses.ultrasonic.silence_trust import OwnEchoes, Ping, SilenceTrust
from giraff_schemas.messages import Range, RobotTime
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_KEPT: Final = 4
"""Readings: what was heard the time before last is not alone when it is heard again."""


class Sensor:
    """The newest few good readings without a gap or fault between, and what more is known of the sensor."""

    def __init__(self, name: str, pose: Ultrasonic, live: Live[GuardConfig]) -> None:
        self.name = name
        self.pose = pose
        self.mount = Pose(pose.x, pose.y, pose.yaw)
        self.offset = pose.x * math.cos(pose.yaw) + pose.y * math.sin(pose.yaw)
        """m the sensor sits ahead of base_link, along its own axis."""
        self.aside = pose.y * math.cos(pose.yaw) - pose.x * math.sin(pose.yaw)
        """m it sits to the left of base_link, seen along its axis."""
        self._live = live
        self._pings: deque[Ping] = deque(maxlen=_KEPT)
        self._reading: Range | None = None
        self._trust = SilenceTrust(live)
        self._own = OwnEchoes(pose.yaw)
        self.heard: Ping | None = None
        """The last echo that follows from one of those kept before it: both are of one surface."""
        self.last_confirmed: Ping | None = None
        """The last one that follows from an echo just before it."""
        self._unlevelled = NO_TROUBLE
        """Why the newest reading could not be levelled."""
        self._lost: tuple[Pose, float] | None = None  # where the robot was when a touching echo was lost, m
        self._self_test = SelfTest(live)

    @property
    def half_cone(self) -> float:
        """rad off its axis from which an echo may come."""
        return self._live.config.half_cone or self.pose.half_cone

    @property
    def incidence(self) -> float:
        """rad up to which a slanted surface is heard reliably."""
        return self._live.config.incidence or self.pose.incidence

    @property
    def reach(self) -> float:
        """m that its `clear` counts for."""
        return min(self._live.config.reach, self.pose.reach)

    @property
    def newest(self) -> Ping | None:
        """The newest good reading, if none but a good one came since."""
        return self._pings[-1] if self._pings else None

    def on_range(self, reading: Range, motion: RecentTravel, now: RobotTime) -> None:
        """Take a reading."""
        config = self._live.config
        self._reading = reading
        if reading.state == "fault" or reading.tick is None or not math.isfinite(age(reading.tick, now)):
            self._pings.clear()
            return
        lean = motion.lean_at(reading.tick.robot_ns)
        self._unlevelled = self._why_not_levelled(lean)
        if lean is None or self._unlevelled:
            self._pings.clear()
            return
        distance, is_echo = self._levelled(reading, lean)
        ping = Ping(
            robot_ns=reading.tick.robot_ns,
            distance=distance,
            echo=is_echo,
            place=motion.place_at(reading.tick.robot_ns),
        )
        before = self.newest
        if before is not None and (ping.robot_ns - before.robot_ns) * 1e-9 > config.range_budget:
            self._pings.clear()
            before = None
        self._note_loss(ping)
        self._pings.append(ping)
        both_echoes = before is not None and before.echo and ping.echo
        follows = before is not None and self._follows(before, ping)
        if motion.heard:
            pulse = reading.echo_us if ping.echo else None
            self._self_test.on_reading(pulse, ping.place, self.pose.yaw, both_echoes and not follows)
        own = self._own.on_ping(ping) and motion.heard
        *earlier, _ = self._pings
        twice = ping.echo and any(each.echo and self._follows(each, ping) for each in earlier)
        if twice or own:
            self._trust.prove(ping.robot_ns, motion, own=own)
        if twice:
            self.heard = ping
        if both_echoes and follows:
            self.last_confirmed = ping

    def blindness(self) -> Trouble:
        """Return why a sensor that is heard does not count at all."""
        reading = self._reading
        if reading is not None and reading.state == "fault":
            return reading.reason.of(f"{self.name} is faulty")
        if self._unlevelled:
            return self._unlevelled
        if self._self_test.frozen:
            return Trouble(
                f"{self.name} is frozen: it repeats one echo while the robot moves", "check it, or look for slip"
            )
        if len(self._pings) < 2:
            return Trouble(f"{self.name} has been heard only once since it was silent", "wait for its next reading")
        return NO_TROUBLE

    def distrust(self, motion: RecentTravel, now: RobotTime) -> Trouble:
        """Why its silence is worth less than an echo."""
        if self._self_test.wild:
            return Trouble(f"{self.name} jumps as no surface does", "face a wall squarely, else check the sensor")
        if self._trust.distrust(motion, now) > 0.0:
            return Trouble(
                f"{self.name} has not proved lately that it hears",
                f"face a wall within {self.reach:g} m",
            )
        return NO_TROUBLE

    def allowed_speed(self, motion: RecentTravel, now: RobotTime, most: float) -> float:
        """m/s that its silence allows, `most` where it is not in doubt."""
        if self._self_test.wild:
            return self._live.config.creep_linear
        least = min(most, self._live.config.untrusted_speed)
        return most - self._trust.distrust(motion, now) * (most - least)

    @property
    def is_silent(self) -> bool:
        """Whether it hears nothing now: no echo among the readings that count."""
        return not any(ping.echo for ping in list(self._pings)[-2:])

    def silence_s(self, now: RobotTime) -> float:
        """s since its last confirmed echo; infinite before the first."""
        return math.inf if self.last_confirmed is None else (now.robot_ns - self.last_confirmed.robot_ns) * 1e-9

    def lost(self, motion: RecentTravel) -> bool:
        """Whether an echo was lost so near that what gave it may touch the sensor.

        Over when the robot has moved away from it, or has turned away.
        """
        if self._lost is None:
            return False
        config, (place, distance) = self._live.config, self._lost
        away = distance - place.ahead(motion.place, self.pose.yaw)
        if away >= 2.0 * config.touch_distance or abs(motion.place.yaw - place.yaw) >= 4.0 * self.half_cone:
            self._lost = None
        return self._lost is not None

    def counted(self, others: "list[Sensor]") -> list[Ping]:
        """The readings that count, newest first. `others`: the sensors that look the same way.

        The last two, so that one long reading never hides what the one before has heard; but not one that stands
        alone: longer readings of its own sensor before and after it, and the newest of each other sensor, outvote it.
        """
        *before, doubted, last = self._pings
        if not before or not others or not self._is_alone(doubted, before, last):
            return [last, doubted]
        outvoted = all(self._outvotes(other.newest, doubted, other) for other in others)
        return [last] if outvoted else [last, doubted]

    def _why_not_levelled(self, lean: Lean | None) -> Trouble:
        if lean is None:
            return Trouble(f"{self.name} looks along a body whose lean is not known", "check giraff_base and its board")
        if lean is not LEVEL and self.pose.z <= 0.0:
            return Trouble(f"{self.name} is on a body that leans, and its height is not known", "set its z")
        return NO_TROUBLE

    def _levelled(self, reading: Range, lean: Lean) -> tuple[float, bool]:
        """Return m of level way ahead of the sensor's place on an upright robot, and whether something echoed there.

        From where it may hear the floor on, an echo is no obstacle and no proof, and a silence tells no more.
        """
        distance, is_echo = (
            min(self.reach, reading.range if reading.range is not None else self.reach),
            reading.state == "echo",
        )
        if lean is LEVEL:
            return distance, is_echo
        floor = floor_from(self.pose, self.half_cone, lean)
        level = level_distance(min(distance, floor), self.pose, lean)
        return min(self.reach, level), is_echo and distance < floor

    def _is_alone(self, doubted: Ping, before: list[Ping], last: Ping) -> bool:
        """Whether nothing near it, and nothing that could have come there at a walk, was heard around it."""
        if self._compare(doubted, last) <= 0 or self._compare(doubted, before[-1]) <= 0:
            return False
        return all(self._compare(doubted, earlier, walk=False) != 0 for earlier in before[:-1])

    def _outvotes(self, witness: Ping | None, ping: Ping, other: "Sensor") -> bool:
        if witness is None or witness.robot_ns < ping.robot_ns:
            return False
        here, there = self.offset + ping.distance, other.offset + witness.distance
        return there > here + self._live.config.range_tolerance + self._walked(ping, witness)

    def _note_loss(self, ping: Ping) -> None:
        """Before `ping` is taken: whether it loses an echo that was sure and nearly touched."""
        if len(self._pings) < 2:
            return
        before, last = self._pings[-2], self._pings[-1]
        sure = before.echo and last.echo and self._compare(before, last, walk=False) == 0
        if sure and last.distance < self._live.config.touch_distance and self._compare(last, ping) > 0:
            self._lost = (last.place, last.distance)
        elif ping.echo and ping.distance < self._live.config.touch_distance:
            self._lost = None  # it is there again

    def _follows(self, one: Ping, other: Ping) -> bool:
        """Whether `other` may show what `one` did."""
        return self._compare(one, other) == 0

    def _walked(self, one: Ping, other: Ping) -> float:
        """m that a person may have walked between two readings."""
        return self._live.config.person_speed * abs(other.robot_ns - one.robot_ns) * 1e-9

    def _compare(self, one: Ping, other: Ping, *, walk: bool = True) -> int:
        """Whether `other` shows something nearer (-1) or farther (1) than `one` did, or it may be the same (0).

        The same is what the robot's motion, a person's `walk` and, while it turns, a slanted surface explain.
        """
        expected = one.distance - one.place.ahead(other.place, self.pose.yaw)
        turned = one.distance * abs(other.place.yaw - one.place.yaw)
        slack = self._live.config.range_tolerance + turned + (self._walked(one, other) if walk else 0.0)
        if other.distance > expected + slack:
            return 1
        return -1 if other.distance < expected - slack else 0

"""Localization: `odom`, and `scan/*` or `range/*`, to `pose`. Losing it changes no motion that does not ask for it."""

from typing import Final

from giraff_core.io import IO, Inbox
from giraff_core.robot import RobotConfig
from giraff_core.senses import LaserScanner
from giraff_core.timer import Timer
from giraff_localization.config import LocalizationConfig
from giraff_localization.floor import Floor
from giraff_localization.policy import LocalizationPolicy
from giraff_maps.floor_plan import FloorPlan
from giraff_schemas.frames import ODOM_FRAME
from giraff_schemas.messages import Range
from giraff_schemas.scan import LaserScan
from giraff_schemas.topics import (
    LOCALIZATION_GLOBAL,
    LOCALIZATION_SET_POSE,
    MAP,
    ODOM,
    PARTICLES,
    POSE,
    RANGE,
    SCAN,
)
from giraff_schemas.trouble import NO_TROUBLE, Trouble

SILENCE: Final = 1.0
"""s without a sample that is worth a word."""


class Localization:
    """Reads `odom` and the sensors; writes `pose`, `particles` and `map`, and tells where `odom` is in `map`."""

    link = None

    def __init__(
        self, io: IO, config: LocalizationConfig, robot: RobotConfig, plan: FloorPlan | Floor | Trouble, seed: int = 0
    ) -> None:
        """`plan`: as of its policy."""
        self._io = io
        self._policy = LocalizationPolicy(config, robot, plan, seed)
        io.frame(ODOM_FRAME, self._policy.transform)
        # Only odometry wakes: a hundred times a second it makes a turn due, in which a part of the computing is done.
        self._odometry = io.inbox(ODOM)
        self._senses: list[Inbox[Range] | Inbox[LaserScan]] = [io.inbox(RANGE, wakes=False)]
        self._publishers = {"odom": "odometry", "range": "ranger"}
        if robot.of(LaserScanner):
            self._senses.append(io.inbox(SCAN, wakes=False))
            self._publishers = {"odom": "odometry", "scan": "scan"}
        self._poses, self._globals = io.requests(LOCALIZATION_SET_POSE), io.requests(LOCALIZATION_GLOBAL)
        self._pose, self._particles, self._map = io.publisher(POSE), io.publisher(PARTICLES), io.publisher(MAP)
        self._pose_timer, self._particles_timer, self._map_timer = self.timers = tuple(
            Timer(topic.rate_hz) for topic in (POSE, PARTICLES, MAP)
        )
        self._heard = dict.fromkeys(self._publishers, io.monotonic())

    def turn(self, now: float) -> None:
        policy = self._policy
        self._read_inboxes(now)
        for told in self._poses.pop_all():
            told.answer(policy.on_set_pose(told.request))
        for wish in self._globals.pop_all():
            wish.answer(policy.on_global(wish.request))
        policy.work()
        if self._pose_timer.due(now):
            self._pose.put(policy.pose())
        if self._particles_timer.due(now):
            self._particles.put(policy.particles())
        if self._map_timer.due(now):
            self._map.put(policy.walls())
        for topic, service in self._publishers.items():
            silent = Trouble(f"no {topic} is heard", f"check that giraff_{service} runs")
            self._io.set_notice(topic, silent if now - self._heard[topic] > SILENCE else NO_TROUBLE)
        self._io.set_fault("map", policy.no_map)

    def _read_inboxes(self, now: float) -> None:
        policy = self._policy
        for odometry in self._odometry.pop_all():
            self._heard["odom"] = now
            policy.on_odometry(odometry)
        for sense in self._senses:
            for sample in sense.pop_all():
                self._heard["range" if isinstance(sample, Range) else "scan"] = now
                policy.on_sample(sample)
        if now - self._heard["odom"] > SILENCE:
            policy.on_silence()

    def end(self) -> None:
        """Nothing is left to say."""

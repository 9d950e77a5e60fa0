"""Localization: `odom` and `range/*` to `pose`. Not in the chain that drives: losing it changes no motion."""

from typing import Final

from giraff_core.io import IO
from giraff_core.robot import RobotConfig
from giraff_core.timer import Timer
from giraff_localization.config import LocalizationConfig
from giraff_localization.floor import Floor
from giraff_localization.policy import LocalizationPolicy
from giraff_maps.floor_plan import FloorPlan
from giraff_schemas.frames import ODOM_FRAME
from giraff_schemas.topics import (
    LOCALIZATION_GLOBAL,
    LOCALIZATION_SET_POSE,
    MAP,
    ODOM,
    PARTICLES,
    POSE,
    RANGE,
)
from giraff_schemas.trouble import NO_TROUBLE, Trouble

SILENCE: Final = 1.0
"""s without a sample that is worth a word."""
_SPOKEN_BY: Final = {"odom": "odometry", "range": "ranger"}


class Localization:
    """Reads `odom` and `range/*`; writes `pose`, `particles` and `map`, and tells where `odom` is in `map`."""

    link = None

    def __init__(
        self, io: IO, config: LocalizationConfig, robot: RobotConfig, plan: FloorPlan | Floor | Trouble, seed: int = 0
    ) -> None:
        """`plan`: as of its policy."""
        self._io = io
        self._policy = LocalizationPolicy(config, robot, plan, seed)
        io.frame(ODOM_FRAME, self._policy.transform)
        # Only odometry wakes: a hundred times a second it makes a turn due, in which a part of the computing is done.
        self._odometry, self._ranges = io.inbox(ODOM), io.inbox(RANGE, wakes=False)
        self._poses, self._globals = io.requests(LOCALIZATION_SET_POSE), io.requests(LOCALIZATION_GLOBAL)
        self._pose, self._particles, self._map = io.publisher(POSE), io.publisher(PARTICLES), io.publisher(MAP)
        self._pose_timer, self._particles_timer, self._map_timer = self.timers = tuple(
            Timer(topic.rate_hz) for topic in (POSE, PARTICLES, MAP)
        )
        self._heard = {"odom": io.monotonic(), "range": io.monotonic()}

    def turn(self, now: float) -> None:
        policy = self._policy
        for odometry in self._odometry.pop_all():
            self._heard["odom"] = now
            policy.on_odometry(odometry)
        for reading in self._ranges.pop_all():
            self._heard["range"] = now
            policy.on_sample(reading)
        if now - self._heard["odom"] > SILENCE:
            policy.on_silence()
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
        for topic, service in _SPOKEN_BY.items():
            silent = Trouble(f"no {topic} is heard", f"check that giraff_{service} runs")
            self._io.set_notice(topic, silent if now - self._heard[topic] > SILENCE else NO_TROUBLE)
        self._io.set_fault("map", policy.no_map)

    def end(self) -> None:
        """Nothing is left to say."""

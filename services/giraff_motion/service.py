"""Motion: requests, `odom` and what the robot says of itself to `cmd_vel/<operator>` and `motion`."""

from __future__ import annotations

from typing import Final

from giraff_core.io import IO
from giraff_core.robot import RobotConfig
from giraff_core.timer import PromptTimer
from giraff_motion.config import MotionConfig
from giraff_motion.policy import MotionPolicy
from giraff_schemas.services import MOTION as MOTION_ROW
from giraff_schemas.topics import (
    BASE,
    ESTOP,
    GUARD,
    LEASE,
    MOTION,
    MOTION_ARC,
    MOTION_CANCEL,
    MOTION_GO,
    MOTION_HOLD,
    MOTION_MOVE,
    MOTION_TURN,
    ODOM,
    OPERATOR_CMD_VEL,
    POSE,
    TICK,
)

_LATE: Final = 50
"""Samples between two turns of which none is left out: half a second of odometry."""


class Motion:
    """Answers `motion/move`, `turn`, `arc`, `go` and `cancel`; goes by `motion/hold` of whoever has asked."""

    link = None

    def __init__(
        self, io: IO, config: MotionConfig, robot: RobotConfig, policy: type[MotionPolicy] = MotionPolicy
    ) -> None:
        self._io = io
        self._policy = policy(config, robot, io.instance)
        io.on_reconfigured = self._policy.reconfigure
        # None of them wakes: its own pace is as fast as any of them may count.
        self._ticks, self._leases = io.inbox(TICK, limit=1, wakes=False), io.inbox(LEASE, limit=10, wakes=False)
        self._odometry = io.inbox(ODOM, limit=_LATE, wakes=False)
        self._bases, self._guards = io.inbox(BASE, limit=1, wakes=False), io.inbox(GUARD, limit=1, wakes=False)
        self._poses = io.inbox(POSE, limit=10, wakes=False)
        self._estops = io.inbox(ESTOP, limit=10, wakes=False)
        self._holds = io.inbox(MOTION_HOLD, limit=_LATE, wakes=False)
        self._requests = (
            io.requests(MOTION_MOVE),
            io.requests(MOTION_TURN),
            io.requests(MOTION_ARC),
            io.requests(MOTION_GO),
        )
        self._cancels = io.requests(MOTION_CANCEL)
        self._commands = io.publisher(OPERATOR_CMD_VEL.at(MOTION_ROW.name))
        self._states = io.publisher(MOTION)
        self._timer, self._state_timer = PromptTimer(OPERATOR_CMD_VEL.rate_hz), PromptTimer(MOTION.rate_hz)
        self.timers = (self._timer,)

    def turn(self, now: float) -> None:
        policy = self._policy
        self._hear(now)
        self._answer(now)
        if self._timer.due(now) and (command := policy.command(now)) is not None:
            self._commands.put(command)
        if policy.has_news():
            self._state_timer.hurry("news", now)
        if self._state_timer.due(now):
            self._states.put(policy.state(now))

    def _hear(self, now: float) -> None:
        policy = self._policy
        for tick in self._ticks.take():
            policy.on_tick(tick, now)
        for lease in self._leases.take():
            policy.on_lease(lease, now)
        for hold in self._holds.take():
            policy.on_hold(hold)
        for odometry in self._odometry.take():
            policy.on_odometry(odometry, now)
        for pose in self._poses.take():
            policy.on_pose(pose, now)
        for base in self._bases.take():
            policy.on_base(base, now)
        for estop in self._estops.take():
            policy.on_estop(estop)
        for guard in self._guards.take():
            policy.on_guard(guard, now)

    def _answer(self, now: float) -> None:
        policy = self._policy
        for requests in self._requests:
            for asked in requests.take():
                asked.answer(policy.on_request(asked.request, now))
        for cancel in self._cancels.take():
            cancel.answer(policy.on_cancel(cancel.request, now))
            self._timer.hurry("cancel", now)

    def end(self) -> None:
        """Let go of the robot."""
        if (command := self._policy.final_command()) is not None:
            self._commands.put(command)

"""Motion: requests, `odom` and what the robot says of itself to `cmd_vel/<operator>` and `motion`."""

from typing import Final

from giraff_core.io import IO
from giraff_core.live import Live
from giraff_core.operator import Fault, OperatorService, Wish
from giraff_core.robot import RobotConfig
from giraff_core.timer import EarlyTimer
from giraff_motion.config import MotionConfig
from giraff_motion.policy import MotionPolicy
from giraff_schemas.messages import Lease
from giraff_schemas.topics import (
    BASE,
    ESTOP,
    GUARD,
    MAP,
    MOTION,
    MOTION_ARC,
    MOTION_CANCEL,
    MOTION_GO,
    MOTION_HOLD,
    MOTION_MOVE,
    MOTION_TURN,
    ODOM,
    POSE,
)

_LATE: Final = 50
"""Samples between two turns of which none is left out: half a second of odometry."""


class Motion(OperatorService):
    """Answers `motion/move`, `turn`, `arc`, `go` and `cancel`; goes by `motion/hold` of whoever has asked."""

    def __init__(
        self, io: IO, config: MotionConfig, robot: RobotConfig, policy: type[MotionPolicy] = MotionPolicy
    ) -> None:
        self._io = io
        live = Live(config)
        self._policy = policy(live, robot, io.instance)
        io.on_reconfigured = live.replace
        # Nothing heard wakes it: its own pace is as fast as any of it may count.
        super().__init__(io, self._policy, wakes=False)
        self._odometry = io.inbox(ODOM, limit=_LATE, wakes=False)
        self._bases, self._guards = io.inbox(BASE, limit=1, wakes=False), io.inbox(GUARD, limit=1, wakes=False)
        self._poses, self._maps = io.inbox(POSE, limit=10, wakes=False), io.inbox(MAP, limit=1, wakes=False)
        self._estops = io.inbox(ESTOP, limit=10, wakes=False)
        self._holds = io.inbox(MOTION_HOLD, limit=_LATE, wakes=False)
        self._requests = (
            io.requests(MOTION_MOVE),
            io.requests(MOTION_TURN),
            io.requests(MOTION_ARC),
            io.requests(MOTION_GO),
        )
        self._cancels = io.requests(MOTION_CANCEL)
        self._states = io.publisher(MOTION)
        self._state_timer = EarlyTimer(MOTION.rate_hz)

    def turn(self, now: float) -> None:
        policy = self._policy
        self.read_inboxes(now)
        self._answer(now)
        self.say(now)
        if policy.has_news():
            self._state_timer.fire_now("news", now)
        if self._state_timer.due(now):
            self._states.put(policy.state(now))

    def read_inboxes(self, now: float) -> None:
        super().read_inboxes(now)
        policy = self._policy
        for hold in self._holds.pop_all():
            policy.on_hold(hold)
        for odometry in self._odometry.pop_all():
            policy.on_odometry(odometry, now)
        for pose in self._poses.pop_all():
            policy.on_pose(pose, now)
        for plan in self._maps.pop_all():
            policy.on_map(plan)
        for base in self._bases.pop_all():
            policy.on_base(base, now)
        for estop in self._estops.pop_all():
            policy.on_estop(estop)
        for guard in self._guards.pop_all():
            policy.on_guard(guard, now)

    def _answer(self, now: float) -> None:
        policy = self._policy
        for requests in self._requests:
            for asked in requests.pop_all():
                asked.answer(policy.on_request(asked.request, now))
        for cancel in self._cancels.pop_all():
            cancel.answer(policy.on_cancel(cancel.request, now))
            self.timer.fire_now("cancel", now)

    def on_lease(self, lease: Lease, now: float) -> None:
        self._policy.on_lease(lease, now)

    def on_said(self, asked: Wish | Fault, now: float) -> None:
        """Whoever has asked for the motion is told why it does not go on: it is no news of the service."""

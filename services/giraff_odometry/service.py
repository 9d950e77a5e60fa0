"""Odometry: `wheels` to `odom`. Not in the chain that drives: losing it changes no motion."""

from typing import Final

from giraff_core.io import IO
from giraff_core.kinematics.echoes import Echoes
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_core.senses import Ultrasonic
from giraff_odometry.config import OdometryConfig
from giraff_odometry.policy import OdometryPolicy
from giraff_schemas.frames import BASE_FRAME
from giraff_schemas.topics import ODOM, ODOM_ECHOES, ODOM_RESET, ODOM_SET_POSE, RANGE, WHEELS
from giraff_schemas.trouble import NO_TROUBLE, Trouble

SILENCE: Final = 1.0
"""s without a sample that is worth a word."""
SETTLED: Final = 1.0
"""s without a notice after which it is over: one that flickers is told once."""
_NO_WHEELS: Final = Trouble("no wheels from base", "check that base runs and sees its board")


class Odometry:
    """Reads `wheels`; writes `odom`, answers where the robot is in it, and sets that to where it is said to be.

    It owns `base_link`, and so tells where the robot's parts are, too, but for the sensors. It keeps where echoes came
    from, so that a view that is opened late begins with them.
    """

    timers = ()
    link = None

    def __init__(
        self, io: IO, config: OdometryConfig, robot: RobotConfig, policy: type[OdometryPolicy] = OdometryPolicy
    ) -> None:
        self._io = io
        live = Live(config)
        self._policy = policy(live, robot)
        io.on_reconfigured = live.replace
        io.frame(BASE_FRAME, self._policy.transform)
        for part in self._policy.parts():
            io.frame(part.child, part)
        self._wheels, self._out = io.inbox(WHEELS), io.publisher(ODOM)
        self._resets, self._poses = io.requests(ODOM_RESET), io.requests(ODOM_SET_POSE)
        self._echoes, self._asked = Echoes(robot.of(Ultrasonic)), io.requests(ODOM_ECHOES)
        self._ranges = io.inbox(RANGE, wakes=False)
        self._heard = self._noticed = io.monotonic()

    def turn(self, now: float) -> None:
        policy = self._policy
        for sample in self._wheels.pop_all():
            self._heard = now
            if (odometry := policy.on_wheels(sample)) is not None:
                self._out.put(odometry)
                self._echoes.on_odometry(odometry)
            if policy.notice:
                self._noticed = now
                self._io.set_notice("counters", policy.notice)
        for reset in self._resets.pop_all():
            reset.answer(policy.on_reset(reset.request))
        for pose in self._poses.pop_all():
            pose.answer(policy.on_set_pose(pose.request))
        for reading in self._ranges.pop_all():
            self._echoes.add(reading)
        for asked in self._asked.pop_all():
            asked.answer(self._echoes.map(self._io.instance))
        if now - self._noticed > SETTLED:
            self._io.set_notice("counters", NO_TROUBLE)
        is_silent = now - self._heard > SILENCE
        self._io.set_notice("wheels", _NO_WHEELS if is_silent else NO_TROUBLE)

    def end(self) -> None:
        """Nothing is left to say."""

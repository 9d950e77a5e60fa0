"""From the encoders' counters to a pose that never jumps, unless it is told to.

Counters and board time wrap at 32 bits and start anew with the board. Whatever breaks them off (another boot, another
base, a leap that no wheel can make) costs certainty, never continuity: the pose stays, its covariance grows. A gap
within one boot loses nothing of the wheels' travel, but the way between is taken for a single arc: it costs certainty
too, in proportion to that travel.
"""

import math
from collections import deque
from typing import Final

from giraff_core.bounds import Bounds
from giraff_core.counters import SLACK_TICKS, Standstill, elapsed_us, restart, signed32
from giraff_core.kinematics.calibration import Covariance
from giraff_core.kinematics.dead_reckoning import Estimate, advance, less_sure, wrapped
from giraff_core.kinematics.pose import Pose
from giraff_core.kinematics.systematic_error import SystematicError
from giraff_core.live import Live
from giraff_core.robot import RobotConfig
from giraff_odometry.config import OdometryConfig
from giraff_schemas.frames import BASE_FRAME, ODOM_FRAME, Transform
from giraff_schemas.messages import Odometry, Wheels
from giraff_schemas.requests import OdomAnswer, OdomReset, OdomSetPose
from giraff_schemas.trouble import NO_TROUBLE, Trouble

__all__ = ["Estimate", "OdometryPolicy", "advance"]

_REMEMBERED: Final = 16
"""Wishes that are not done again when they are asked again."""
_SETTABLE: Final = {
    "x": Bounds(-1e6, 1e6, "m"),
    "y": Bounds(-1e6, 1e6, "m"),
    "yaw": Bounds(-1e4, 1e4, "rad"),
    "position_sd": Bounds(0.0, 1e4, "m"),
    "yaw_sd": Bounds(0.0, math.tau, "rad"),
}
"""What a pose may be set to: far more than a robot needs, and what is squared and summed stays exact and finite."""

# Without numbers: a fault that repeats with each sample is then one fault, told once.
_LEAP: Final = Trouble(
    "a wheel leapt farther than max_wheel_speed allows, which was not believed",
    "check the encoders' cables, and ticks_per_metre in the robot file",
)
_GAP: Final = Trouble("wheels came after a gap", "check the network between base and odometry")
_TOO_FAST: Final = Trouble(
    "a wheel's speed is above max_wheel_speed: its travel is gone by", "check the encoders' cables"
)


class OdometryPolicy:
    """Follows one robot's wheels; starts at zero."""

    def __init__(self, live: Live[OdometryConfig], robot: RobotConfig) -> None:
        self._live = live
        self._robot, self._drive = robot, robot.kinematics
        self._last: Wheels | None = None
        self._standstill = Standstill()
        self._systematic = SystematicError(robot.calibration, self._drive)
        self._granted: deque[int] = deque(maxlen=_REMEMBERED)
        self.estimate = Estimate()
        self.jumps = 0
        """How often the pose was set from outside."""
        self.breaks = 0
        """How often the counters could not be followed, or only over a gap."""
        self.notice = NO_TROUBLE
        """What was wrong with the newest sample."""

    def transform(self) -> Transform:
        """Where the robot is now; safe to ask from any thread."""
        now, last = self.estimate, self._last
        tick = None if last is None else last.tick
        return Transform(parent=ODOM_FRAME, child=BASE_FRAME, x=now.x, y=now.y, yaw=now.yaw, fixed=False, tick=tick)

    def parts(self) -> list[Transform]:
        """Where the parts of the robot are that have a frame of their own."""
        return [part.transform(name) for name, part in self._robot.frames.items()]

    def on_wheels(self, wheels: Wheels) -> Odometry | None:
        """Where the robot is at this sample; None when it repeats one already taken, or is older."""
        self._standstill.on_wheels(wheels)
        self.notice = NO_TROUBLE
        last = self._last
        if last is None:
            self._last = wheels
            return self._odometry(wheels, 0.0, 0.0)
        if notice := restart(last, wheels):
            return self._rebase(wheels, notice)
        elapsed = elapsed_us(last, wheels) / 1e6
        if not elapsed:
            return None
        left = signed32(wheels.left_ticks - last.left_ticks) / self._robot.left_ticks_per_metre
        right = signed32(wheels.right_ticks - last.right_ticks) / self._robot.right_ticks_per_metre
        farther, fastest = max(abs(left), abs(right)), self._live.config.max_wheel_speed
        if farther > fastest * elapsed + SLACK_TICKS / self._robot.ticks_per_metre:
            return self._rebase(wheels, _LEAP)
        self._last = wheels
        rests = self._standstill.is_rest
        noise = 0.0 if rests else self._robot.wheel_noise  # an encoder that flickers at rest makes no doubt
        self.estimate = advance(self.estimate, left, right, self._drive, noise)
        self._systematic.advance(left, right)
        if elapsed > self._live.config.max_gap:
            self._lose_certainty(farther / 2.0, 0.0, _GAP)
        if rests:
            return self._odometry(wheels, 0.0, 0.0)
        if max(abs(wheels.left_velocity), abs(wheels.right_velocity)) > fastest:
            self.notice = self.notice or _TOO_FAST
            return self._odometry(wheels, *self._drive.twist(left / elapsed, right / elapsed))
        return self._odometry(wheels, *self._drive.twist(wheels.left_velocity, wheels.right_velocity))

    def on_reset(self, request: OdomReset) -> OdomAnswer:
        """Begin anew here."""
        return self._jump(request.id, Estimate())

    def on_set_pose(self, request: OdomSetPose) -> OdomAnswer:
        """Be there; the path goes on."""
        try:
            for name, bounds in _SETTABLE.items():
                bounds.require(name, getattr(request, name))
        except ValueError as error:
            return OdomAnswer(done=False, jumps=self.jumps, reason=Trouble(str(error)))
        place = Estimate(x=request.x, y=request.y, yaw=wrapped(request.yaw), path=self.estimate.path)
        return self._jump(request.id, less_sure(place, request.position_sd, request.yaw_sd))

    def _jump(self, wish: int, estimate: Estimate) -> OdomAnswer:
        if wish not in self._granted:
            self._granted.append(wish)
            self.jumps += 1
            self.estimate = estimate
            self._systematic.begin(Pose(estimate.x, estimate.y, estimate.yaw))
        return OdomAnswer(done=True, jumps=self.jumps)

    def _rebase(self, wheels: Wheels, notice: Trouble) -> Odometry:
        self._last = wheels
        self._lose_certainty(self._live.config.lost_position, self._live.config.lost_yaw, notice)
        return self._odometry(wheels, 0.0, 0.0)

    def _lose_certainty(self, position: float, yaw: float, notice: Trouble) -> None:
        self.estimate = less_sure(self.estimate, position, yaw)
        self.breaks += 1
        self.notice = notice

    def _covariance(self) -> Covariance:
        """Of what is random and what is systematic, which do not depend on each other."""
        xx, xy, xt, yy, yt, tt = self.estimate.covariance
        sxx, sxy, sxt, syy, syt, stt = self._systematic.covariance()
        return xx + sxx, xy + sxy, xt + sxt, yy + syy, yt + syt, tt + stt

    def _odometry(self, wheels: Wheels, linear_x: float, angular_z: float) -> Odometry:
        return Odometry(
            x=self.estimate.x,
            y=self.estimate.y,
            yaw=self.estimate.yaw,
            linear_x=linear_x,
            angular_z=angular_z,
            covariance=self._covariance(),
            path=self.estimate.path,
            board_us=wheels.board_us,
            boot_id=wheels.boot_id,
            tick=wheels.tick,
            jumps=self.jumps,
            breaks=self.breaks,
        )

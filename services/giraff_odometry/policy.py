"""From the encoders' counters to a pose that never jumps.

Counters and board time wrap at 32 bits and start anew with the board. Whatever breaks them off (another boot, another
base, a leap that no wheel can make) costs certainty, never continuity: the pose stays, its covariance grows. A gap
within one boot loses nothing of the wheels' travel, but the way between is taken for a single arc: it costs certainty
too, in proportion to that travel.
"""

from __future__ import annotations

from typing import Final

from giraff_core.counters import signed32
from giraff_core.robot import RobotConfig
from giraff_odometry.config import OdometryConfig
from giraff_odometry.dead_reckoning import Estimate, advance, less_sure
from giraff_schemas.frames import BASE_FRAME, ODOM_FRAME, Transform
from giraff_schemas.messages import Odometry, Wheels

__all__ = ["Estimate", "OdometryPolicy", "advance"]

_WRAP: Final = 1 << 32
_HALF_WRAP: Final = 1 << 31
_SLACK_TICKS: Final = 4
"""Added to what a wheel may travel between two samples: counts come whole, and the board's time is not exact."""

# Without numbers: a fault that repeats with each sample is then one fault, told once.
_NEW_BOOT: Final = "the base board has started again; if nobody reset it, check its supply"
_NEW_BASE: Final = "wheels come from another base process; if it was not restarted, end the second one"
_LEAP: Final = (
    "a wheel leapt farther than max_wheel_speed allows, which was not believed; check the encoders' cables, "
    "and ticks_per_metre in the robot file"
)
_GAP: Final = "wheels came after a gap; check the network between base and odometry"
_LONG_GAP: Final = "no wheels for so long that the board's time may have wrapped; check base and the network"


class OdometryPolicy:
    """Follows one robot's wheels; starts at zero."""

    def __init__(self, config: OdometryConfig, robot: RobotConfig) -> None:
        self._config = config
        self._robot, self._drive = robot, robot.drive
        self._last: Wheels | None = None
        self.estimate = Estimate()
        self.breaks = 0
        """How often the counters could not be followed, or only over a gap."""
        self.notice = ""
        """What was wrong with the newest sample, and what to do; empty when nothing was."""

    def transform(self) -> Transform:
        """Where the robot is now; safe to ask from any thread."""
        now = self.estimate
        return Transform(parent=ODOM_FRAME, child=BASE_FRAME, x=now.x, y=now.y, yaw=now.yaw, fixed=False)

    def reconfigure(self, config: OdometryConfig) -> None:
        """Use a new configuration."""
        self._config = config

    def on_wheels(self, wheels: Wheels) -> Odometry | None:
        """Where the robot is at this sample; None when it repeats one already taken, or is older."""
        self.notice = ""
        last = self._last
        if last is None:
            self._last = wheels
            return self._odometry(wheels, 0.0, 0.0)
        if notice := _restart(last, wheels):
            return self._rebase(wheels, notice)
        elapsed_us = (wheels.board_us - last.board_us) % _WRAP
        if not 0 < elapsed_us < _HALF_WRAP:
            return None
        elapsed = elapsed_us / 1e6
        scale = self._robot.ticks_per_metre
        left = signed32(wheels.left_ticks - last.left_ticks) / scale
        right = signed32(wheels.right_ticks - last.right_ticks) / scale
        farther = max(abs(left), abs(right))
        if farther > self._config.max_wheel_speed * elapsed + _SLACK_TICKS / scale:
            return self._rebase(wheels, _LEAP)
        self._last = wheels
        self.estimate = advance(self.estimate, left, right, self._drive, self._config.wheel_noise)
        if elapsed > self._config.max_gap:
            self._lose_certainty(farther / 2.0, 0.0, _GAP)
        distance, turn = self._drive.twist(left, right)
        return self._odometry(wheels, distance / elapsed, turn / elapsed)

    def _rebase(self, wheels: Wheels, notice: str) -> Odometry:
        self._last = wheels
        self._lose_certainty(self._config.lost_position, self._config.lost_yaw, notice)
        return self._odometry(wheels, 0.0, 0.0)

    def _lose_certainty(self, position: float, yaw: float, notice: str) -> None:
        self.estimate = less_sure(self.estimate, position, yaw)
        self.breaks += 1
        self.notice = notice

    def _odometry(self, wheels: Wheels, linear_x: float, angular_z: float) -> Odometry:
        return Odometry(
            x=self.estimate.x,
            y=self.estimate.y,
            yaw=self.estimate.yaw,
            linear_x=linear_x,
            angular_z=angular_z,
            covariance=self.estimate.covariance,
            path=self.estimate.path,
            board_us=wheels.board_us,
            boot_id=wheels.boot_id,
            tick=wheels.tick,
        )


def _restart(last: Wheels, wheels: Wheels) -> str:
    """Why the counters of `wheels` do not go on from those of `last`; empty when they do."""
    if wheels.boot_id != last.boot_id:
        return _NEW_BOOT
    if wheels.instance != last.instance:
        return _NEW_BASE
    # The board's own time says "newer" for half its range only; the robot's clock does not wrap.
    if wheels.tick.robot_ns - last.tick.robot_ns >= _HALF_WRAP * 1000:
        return _LONG_GAP
    return ""

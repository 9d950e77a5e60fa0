"""Where the robot truly is, where odometry says it is, and how far these are apart. SI units."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import Final, NamedTuple

from giraff_core.kinematics.pose import Pose
from giraff_schemas.messages import Odometry
from giraff_sim.bodies.registry import DrawnBody
from giraff_sim.world.body import Balance

_KEPT: Final = 200  # odometry samples: two seconds, more than lie between two looks at the truth


_REST: Final = 1e-3  # m/s, rad/s


@dataclass(frozen=True)
class Truth:
    """The simulated robot as the world has it."""

    robot_ns: int
    """Robot's clock when the world was asked."""
    simulated_us: int
    pose: Pose
    speed: float
    """m/s, forward positive."""
    turn: float
    """rad/s, counter-clockwise positive."""
    path: float
    """m that the robot's centre has moved."""
    closest: float
    """m; the smallest clearance to anything so far."""
    contacts: int
    """How often the robot came to touch something."""
    balance: Balance | None = None
    """Of a robot that can fall over. Such a one is never quite still."""
    drawn: DrawnBody | None = None
    """How its body differs from its file, where the simulator's truth does not say it."""

    @property
    def is_at_rest(self) -> bool:
        if self.balance is not None:
            return self.balance.is_settled
        return abs(self.speed) < _REST and abs(self.turn) < _REST


class OdometryError(NamedTuple):
    """Odometry's error at one moment."""

    distance: float
    """m."""
    angle: float
    """rad, never negative."""
    x: float = 0.0
    """m that odometry is too far along the axis of its frame."""
    y: float = 0.0
    """The same of the other axis."""


class Comparison:
    """Odometry against the truth at the same moment, each from where it was when both were first known.

    The two are not heard at the same moments: odometry is interpolated to the moment of each truth, as soon as
    samples from both sides of it are there.
    """

    def __init__(self) -> None:
        self.apart: OdometryError | None = None
        """At the newest truth that odometry reaches up to; None: at none of late."""
        self._samples: deque[Odometry] = deque(maxlen=_KEPT)
        self._waiting: Truth | None = None
        self._origins: tuple[Pose, Pose] | None = None

    def on_sample(self, sample: Odometry) -> None:
        if self._samples and self._samples[-1].segment != sample.segment:
            # A restarted odometry begins anew wherever the robot then is, one whose pose was set goes on from there.
            self._samples.clear()
            self._origins = None
        self._samples.append(sample)

    def see(self, truth: Truth) -> None:
        if self._waiting is not None:
            odometry = self._at(self._waiting.robot_ns)
            self.apart = None if odometry is None else self._compare(odometry, self._waiting.pose)
        self._waiting = truth

    def in_odom(self, truth: Pose) -> Pose | None:
        """A true pose in the frame of odometry; None: odometry has not begun."""
        if self._origins is None:
            return None
        odometry, origin = self._origins
        return truth.seen_from(origin).placed_in(odometry)

    def _compare(self, odometry: Pose, truth: Pose) -> OdometryError:
        if self._origins is None:
            self._origins = odometry, truth
        true = self.in_odom(truth) or odometry
        x, y = odometry.x - true.x, odometry.y - true.y
        return OdometryError(math.hypot(x, y), abs(odometry.seen_from(true).yaw), x, y)

    def _at(self, robot_ns: int) -> Pose | None:
        later: Odometry | None = None
        for sample in reversed(self._samples):
            if sample.tick.robot_ns <= robot_ns:
                return None if later is None else _between(sample, later, robot_ns)
            later = sample
        return None


def _between(before: Odometry, after: Odometry, robot_ns: int) -> Pose:
    share = (robot_ns - before.tick.robot_ns) / (after.tick.robot_ns - before.tick.robot_ns)
    return Pose(before.x, before.y, before.yaw).towards(Pose(after.x, after.y, after.yaw), share)

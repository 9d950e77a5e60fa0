"""A drawn Ardros on a drive of ten seconds: what it does of what it is asked, and what odometry makes of it."""

import math
import statistics
from typing import Final, NamedTuple

import msgspec

from giraff_core.kinematics.calibration import Calibration
from giraff_core.kinematics.pose import ELLIPSE_95, mahalanobis
from giraff_sim.truth import draw_truth
from tests.loop.loops import FULL_TILT, arm, closed_loop, hold
from tests.sim.robots import proving_room
from tests.support.ardros import ARDROS, SIM

_WHEEL: Final = SIM.truth.calibrated_wheel_scale / math.sqrt(3.0)
_TRACK: Final = SIM.truth.calibrated_track_scale / math.sqrt(3.0)
_CALIBRATION: Final = Calibration(date="2026-11-27", covariance=(_WHEEL**2, 0.0, 0.0, _WHEEL**2, 0.0, _TRACK**2))
"""It doubts as much as a calibrated robot is drawn from: evenly, within a share to either side."""
CALIBRATED: Final = msgspec.structs.replace(
    ARDROS, robot=msgspec.structs.replace(ARDROS.robot, calibration=_CALIBRATION)
)
LEGS: Final = ((-3.2, 1.8, 2.5), (0.0, -3.0, 1.5), (4.0, 2.2, 2.5))
"""After three seconds straight ahead: tilt x and y (m/s²), s. Backward, in place, and a curve forward."""
_SPEEDS_UP: Final = 2.0
_STEADY: Final = 1.0  # s
_SAMPLES: Final = 25
_WAY: Final = 2.0  # m
_SLOWER: Final = 0.03


class Drive(NamedTuple):
    contacts: int
    path: float
    """m."""
    off: float
    """Standard deviations, of its own, by which odometry has the place wrong."""
    speed: float
    """Of what was asked: how fast the robot truly was, straight ahead at full tilt."""


def drive(seed: int) -> Drive:
    """Drive the calibrated robot of this seed."""
    truth = draw_truth("calibrated", SIM.truth, seed, _CALIBRATION)
    with closed_loop(proving_room(), CALIBRATED, sim=SIM, seed=seed, truth=truth) as loop:
        plant = loop.simulation.world.plant
        arm(loop)
        hold(loop, FULL_TILT)
        loop.run(_SPEEDS_UP)
        shares = []
        for _ in range(_SAMPLES):
            loop.run(_STEADY / _SAMPLES)
            shares.append(plant.speed / loop.newest["cmd_vel"].linear_x)
        for x, y, seconds in LEGS:
            hold(loop, x, y)
            loop.run(seconds)
        hold(loop)
        loop.run(0.5)
        odom, pose = loop.newest["odom"], plant.pose
        xx, xy, _, yy, _, _ = odom.covariance
        off = mahalanobis(odom.x - pose.x, odom.y - pose.y, xx, xy, yy)
        return Drive(plant.contacts, plant.path_length, off, statistics.fmean(shares))


def require_sound(seed: int) -> Drive:
    """Fail where a drive touches something, is lost by more than odometry says, or is not as fast as it is asked."""
    done = drive(seed)
    assert done.contacts == 0
    assert done.path > _WAY
    assert done.off <= ELLIPSE_95
    assert abs(done.speed - 1.0) <= _SLOWER
    return done

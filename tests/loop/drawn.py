"""A drawn robot of a robot file on a drive of ten seconds: what it does of what it is asked, and odometry of it."""

import statistics
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final, NamedTuple

import msgspec
import pytest

from giraff_base.drives.wheels.config import WheelControl
from giraff_core.kinematics.calibration import Calibration
from giraff_core.kinematics.pose import ELLIPSE_95, mahalanobis
from giraff_sim.closed_loop import ClosedLoop
from giraff_sim.truth import draw_truth
from tests.loop.loops import FULL_TILT, arm, closed_loop, hold
from tests.sim.robots import proving_room
from tests.support.robot_files import ROBOTS

LEGS: Final = ((-3.2, 1.8, 2.5), (0.0, -3.0, 1.5), (4.0, 2.2, 2.5))
"""After three seconds straight ahead: tilt x and y (m/s²), s. Backward, in place, and a curve forward."""
_SPEEDS_UP: Final = 2.0
_STEADY: Final = 1.0  # s
_SAMPLES: Final = 25
_WAY: Final = 2.0  # m, of a robot of 0.6 m/s
_SLOWER: Final = {"roboclaw": 0.02}
_SLOWEST: Final = 0.03
_SLOW: Final = 0.05  # m/s
_SLOW_TILT: Final = 1.85  # m/s², of a joystick that feels it as it is
_TILT_OF_SPEED: Final = 3.0  # m/s² for m/s
_MAKES: Final = {
    "speed": 0.8,
    "level": 0.4,
}  # of it, with a hand that is not still; at a level a weak motor hardly turns
_CREEPS: Final = 10.0  # s


class Drive(NamedTuple):
    contacts: int
    path: float
    """m."""
    off: float
    """Standard deviations, of its own, by which odometry has the place wrong."""
    speed: float
    """Of what was asked: how fast the robot truly was, straight ahead at full tilt."""


def drive(name: str, seed: int) -> Drive:
    """Drive the calibrated robot of this file and seed.

    Its calibration doubts as much as such a robot is drawn from: evenly, within a share to either side.
    """
    with _drawn(name, seed) as loop:
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


def creep(name: str, seed: int, control: WheelControl) -> float:
    """Fail where a drawn robot that is asked for 0.05 m/s takes itself for held; return its share of that."""
    with _drawn(name, seed, control) as loop:
        arm(loop)
        tilt, before, asked = _SLOW_TILT, 0.0, []
        plant = loop.simulation.world.plant
        for tenth in range(round((_SPEEDS_UP + _CREEPS) * 10.0)):
            hold(loop, tilt)
            loop.run(0.1)
            assert loop.newest["base"].armed, loop.newest["base"].reason
            asked.append(loop.newest["cmd_vel"].linear_x)
            if tenth < _SPEEDS_UP * 10.0:
                tilt += _TILT_OF_SPEED * (_SLOW - asked[-1])  # its joystick is drawn, too
                before, asked = plant.path_length, []
        assert statistics.fmean(asked) == pytest.approx(_SLOW, abs=0.01)
        share = (plant.path_length - before) / statistics.fmean(asked) / _CREEPS
        assert share > _MAKES[control]
        return share


@contextmanager
def _drawn(name: str, seed: int, control: WheelControl | None = None) -> Iterator[ClosedLoop]:
    settings, drive, sim = ROBOTS[name]
    wheel, track = (sim.truth.calibrated_wheel_scale**2 / 3.0, sim.truth.calibrated_track_scale**2 / 3.0)
    calibration = Calibration(date="2026-11-27", covariance=(wheel, 0.0, 0.0, wheel, 0.0, track))
    robot = msgspec.structs.replace(settings.robot, calibration=calibration)
    drive = msgspec.structs.replace(drive, wheel_control=control or drive.wheel_control)
    base = msgspec.structs.replace(settings.base, drive=drive)
    calibrated = msgspec.structs.replace(settings, robot=robot, base=base)
    truth = draw_truth("calibrated", sim.truth, seed, calibration)
    with closed_loop(proving_room(), calibrated, sim=sim, seed=seed, truth=truth) as loop:
        yield loop


def require_sound(name: str, seed: int) -> Drive:
    """Fail where a drive touches something, is lost by more than odometry says, or is not as fast as it is asked."""
    done = drive(name, seed)
    assert done.contacts == 0
    assert done.path > _WAY * ROBOTS[name].settings.robot.max_wheel_speed / 0.6
    assert done.off <= ELLIPSE_95
    assert abs(done.speed - 1.0) <= _SLOWER.get(name, _SLOWEST)
    return done

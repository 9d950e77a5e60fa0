"""What a motion claims of its error, and what a drawn robot has truly made of it."""

import math
from collections.abc import Iterable, Sequence

import msgspec
import numpy as np

from giraff_core.kinematics.calibration import Calibration
from giraff_core.kinematics.pose import Pose
from giraff_schemas.motion import MotionGo, Step
from giraff_sim.config import SimConfig
from giraff_sim.truth import Level, draw_truth
from tests.support.floor_robot import STEP
from tests.unit.motion.bench import Bench

RANGES = SimConfig().truth
NO_SLIP = msgspec.structs.replace(RANGES, turn_slip=0.0, threshold_slip=0.0)
_WHEEL, _TRACK = RANGES.calibrated_wheel_scale**2 / 3.0, RANGES.calibrated_track_scale**2 / 3.0  # drawn evenly
CALIBRATED = Calibration(date="2026-11-26", covariance=(_WHEEL, 0.0, 0.0, _WHEEL, 0.0, _TRACK))
"""Of a file whose robots are drawn at the level `calibrated`."""
_HOLDS_95: float = 7.815
"""Of the χ² distribution with three degrees of freedom: 95 % are below it."""


def share_held(steps: Sequence[Step], level: Level, seeds: Iterable[int]) -> float:
    """Of robots whose true end lies within the ellipsoid of 95 % that is claimed for x, y and yaw."""
    found = [_distance(steps, level, seed) <= _HOLDS_95 for seed in seeds]
    return sum(found) / len(found)


def _distance(steps: Sequence[Step], level: Level, seed: int) -> float:
    """Mahalanobis's, squared. The floor lets each wheel slip, too, on each metre."""
    calibration = CALIBRATED if level == "calibrated" else Calibration()
    bench = Bench(draw_truth(level, RANGES, seed, calibration), seed, calibration, step=STEP)
    start = Pose(*bench.floor.pose)
    state = bench.do(MotionGo, steps=tuple(steps))
    assert state.outcome == "arrived", state
    end, achieved = bench.floor.pose, state.achieved
    x, y = start.sees(end.x, end.y)
    off = np.array([achieved.x - x, achieved.y - y, math.remainder(achieved.yaw - end.yaw + start.yaw, math.tau)])
    xx, xy, xt, yy, yt, tt = state.covariance
    covariance = np.array([[xx, xy, xt], [xy, yy, yt], [xt, yt, tt]])
    return float(off @ np.linalg.solve(covariance, off))

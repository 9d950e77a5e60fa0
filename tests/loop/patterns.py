"""2 m, 180°, 2 m, -180° through the whole robot, and where it truly is then."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

import msgspec

from giraff_cli.motion.pattern import read_pattern
from giraff_core.kinematics.calibration import Calibration
from giraff_schemas.motion import MotionGo, MotionState, Step
from giraff_sim.settings import Settings
from giraff_sim.truth import Truth, TruthRanges, draw_truth
from tests.loop.loops import SETTINGS
from tests.loop.motions import stage

_PATTERN: Final = Path("deploy/patterns/there_and_back.toml")
_LONGEST: Final = 90.0
"""s"""


class End(NamedTuple):
    """Where the robot is, seen from where it began."""

    state: MotionState
    off: float
    """m"""
    turned: float
    """rad"""
    sigmas: float
    """Of what the motion has missed without knowing it, the most of x, y and yaw, in standard deviations."""


def end_of_pattern(
    settings: Settings, truth: Truth | None = None, seed: int = 1, steps: Sequence[Step] | None = None
) -> End:
    """Drive the pattern that ships, unless other `steps` are given."""
    with stage(settings=settings, truth=truth, seed=seed) as made:
        plant = made.loop.simulation.world.plant
        assert (plant.pose.x, plant.pose.y, plant.pose.yaw) == (0.0, 0.0, 0.0)
        made.begin(MotionGo, steps=tuple(steps or read_pattern(_PATTERN).steps))
        made.until_ended(_LONGEST)
        state, pose = made.state, plant.pose
    assert state.outcome == "arrived", state
    at = state.achieved
    missed = (at.x - pose.x, at.y - pose.y, math.remainder(at.yaw - pose.yaw, math.tau))
    sigmas = max(abs(off) / sd for off, sd in zip(missed, state.standard_deviations, strict=True))
    return End(state, math.hypot(pose.x, pose.y), math.remainder(pose.yaw, math.tau), sigmas)


def end_of_a_drawn_one(calibration: Calibration, ranges: TruthRanges, seed: int) -> End:
    """Of a robot that is near what `calibration`, its file's, takes it for."""
    robot = msgspec.structs.replace(SETTINGS.robot, calibration=calibration)
    truth = draw_truth("calibrated", ranges, seed, calibration)
    return end_of_pattern(msgspec.structs.replace(SETTINGS, robot=robot), truth, seed)

"""Fits wheels and track to a drive by the plan that was made of it: the drive as runs of `calibrate odometry`."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_maps.scan.mapper import KeyTurn
from giraff_maps.scan.match import Floats
from giraff_maps.scan.plan import Figures
from giraff_node.config.robot_file import ConfigError
from giraff_setup.map.make.drive import Drive
from giraff_setup.wheels.odometry.conclusion import conclude, refuse
from giraff_setup.wheels.odometry.runs import Geometry, MeasuredPose, Run
from giraff_tools.robot_file import own_robot_file
from giraff_tools.terminal.document import REFUSED, UNUSABLE

_LENGTH: Final = 4.0  # m of each run
_SHORTEST: Final = 1.5  # m
_SPUN: Final = 0.012  # m by which a step of the wheels differs from the plan where one has spun
_STRAIGHT: Final = 0.1  # rad of a step


def calibrated(drive: Drive, robot: str, file: Path | None, figures: Figures) -> int:
    """Fit wheels and track to the drive and write them into the robot file; return the exit code.

    `file`: as of `own_robot_file`.
    """
    try:
        path, filed = own_robot_file(robot, file)
    except ConfigError as error:
        return refuse(str(error), UNUSABLE)
    if figures.missing:
        return refuse("the plan is not good, so that it tells nothing of the wheels. Nothing was written.", REFUSED)
    gone_by = drive.robot
    if (filed.track_width, filed.ticks_per_metre) != (gone_by.track_width, gone_by.ticks_per_metre):
        return refuse(
            f"track_width and ticks_per_metre of {path} are not those that the robot goes by; copy its robot file "
            "here. Nothing was written.",
            REFUSED,
        )
    geometry = Geometry(gone_by.ticks_per_metre, gone_by.track_width, gone_by.calibration.scales)
    runs = runs_of(drive.mapper.keys, geometry)
    return conclude(runs[::2], runs[1::2], geometry, path, force=False).code


def runs_of(keys: Sequence[KeyTurn], geometry: Geometry) -> list[Run]:
    """Return the drive in pieces of 4 m, whose true way the plan tells. It is cut where a wheel has spun.

    `geometry`: what odometry went by, from whose poses the encoders' counts are taken back.
    """
    if len(keys) < 2:
        return []
    rolled = np.array([_arc(after.turn.odom.seen_from(before.turn.odom)) for before, after in pairwise(keys)])
    truly = np.array([_arc(after.pose.seen_from(before.pose)) for before, after in pairwise(keys)])
    straight = (np.abs(rolled[:, 1]) < _STRAIGHT) & (np.abs(rolled[:, 0]) > _STRAIGHT)
    scale = float(np.median(truly[straight, 0] / rolled[straight, 0])) if straight.any() else 1.0
    cuts = np.array([key.is_cut for key in keys[1:]]) | (np.abs(truly[:, 0] - scale * rolled[:, 0]) > _SPUN)
    return [_run(keys, rolled, begin, end, geometry) for begin, end in _pieces(keys, cuts)]


def _arc(moved: Pose) -> tuple[float, float]:
    """Return m along the arc that leads there, and rad."""
    ahead = moved.x * math.cos(moved.yaw / 2.0) + moved.y * math.sin(moved.yaw / 2.0)
    return ahead / float(np.sinc(moved.yaw / math.tau)), moved.yaw


def _pieces(keys: Sequence[KeyTurn], cuts: Any) -> Iterator[tuple[int, int]]:
    """Yield numbers of the first and the last key turn of each piece. `cuts`: whether one is before the next key."""
    begin = 0
    for end in range(1, len(keys) + 1):
        is_cut = end == len(keys) or cuts[end - 1]
        last = end - 1 if is_cut else end
        way = keys[last].way - keys[begin].way
        if is_cut or way >= _LENGTH:
            if way >= _SHORTEST:
                yield begin, last
            begin = end


def _run(keys: Sequence[KeyTurn], rolled: Floats, begin: int, end: int, geometry: Geometry) -> Run:
    """Return the run from one key turn to another one. `rolled`: m and rad of odometry from each to the next."""
    distance, turn = rolled[begin:end].T
    turn = turn * geometry.track_width * geometry.scales.track / 2.0
    left = (distance - turn) / geometry.scales.left_wheel * geometry.ticks_per_metre
    right = (distance + turn) / geometry.scales.right_wheel * geometry.ticks_per_metre
    start = keys[begin]
    poses = (key.pose.seen_from(start.pose) for key in keys[begin + 1 : end + 1])
    measured = tuple(MeasuredPose(row, *pose) for row, pose in enumerate(poses, 1))
    return Run(f"from {start.way:.0f} m on", left, right, measured, 0.0, 0.0)

"""Turns of a laser scanner with the robot's motion taken out, as mapping and localization take them."""

import math
from typing import Final, NamedTuple

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import LaserScanner
from giraff_maps.scan.match import Cloud, Floats, cloud_of, points_of, rotated
from giraff_schemas.scan import NEAREST, OWN, RAYS, LaserScan

FEWEST: Final = 30
"""Rays with an echo. Fewer tell no place."""
_OWN_WITHIN: Final = 450  # mm within which the robot's own parts are, where nobody has looked for them
_LONGEST_GAP: Final = 0.15  # s between two turns over which the motion within the earlier one is not told
_FASTEST, _FASTEST_TURN = 2.0, 6.0  # m/s, rad/s: what is faster is a leap of odometry, not a motion


class Turn(NamedTuple):
    """Points that one turn saw, as if the robot had stood all the while where it was at the turn's end."""

    cloud: Cloud
    """In `base_link`."""
    odom: Pose
    """Pose of the robot in `odom` at the turn's end."""
    leapt: bool
    """Odometry began anew since the turn before, or its pose was set: what lies between them is no motion."""


class Turns:
    """Makes turns of samples: each when the next one tells where the robot was at its end."""

    def __init__(self, scanner: LaserScanner) -> None:
        self._mount, self._reach = Pose(scanner.x, scanner.y, 0.0), scanner.reach
        self._nearest = NEAREST if scanner.own is not None else _OWN_WITHIN
        self._last: LaserScan | None = None
        self._leapt = False

    def add(self, scan: LaserScan) -> Turn | None:
        """Take a sample; return the turn before it. None: it tells too little, or its motion is not known."""
        if scan.odom is None or scan.tick is None:
            return None
        last, self._last = self._last, scan
        if last is None or last.odom is None or last.tick is None:
            return None
        since = _begun(scan) - _begun(last)
        begin, end = Pose(*last.odom), Pose(*scan.odom)
        moved = end.seen_from(begin)
        if scan.tick.epoch != last.tick.epoch or since <= 0.0 or _is_leap(moved, since):
            self._leapt = True
            return None
        if last.trouble or since > last.duration + _LONGEST_GAP:
            return None
        cloud = _corrected(last, moved, last.duration / since, self._mount, (self._nearest, self._reach * 1000.0))
        if len(cloud.points) < FEWEST:
            return None
        leapt, self._leapt = self._leapt, False
        return Turn(cloud, end, leapt)


def _begun(scan: LaserScan) -> float:
    """Return s of robot's time."""
    return (scan.tick.robot_ns * 1e-9 if scan.tick is not None else 0.0) + scan.since_tick


def _is_leap(moved: Pose, seconds: float) -> bool:
    return math.hypot(moved.x, moved.y) > _FASTEST * seconds + 0.1 or abs(moved.yaw) > _FASTEST_TURN * seconds + 0.2


def _corrected(scan: LaserScan, moved: Pose, share: float, mount: Pose, within: tuple[float, float]) -> Cloud:
    """Return what the scan saw, from where the robot was after it had moved so.

    `share`: of that motion, which the robot made during the scan. `within`: mm of the rays that count.
    """
    rays = np.array(scan.rays(), dtype=int)
    seen = (rays >= within[0]) & (rays < OWN) & (rays <= within[1])
    part = np.arange(RAYS)[seen] / RAYS * share
    angles: Floats = scan.bearing + scan.step * np.arange(RAYS, dtype=float)[seen]
    ranges: Floats = rays[seen] / 1000.0
    points = points_of(angles, ranges) + mount[:2]
    cos, sin = np.cos(part * moved.yaw), np.sin(part * moved.yaw)
    x, y = points.T
    points = np.stack([cos * x - sin * y + part * moved.x, sin * x + cos * y + part * moved.y], axis=1)
    points = rotated(-moved.yaw, points - moved[:2]) - mount[:2]
    return _cloud(points).placed(mount)


def _cloud(points: Floats) -> Cloud:
    """`points`: seen from the scanner."""
    return cloud_of(np.arctan2(points[:, 1], points[:, 0]), np.hypot(points[:, 0], points[:, 1]))

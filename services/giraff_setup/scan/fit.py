"""Fits a laser scanner's mount to its turns, while the robot moves or before a wall with a step. No I/O, no clock."""

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np

from giraff_maps.scan.match import Cloud, Field, Floats, cloud_of, match, points_of, rotated
from giraff_schemas.scan import RAYS
from giraff_setup.condition import is_determined
from giraff_setup.ultrasonic.fit import UntoldError

_STEP: Final = math.tau / RAYS
FEWEST: Final = 150
"""Rays of a turn with an echo. Fewer tell no place."""
STEP_SD: Final = (0.0035, 0.0045, math.radians(0.6))
"""m, m, rad. How well a person measures with a tape, lays the step on the axis, and parks square."""
BIAS_SD: Final = 0.045
"""m. Bias of the ranges that the maker allows."""

_NEAR: Final = 0.05  # m: a nearer echo is dirt on the window
_OWN_WITHIN, _OWN_ALIKE = 0.45, 0.03  # m: the robot's own parts are so near, and stay so equal
_OWN_SHARE: Final = 0.9  # of the headings, at which they do
_ALIKE: Final = 0.1  # m by which a ray may differ from the one that saw the same wall before
_APART: Final = 3  # headings between the two that are compared for it
_CLEARLY: Final = 0.05  # share of the rays by which one sense of the turn must explain more than the other one
_SPREAD: Final = (0.1, 0.1, 0.03)
"""m, m, rad. Standard deviations of the scanner's way from one rest to the next, and of odometry's turn."""
_BEFORE: Final = 8  # rests before this one whose walls a turn is matched to, beside those of the first
_TOGETHER: Final = 2
"""Rounds in which each turn is matched to the walls of all: what has added up on the way is shared out."""
_FREE: Final = (1.0, 1.0, 1.0)
_LEAST_SHARE: Final = 0.5  # of a turn's points, that lie on walls seen before
_MOST_TURN: Final = math.radians(6.0)  # by which walls and wheels may differ in each turn
_MOST_WAY: Final = 0.1  # share of the straight way, the same
_LEAST_SD: Final = (0.0015, math.radians(0.3))  # m, rad: errors that the residuals do not show
_MOST_SD: Final = (0.006, math.radians(1.0))  # m, rad: less sure than this, nothing is told
_LEAN: Final = math.radians(20.0)
_FEWEST_AT_STEP: Final = 5  # rays of each turn on the wall, and on the step
_LOWEST, _HIGHEST = 0.012, 0.08  # m of a step


class ScanTurn(NamedTuple):
    """One turn of the scanner."""

    angles: Floats
    """rad, counter-clockwise in the scanner's frame."""
    ranges: Floats
    """m; 0: no echo."""

    def mirrored(self) -> "ScanTurn":
        """Return what a scanner that sits the other way up would have seen."""
        return ScanTurn(-self.angles, self.ranges)

    def without(self, own: Sequence[tuple[float, float]]) -> "ScanTurn":
        """Return the rays with an echo that the robot's own parts do not hide."""
        kept = self.ranges > _NEAR
        for begin, end in own:
            kept &= (self.angles - begin) % math.tau > end - begin
        return ScanTurn(self.angles[kept], self.ranges[kept])


class Mount(NamedTuple):
    """Place of a scanner in `base_link`, with standard deviations: metres, radians."""

    x: float
    y: float
    yaw: float
    x_sd: float
    y_sd: float
    yaw_sd: float


def turns_with_wheels(turns: Sequence[ScanTurn], yaws: Sequence[float]) -> bool:
    """Tell whether the scan turns as the wheels do; else it turns the other way. Raises UntoldError.

    `yaws`: odometry's, of each turn, while the robot turns on the spot.
    """
    rows, alike = _profiles(turns), np.zeros((2, len(turns) - _APART))
    for number, (before, now) in enumerate(zip(rows, rows[_APART:], strict=False)):
        shift = round((yaws[number + _APART] - yaws[number]) / _STEP)
        for sense, turned in enumerate((-shift, shift)):
            alike[sense, number] = np.mean(np.abs(np.roll(before, turned) - now) < _ALIKE)
    with_wheels, against = alike.mean(axis=1)
    if abs(with_wheels - against) < _CLEARLY:
        raise UntoldError(
            "the scan does not tell which way the robot turned; see that the scanner's head turns, "
            "or take a room that does not look alike to all sides"
        )
    return bool(with_wheels > against)


def own_parts(turns: Sequence[ScanTurn]) -> list[tuple[float, float]]:
    """Return the arcs (from, to; rad, counter-clockwise) that the robot's own parts hide. `turns`: at many headings."""
    rows = _profiles(turns)
    ranges = np.where(rows < _OWN_WITHIN, rows, np.inf)
    with np.errstate(invalid="ignore"):
        same = np.abs(ranges - np.median(ranges, axis=0)) < _OWN_ALIKE
    own = same.mean(axis=0) >= _OWN_SHARE
    for others in (np.isfinite(ranges).mean(axis=0) > 1.0 - _OWN_SHARE, True):  # a ray at an edge meets it now and then
        own |= (np.roll(own, 1) | np.roll(own, -1)) & others
    found = []
    for begin in np.flatnonzero(own & ~np.roll(own, 1)).tolist():
        angle = math.remainder((begin - 0.5) * _STEP, math.tau)
        found.append((angle, angle + int(np.argmin(np.roll(own, -begin))) * _STEP))
    return sorted(found)


def mount_by_motion(turns: Sequence[ScanTurn], yaws: Sequence[float], straight: int, way: float) -> Mount:
    """Return the mount by turns at rests: once round on the spot, then straight on. Raises UntoldError.

    `yaws`: odometry's, of each turn. `straight`: number of the last turn on the spot. `way`: m of the straight drive,
    by odometry. A bias of the ranges moves no wall against the others, and cancels.
    """
    poses = _follow([cloud_of(*turn) for turn in turns], yaws)
    round_about, drive = poses[: straight + 1], poses[straight:]
    cos, sin, one = np.cos(round_about[:, 2]), np.sin(round_about[:, 2]), np.ones(straight + 1)
    rows = [np.column_stack([cos, -sin, -one, 0.0 * one]), np.column_stack([sin, cos, 0.0 * one, -one])]
    design, wanted = np.concatenate(rows), -np.concatenate([round_about[:, 0], round_about[:, 1]])
    normal = design.T @ design
    if not is_determined(normal):
        raise UntoldError("the robot has not turned; see that it turns on the spot")
    solved = np.linalg.solve(normal, design.T @ wanted)  # the robot's origin seen from the scanner, and in the room
    rough = float(np.sqrt(np.mean((design @ solved - wanted) ** 2)))
    place_sd = max(_LEAST_SD[0], rough * math.sqrt(float(np.linalg.inv(normal)[0, 0])))
    origin = solved[:2]
    places = drive[:, :2] + np.array([rotated(yaw, origin) for yaw in drive[:, 2]])
    headings = (drive[1:, 2] + drive[:-1, 2]) / 2.0
    moved = [rotated(-heading, step) for heading, step in zip(headings, np.diff(places, axis=0), strict=True)]
    seen = np.concatenate([np.zeros((1, 2)), np.cumsum(moved, axis=0)])  # as if it had not bent
    centred = seen - seen.mean(axis=0)
    long, axes = np.linalg.eigh(centred.T @ centred)
    axis = axes[:, 1] * np.sign(axes[:, 1] @ (seen[-1] - seen[0]))
    length = float(np.dot(seen[-1] - seen[0], axis))
    if abs(length - way) > _MOST_WAY * way:
        raise UntoldError(
            f"the robot drove {way:.2f} m by its wheels and {length:.2f} m by the walls; "
            "take a room with more furniture, or calibrate odometry first"
        )
    yaw_sd = max(_LEAST_SD[1], math.sqrt(max(0.0, long[0]) / max(1, len(seen) - 2) / long[1]))
    yaw = -math.atan2(axis[1], axis[0])
    if place_sd > _MOST_SD[0] or yaw_sd > _MOST_SD[1]:
        raise UntoldError(
            f"its place is known to ± {place_sd * 1000.0:.0f} mm and ± {math.degrees(yaw_sd):.1f}° only; "
            "take a room with more furniture, where nobody walks"
        )
    x, y = -rotated(yaw, origin)
    return Mount(float(x), float(y), yaw, place_sd, place_sd, yaw_sd)


def mount_by_step(turns: Sequence[ScanTurn], distance: float, rough: Mount, *, is_behind: bool = False) -> Mount:
    """Return the mount by turns before a wall with a step. Raises UntoldError.

    The robot stands square before the wall, which is `distance` m from its origin, or with its back to it
    (`is_behind`). A step (a book) covers the wall to the left, seen from the robot, and its edge lies
    on the robot's x axis. A bias of the ranges makes x so much smaller, with the back to the wall larger. `rough`: the
    mount by another way.
    """
    side, back = (-1.0, math.pi) if is_behind else (1.0, 0.0)
    points = np.concatenate([points_of(*turn) for turn in turns])
    yaw, edge, wall, face = rough.yaw - back, -side * rough.y, distance - side * rough.x, 0.0
    ahead = rotated(yaw, points)
    points = points[(np.abs(np.arctan2(ahead[:, 1], ahead[:, 0])) < 0.8) & (np.abs(ahead[:, 0] - wall) < 0.3)]
    leans = np.arange(-_LEAN, _LEAN, math.radians(0.5))
    bins = np.arange(wall - 0.3, wall + 0.3, 0.02)
    yaw += max(leans, key=lambda lean: np.histogram(rotated(yaw + lean, points)[:, 0], bins)[0].max())
    for _ in range(5):
        x, y = rotated(yaw, points).T
        on_wall, on_step = (y < edge - 0.03) & (y > edge - 0.5), (y > edge + 0.03) & (y < edge + 0.2)
        if min(on_wall.sum(), on_step.sum()) < _FEWEST_AT_STEP * len(turns):
            raise UntoldError("too little of the wall or of the step is seen; park the robot nearer, and clear the way")
        lean, wall, face = _two_lines(x, y, on_wall, on_step)
        yaw += lean
        x, y = rotated(yaw, points).T
        near = (np.abs(y - edge) < 0.15) & (x > face - 0.03) & (x < wall + 0.03)
        edge = face * math.tan(_parting(np.arctan2(y, x)[near], x[near] < (wall + face) / 2.0))
    if not _LOWEST < wall - face < _HIGHEST:
        raise UntoldError(
            f"the step would be {(wall - face) * 1000.0:.0f} mm high; take a book of 20 to 60 mm, upright at the wall, "
            "its edge on the robot's axis"
        )
    return Mount(side * (distance - wall), -side * edge, math.remainder(yaw + back, math.tau), *STEP_SD)


def _two_lines(x: Floats, y: Floats, on_wall: Any, on_step: Any) -> tuple[float, float, float]:
    """Return the lean (rad) of two lines that are parallel, and the distance of each (m)."""
    used = on_wall | on_step
    design = np.column_stack([on_wall, on_step, y])[used].astype(float)
    weight, solved = np.ones(len(design)), np.zeros(3)
    for _ in range(8):
        solved = np.linalg.lstsq(design * weight[:, None], x[used] * weight, rcond=None)[0]
        weight = 1.0 / np.sqrt(1.0 + ((x[used] - design @ solved) / 0.02) ** 2)
    lean = math.atan(solved[2])
    return lean, float(solved[0]) * math.cos(lean), float(solved[1]) * math.cos(lean)


def _parting(bearings: Floats, is_step: Any) -> float:
    """Return the bearing (rad) that parts the step, to the left of it, from the wall best."""
    order = np.argsort(bearings)
    bearings, is_step = bearings[order], is_step[order]
    if len(bearings) < 2:
        raise UntoldError("the edge of the step is not seen; lay it on the robot's axis")
    wrong = np.concatenate([[0], np.cumsum(is_step)]) + np.concatenate([np.cumsum(~is_step[::-1])[::-1], [0]])
    between = np.concatenate([bearings[:1], (bearings[1:] + bearings[:-1]) / 2.0, bearings[-1:]])
    return float(between[wrong == wrong.min()].mean())


def _follow(clouds: Sequence[Cloud], yaws: Sequence[float]) -> Floats:
    """Return the scanner's poses, from its first one. Raises UntoldError."""
    poses, placed, shares = [np.zeros(3)], [clouds[0]], []
    for number, cloud in enumerate(clouds[1:], start=1):
        field = Field([placed[0], *placed[max(1, number - _BEFORE) :]])
        turned = math.remainder(yaws[number] - yaws[number - 1], math.tau)
        found = match(field, cloud, poses[-1] + (0.0, 0.0, turned), _SPREAD)
        if abs(found.pose[2] - poses[-1][2] - turned) > _MOST_TURN:
            raise UntoldError(
                "walls and wheels tell different turns; calibrate odometry first, and let nobody walk there"
            )
        shares.append(found.share)
        poses.append(found.pose)
        placed.append(cloud.placed(found.pose))
    if np.median(shares) < _LEAST_SHARE:
        raise UntoldError("the walls of one turn are not found in the next; take a room where nobody walks")
    for _ in range(_TOGETHER):
        field = Field([cloud.placed(pose) for cloud, pose in zip(clouds, poses, strict=True)])
        poses = [match(field, cloud, pose, _FREE).pose for cloud, pose in zip(clouds, poses, strict=True)]
    return np.array(poses)


def _profiles(turns: Sequence[ScanTurn]) -> Floats:
    """Return the ranges of each turn by angle, _STEP apart; NaN where there is none."""
    rows = np.full((len(turns), RAYS), math.nan)
    for row, (angles, ranges) in zip(rows, turns, strict=True):
        seen = ranges > _NEAR
        row[np.round(angles[seen] / _STEP).astype(int) % RAYS] = ranges[seen]
    return rows

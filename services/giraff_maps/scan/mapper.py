"""Follows a robot by its scanner while somebody drives it, and keeps what it saw where: a floor plan to be.

Each 0.2 m or 10 degrees a turn of the scanner becomes a key turn: it is matched to what the last ones saw. Each fifth
key turn is compared with what was seen near there long before: where they agree a loop is closed, and a pose graph
moves all. No I/O, no clock.
"""

import math
from collections.abc import Iterable
from typing import Final, NamedTuple

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_maps.scan.graph import Edge, optimised, seen_in
from giraff_maps.scan.match import Cloud, Field, Matched, match
from giraff_maps.scan.search import are_apart, search
from giraff_maps.scan.turns import Turn
from giraff_schemas.trouble import NO_TROUBLE, Trouble

_STEP, _TURN = 0.2, 0.17  # m, rad from one key turn to the next
_RECENT: Final = 14  # key turns that the next one is matched to
_GOOD: Final = 0.65  # share of the points on walls below which a pose is searched for about the guess
_LOST: Final = 0.5  # the same, below which the turn fits nowhere
_FOUND_SHARE: Final = 0.8  # the same, from which on a robot that was lost is found by a search
_ABOUT: Final = (0.4, 0.3)  # m, rad of that search
_FOUND: Final = (0.1, 0.1, 0.05)  # m, m, rad: standard deviations of what a search finds
_LEAPT: Final = (0.3, 0.3, 0.2)  # m, m, rad: where the robot may be after odometry began anew
_CHAIN: Final = 0.2  # weight of the chain against the loops
_LOOP_EACH: Final = 5  # key turns
_LOOP_AFTER: Final = 4.0  # m of way
_LOOP_ABOUT: Final = (1.0, 0.26)  # m, rad
_LOOP_SPREAD: Final = (0.3, 0.3, 0.2)  # m, m, rad
_LOOP_TURNS: Final = 10  # key turns to each side of the place that is come back to
_LOOP_SHARE: Final = 0.7  # of the points, that lie on the walls seen before
_LOOP_SLIDE: Final = 0.02  # m
_LOOP_LEAD: Final = 0.08  # share by which it must explain more than any other place there
_LOOP_INFORMATION: Final = np.diag([1.0 / 0.02**2, 1.0 / 0.02**2, 1.0 / 0.006**2])
_AGREES: Final = (0.005, 0.003)  # m, rad: a loop that is off by less moves nothing
_FIXED, _FITS = 0.012, 0.5  # m, share: walls fix the robot so well that odometry's scales are learnt
_ORIGIN: Final = Pose(0.0, 0.0, 0.0)
_FITS_NOWHERE: Final = Trouble(
    "what the scanner sees fits nothing near where the robot should be",
    "was it lifted or pushed? Put it back where it was, and drive on slowly",
)


class KeyTurn(NamedTuple):
    """A turn that the plan is made of."""

    pose: Pose
    """`base_link` in the map, whose origin is where the robot began."""
    turn: Turn
    way: float
    """m driven until then."""
    share: float
    """Share of its points on the walls that the ones before saw."""
    slide: float
    """m, as of `Matched.slide`."""
    is_cut: bool
    """Odometry does not tell the motion since the key turn before."""


class Mapper:
    """Give it all turns, in order."""

    def __init__(self) -> None:
        self.keys: list[KeyTurn] = []
        self.here: Pose | None = None
        """`base_link` in the map, as of the newest turn. None: there was none."""
        self.trouble: Trouble = NO_TROUBLE
        """Cause, where the newest turn fits nowhere."""
        self._lost = self._was_lost = 0.0
        """m on which no turn has fitted, since the newest key turn; and before the robot was found by a search."""
        self.edges: list[Edge] = []
        self.scale, self.turn_scale = 1.0, 1.0
        """m and rad, by the walls, for each of odometry."""
        self._sums = np.array([2.0, 2.0, 3.0, 3.0])
        """m of way by the walls and by odometry, rad of turns by both: with some of either to begin from."""
        self._odom = _ORIGIN
        """Odometry's pose at the newest key turn, or at the first turn after it leapt."""
        self._from = _ORIGIN
        """Pose in the map there."""
        self._looked = 0
        """Number of the key turn that last looked for a loop."""

    @property
    def lost(self) -> float:
        """m of the longest way on which nothing fitted, and after which only a search found the robot, or none did."""
        return max(self._lost, self._was_lost)

    def add(self, turn: Turn) -> bool:
        """Return whether it has become a key turn."""
        if not self.keys:
            self.here = self._from = _ORIGIN
            self._keep(KeyTurn(_ORIGIN, turn, 0.0, 1.0, 0.0, is_cut=True))
            return True
        if turn.leapt:
            self._odom, self._from = turn.odom, self.here or _ORIGIN
        raw = turn.odom.seen_from(self._odom)
        length = math.hypot(raw.x, raw.y)
        self.here = guess = self._moved(raw).placed_in(self._from)
        if length < _STEP and abs(raw.yaw) < _TURN and not turn.leapt:
            return False
        last, off = self.keys[-1], length + self._lost
        spread = (0.005 + 0.03 * off, 0.005 + 0.03 * off, 0.01 + 0.10 * abs(raw.yaw) + 0.05 * off)
        field = self._field(range(max(0, len(self.keys) - _RECENT), len(self.keys)))
        if turn.leapt:
            spread = _LEAPT
        found = match(field, turn.cloud, guess, spread)
        is_cut = turn.leapt or bool(self.trouble)
        if found.share < _GOOD:
            found = self._searched(field, turn.cloud, found, guess)
            if found.share < (_FOUND_SHARE if self.trouble else _LOST):
                self.trouble, self._lost = _FITS_NOWHERE, off + (0.0 if length else _STEP)
                self._odom, self._from = turn.odom, guess
                return False
            if self.trouble:
                self._was_lost = max(self._was_lost, self._lost)
        pose = _pose(found)
        seen = pose.seen_from(last.pose)
        if not is_cut:
            self._learn(raw, pose.seen_from(self._from), found)
        self.trouble, self.here = NO_TROUBLE, pose
        information = seen_in(last.pose.yaw, found.information + np.diag(1.0 / np.square(spread)))
        self.edges.append(Edge(len(self.keys) - 1, len(self.keys), seen, _CHAIN * information))
        self._keep(KeyTurn(pose, turn, last.way + length * self.scale, found.share, found.slide, is_cut))
        if len(self.keys) - self._looked >= _LOOP_EACH:
            self._close()
        return True

    def _searched(self, field: Field, cloud: Cloud, found: Matched, guess: Pose) -> Matched:
        """Return what fits best near where a turn should be: the wheels may have slipped.

        One that fitted nowhere is also looked for near where the last one did: there it may have been put back.
        """
        near = [guess, self.keys[-1].pose] if self.trouble else [guess]
        about = [each for place in near for each in search(field, cloud, np.array(place), *_ABOUT)]
        return max([found, *(match(field, cloud, each, _FOUND) for each in about)], key=lambda each: each.share)

    def _keep(self, key: KeyTurn) -> None:
        self.keys.append(key)
        self._odom, self._from, self._lost = key.turn.odom, key.pose, 0.0

    def _moved(self, raw: Pose) -> Pose:
        return Pose(raw.x * self.scale, raw.y * self.scale, raw.yaw * self.turn_scale)

    def _learn(self, raw: Pose, seen: Pose, found: Matched) -> None:
        """Learn odometry's scales where walls fix the robot: they carry the plan through a smooth corridor."""
        if found.slide > _FIXED or found.share < _FITS:
            return
        if abs(raw.x) > 0.1 > abs(raw.yaw):
            self._sums[:2] += abs(seen.x), abs(raw.x)
        if abs(raw.yaw) > 0.1:
            self._sums[2:] += abs(seen.yaw), abs(raw.yaw)
        self.scale, self.turn_scale = float(self._sums[0] / self._sums[1]), float(self._sums[2] / self._sums[3])

    def _field(self, numbers: Iterable[int]) -> Field:
        return Field([self._placed(number) for number in numbers])

    def _placed(self, number: int) -> Cloud:
        key = self.keys[number]
        return key.turn.cloud.placed(key.pose)

    def _close(self) -> None:
        """Look for a loop: whether the newest key turn saw what was seen long before."""
        now = len(self.keys) - 1
        here, cloud = self.keys[now].pose, self.keys[now].turn.cloud
        since = self.keys[now].way - np.array([key.way for key in self.keys])
        far = np.hypot(*(np.array([key.pose[:2] for key in self.keys]) - here[:2]).T)
        near = np.flatnonzero((since > _LOOP_AFTER) & (far < np.minimum(2.5, 0.8 + 0.04 * since)))
        if len(near) == 0:
            return
        self._looked, nearest = now, int(near[far[near].argmin()])
        members = range(max(0, nearest - _LOOP_TURNS), min(now - _RECENT - 1, nearest + _LOOP_TURNS + 1))
        if len(members) < _LOOP_TURNS // 2 + 1:
            return
        field = self._field(members)
        places = search(field, cloud, np.array(here), *_LOOP_ABOUT)
        best, *others = sorted(
            (match(field, cloud, each, _LOOP_SPREAD) for each in places), key=lambda each: -each.share
        )
        rival = next((each.share for each in others if are_apart(each.pose, best.pose, 0.15, 0.1)), 0.0)
        if best.share < _LOOP_SHARE or best.slide > _LOOP_SLIDE or rival > best.share - _LOOP_LEAD:
            return
        seen = _pose(best).seen_from(self.keys[nearest].pose)
        off = here.seen_from(_pose(best))
        self.edges.append(Edge(nearest, now, seen, _LOOP_INFORMATION, is_loop=True))
        if math.hypot(off.x, off.y) < _AGREES[0] and abs(off.yaw) < _AGREES[1]:
            return
        poses = optimised([key.pose for key in self.keys], self.edges)
        self.keys = [key._replace(pose=pose) for key, pose in zip(self.keys, poses, strict=True)]
        self.here = self._from = poses[-1]


def _pose(found: Matched) -> Pose:
    x, y, yaw = map(float, found.pose)
    return Pose(x, y, math.remainder(yaw, math.tau))

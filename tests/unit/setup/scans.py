"""A robot with a laser scanner in drawn rooms: noise, a bias of the ranges, lost rays, points between two surfaces."""

import math
from array import array
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_core.motion.result import MotionResult
from giraff_core.senses import LaserScanner
from giraff_schemas.motion import Move, Step, Turn
from giraff_schemas.scan import NO_ECHO, RAYS, LaserScan, packed
from giraff_schemas.trouble import NO_TROUBLE
from giraff_setup.ultrasonic.fit import Echo
from giraff_setup.ultrasonic.procedure import StoppedError
from giraff_sim.world.ld19 import walls_met

_REACH: Final = 12.0
_WANDER: Final = 0.003  # m by which the robot's origin is off at each rest
_BEND: Final = math.radians(1.0)  # that a straight drive bends in a metre
_TAPE: Final = 0.003
_ASKEW: Final = math.radians(0.5)
Segments = list[tuple[float, float, float, float]]


def box(left: float, low: float, right: float, high: float) -> Segments:
    return [(left, low, right, low), (right, low, right, high), (right, high, left, high), (left, high, left, low)]


ROOMS: Final[list[Segments]] = [
    [
        *box(-2.2, -1.9, 3.1, 2.4),
        *box(-2.2, 0.9, -1.2, 2.4),
        *box(1.0, 1.9, 2.4, 2.4),
        *box(-0.6, -1.9, 0.7, -1.3),
        *box(2.5, -1.9, 3.1, -0.6),
    ],
    [
        *box(-3.0, -1.4, 2.3, 3.2),
        *box(-3.0, -1.4, -2.1, 0.4),
        *box(0.4, -1.4, 1.2, -1.0),
        *box(1.5, 1.1, 1.9, 1.5),
        *box(-1.4, 2.5, 0.6, 3.2),
        (-3.0, 3.2, -2.2, 2.0),
    ],
]
"""Round the origin, free along the x axis."""
LONG: Final = [
    *box(-3.2, -2.0, 3.4, 2.6),
    *box(-1.0, -2.0, 0.2, -1.2),
    *box(0.5, 1.6, 1.7, 2.6),
    *box(2.9, -2.0, 3.4, -0.9),
]
"""Free behind the origin, too."""
DARK: Final = box(-40.0, -40.0, 40.0, 40.0)
NARROW: Final = box(-0.6, -0.6, 1.2, 0.6)


def posts(*bearings: float) -> Segments:
    """Return posts of 40 mm on the robot, 0.14 m from the scanner, in its frame."""
    at = [(0.14 * math.cos(bearing), 0.14 * math.sin(bearing)) for bearing in bearings]
    return [side for x, y in at for side in box(x - 0.02, y - 0.02, x + 0.02, y + 0.02)]


def step_in_a_wall(distance: float, book: float) -> Segments:
    """Return a wall at x = `distance`, which a book covers to the left of the x axis."""
    near = distance - book
    corners = [(distance, -3.0), (distance, 0.0), (near, 0.0), (near, 0.3), (distance, 0.3), (distance, 3.0)]
    return [(*begin, *end) for begin, end in pairwise(corners)]


class DrawnScanned:
    """As `ScannedRobot`: turns of a drawn scanner at the poses of the procedure, without simulated time."""

    def __init__(self, filed: LaserScanner, seed: int, mount: Pose, bias: float = 0.0) -> None:
        self.chance = np.random.default_rng([seed, 5])
        self.mount, self.bias = mount, bias
        self.room, self.posts = ROOMS[seed % 2], Segments()
        self.is_mirrored = self.is_driven = self.is_stuck = self.is_blocked = self.holds_lease = False
        self.trouble = NO_TROUBLE
        self.name, self.silent_after = "laser", math.inf
        self.performed: list[Step] = []
        self.wall = 0.9, 0.04
        self._filed, self.turned_since = filed, 0.0
        """Second: rad by which giraff_scan goes by another yaw than the file."""
        self._true, self._odometry = Pose(0.0, 0.0, 0.0), Pose(3.0, -2.0, 1.0)
        self._scale, self._bend = 1.0 + self.chance.uniform(-0.02, 0.02), self.chance.choice([-_BEND, _BEND])
        self._is_behind = False

    def place(self) -> Pose:
        return self._odometry

    def idle(self) -> str:
        return ""

    def listen(self, sensors: Sequence[str], pings: int) -> list[Echo]:
        del sensors, pings
        return []

    def taped(self, side: str) -> float:
        del side
        return self.wall[0]

    def wait_released(self) -> None:
        if self.holds_lease:
            raise StoppedError("giraff_motion still holds the lease")

    def perform(self, steps: Sequence[Step]) -> tuple[MotionResult, list[Echo]]:
        for step in steps:
            self.performed.append(step)
            if isinstance(step, Turn):
                self._is_behind = step.angle == math.pi
                if self._is_behind and self.is_blocked:  # the person then turns it
                    raise StoppedError("something is beside it")
                turned = step.angle * (1.0 + self.chance.normal(0.0, 0.02))
                self._true = self._true.moved(0.0, turned)
                self._odometry = self._odometry.moved(0.0, turned * self._scale)
            elif isinstance(step, Move):
                self._true = self._true.moved(step.distance, self._bend * step.distance)
                self._odometry = self._odometry.moved(step.distance * self._scale, 0.0)
        return MotionResult(outcome="arrived", begun=True), []

    def scan(self, turns: int) -> list[LaserScan]:
        """Several turns are asked for before the wall alone."""
        if self.is_driven:
            self._odometry = self._odometry.moved(0.02, 0.0)
        if len(self.performed) >= self.silent_after:
            return []
        normal = self.chance.normal
        room, true = self.room, self._true._replace(x=normal(self._true.x, _WANDER), y=normal(self._true.y, _WANDER))
        if self.is_stuck:
            true = Pose(0.0, 0.0, 0.0)
        elif turns > 1:
            askew = normal(math.pi * self._is_behind, _ASKEW)
            room, true = step_in_a_wall(*self.wall), Pose(normal(0.0, _TAPE), normal(0.0, _TAPE), askew)
        return [self._told(self.turn(room, true)[1]) for _ in range(turns)]

    def turn(self, room: Segments, robot: Pose) -> tuple[Any, Any]:
        """Return angles (rad, in the scanner's frame) and ranges (m; 0: no echo) of one turn.

        A point is anywhere in the angle that its ray stands for.
        """
        at, chance, step = Pose(*self.mount).placed_in(robot), self.chance, self._step
        angles = (chance.uniform(-0.5, 0.5) + np.arange(RAYS)) * (-step if self.is_mirrored else step)
        true = _cast(room, at.x, at.y, angles + at.yaw + chance.normal(0.0, 0.0015, RAYS))
        if self.posts:
            true = np.minimum(true, _cast(self.posts, 0.0, 0.0, angles))
        seen, after = true + self.bias + chance.normal(0.0, 0.01, RAYS), np.roll(true, -1)
        mixed = (np.abs(after - true) > 0.3) & (chance.random(RAYS) < 0.3)
        seen = np.where(mixed, true + chance.random(RAYS) * (after - true), seen)
        lost = (true > _REACH) | (seen > _REACH) | (seen < 0.02) | (chance.random(RAYS) < 0.005)
        return angles, np.where(lost, NO_ECHO, seen)

    @property
    def _step(self) -> float:
        return math.tau / RAYS * (1.0 if self._filed.upside_down else -1.0)

    def _told(self, ranges: Any) -> LaserScan:
        """Return what giraff_scan says of it, which goes by the file."""
        return LaserScan(
            sensor=self.name,
            ranges=packed(array("H", np.round(ranges * 1000.0).astype(int).tolist())),
            bearing=self._filed.yaw + self.turned_since,
            step=self._step,
            duration=0.1,
            since_tick=0.01,
            trouble=self.trouble,
            tick=None,
        )


def _cast(segments: Segments, x: float, y: float, angles: Any) -> Any:
    return walls_met(np.array(segments).T, x, y, np.cos(angles)[:, None], np.sin(angles)[:, None])[0].min(axis=1)

"""Place, axis and scale of one ultrasonic sensor, from its echoes of a flat wall. No I/O and no clock.

An HC-SR04 tells the shortest way in its cone, so that its range is flat while it looks almost square at the wall, and
it loses the wall at some incidence. Both are symmetrical about the square attitude: there the axis is found.
"""

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from giraff_core.bounds import bounds_of
from giraff_core.kinematics.pose import Pose
from giraff_core.senses import Ultrasonic
from giraff_setup.condition import is_determined

FEWEST: Final = 10
"""Echoes at each rest."""
TAPE_SD: Final = 0.005
"""m, of each distance that a person measures with a tape."""
_HEADING_SD: Final = math.radians(0.3)
"""rad. Standard deviation of a reading's heading: the wheels err within the turn, and the clock has steps."""
_X_SD: Final = 0.006
_YAW_SD: Final = math.radians(1.25)
"""Less sure than this, nothing is told."""
_X_CHANGE: Final = 0.08
"""m from the robot file beyond which something else was heard, or something else was measured."""
_YAW_CHANGE: Final = math.radians(12.0)
_SEARCHED: Final = math.radians(16.0)
_STEP: Final = math.radians(0.1)
_LOST: Final = np.radians(np.arange(12.0, 37.0))
"""Incidences at which a sensor may begin to lose the wall."""
_EARLY: Final = math.radians(21.0)
"""Before this, it is the wall that ends."""
_LOSING: Final = math.radians(2.5)
"""Half of the width within which the share of heard pings falls."""
_HEARD_WITHIN: Final = 0.97
_HEARD_BEYOND: Final = 0.2
"""Shares of pings that give the wall's distance on either side of it."""
_FARTHER: Final = 1.12
"""Times the square distance: what is farther is a detour and not the wall."""
_NEARER: Final = 0.05
"""m nearer than the wall: something else."""
_MOST_NEARER: Final = 0.05
"""Share of them within 20°."""
_WITHIN: Final = math.radians(20.0)
_LEAST_SPREAD: Final = 0.003
_MOST_SPREAD: Final = 0.03
"""m."""
_UNLIKE: Final = 4.5
"""Gain of the logarithm of the likelihood by which the two sides are unlike."""
_MISFIT: Final = 3.5
"""Standard deviations by which a rest may be off the others."""
_CAPPED: Final = 3.0
"""Standard deviations beyond which an echo counts no more."""

Floats = npt.NDArray[np.float64]


class UntoldError(Exception):
    """The sensor's echoes do not tell. The message says why, and what to do."""


class Echo(NamedTuple):
    """One ping."""

    sensor: str
    range: float | None
    """m by the raw echo, whatever the file's scale; None: no echo."""
    at: Pose
    """Odometry's pose of the robot at the ping."""


class Wall(NamedTuple):
    """A wall as a tape has it."""

    at: Pose
    """Odometry's pose of the robot where it was measured."""
    distance: float
    """m from the middle between the wheels."""
    heading: float
    """rad in odometry's frame, towards the wall."""
    heading_sd: float

    def distance_from(self, pose: Pose) -> float:
        """Return m from the middle between the wheels at this pose."""
        ahead = (pose.x - self.at.x) * math.cos(self.heading) + (pose.y - self.at.y) * math.sin(self.heading)
        return self.distance - ahead


class SensorFit(NamedTuple):
    """Place, scale and axis of a sensor by its echoes: metres, radians."""

    x: float
    x_sd: float
    scale: float
    scale_sd: float
    yaw: float
    yaw_sd: float


class _Axis(NamedTuple):
    yaw: float
    sd: float
    bend: float
    """Growth of the range, as a share, per square of the radians beyond half the cone."""


def wall_of(at: Pose, left: float, right: float, track: float, *, ahead: bool) -> Wall:
    """Return the wall that is so many m from where the left and the right wheel touch the floor.

    `ahead`: the robot looks at it; else it looks away. Raises ValueError where no wall is like this.
    """
    difference = (left - right if ahead else right - left) / track
    if abs(difference) > math.sin(math.radians(10.0)):
        raise ValueError(
            f"the wheels' distances differ by {abs(left - right) * 1000.0:.0f} mm, as of a robot that stands more than "
            "10° askew; measure once more, or end it and park the robot square"
        )
    askew = math.asin(difference)
    heading = at.yaw - askew + (0.0 if ahead else math.pi)
    return Wall(at, (left + right) / 2.0, heading, math.sqrt(2.0) * TAPE_SD / track)


def fit(
    filed: Ultrasonic,
    wall: Wall,
    rests: Sequence[Sequence[Echo]],
    turn: Sequence[Echo],
    way_sd: float,
) -> SensorFit:
    """Return what the echoes of one sensor at each rest, and in a turn both ways, tell. Raises UntoldError.

    `filed`: where y counts. `way_sd`: of the way between rests by odometry, as a share of it.
    """
    spread = _spread(rests)
    axis = _axis(filed, wall, turn, spread)
    rows = [_row(echoes, filed, wall, axis, spread) for echoes in rests]
    tape = TAPE_SD / math.sqrt(2.0)
    prior = [[0.0, 0.0, 1.0 / tape, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0 / max(way_sd, 1e-4), 0.0]]
    table = np.array([*rows, *prior])
    design, wanted = table[:, :4], table[:, 4]
    normal = design.T @ design
    if not is_determined(normal):
        raise UntoldError("all its distances are alike, which tell no scale; let the robot drive between the rests")
    solved = np.linalg.solve(normal, design.T @ wanted)
    off = float(np.abs(design @ solved - wanted).max())
    x_sd, scale_sd = np.sqrt(np.diag(np.linalg.inv(normal)))[:2]
    x, scale = float(solved[0]), float(solved[1])
    bounds = bounds_of(Ultrasonic)["scale"]
    for is_wrong, why in (
        (off > _MISFIT, "its distances do not grow as the robot drives; is something beside the wall, or on it?"),
        (
            not bounds.low <= scale <= bounds.high,
            f"a metre of its echo would be {scale:.3f} m, beyond what warm air or a board's clock makes of it",
        ),
        (
            abs(x - filed.x) > _X_CHANGE,
            f"it would sit {abs(x - filed.x) * 1000.0:.0f} mm from where the file has it; measure both wheels anew",
        ),
        (
            x_sd > _X_SD,
            f"its place is known to ± {x_sd * 1000.0:.0f} mm only; calibrate odometry first, or begin nearer",
        ),
    ):
        if is_wrong:
            raise UntoldError(why)
    return SensorFit(x, float(x_sd), scale, float(scale_sd), axis.yaw, axis.sd)


def _spread(rests: Sequence[Sequence[Echo]]) -> float:
    """Return the standard deviation of the echoes at rest. Raises UntoldError."""
    off: list[float] = []
    for echoes in rests:
        ranges = np.array([echo.range for echo in echoes if echo.range is not None])
        if ranges.size < max(FEWEST, 0.7 * len(echoes)):
            raise UntoldError(
                f"only {ranges.size} of {len(echoes)} pings had an echo; check it, or take a smoother wall"
            )
        off += list(np.abs(ranges - np.median(ranges)))
    spread = max(_LEAST_SPREAD, 1.4826 * float(np.median(off)))
    if spread > _MOST_SPREAD:
        raise UntoldError(f"its ranges spread by ± {spread * 1000.0:.0f} mm at rest; see what else it hears")
    return spread


def _row(echoes: Sequence[Echo], filed: Ultrasonic, wall: Wall, axis: _Axis, spread: float) -> list[float]:
    """Return one equation of x, scale, the tape's error and the share by which the way is wrong, and its right side."""
    heard = [echo for echo in echoes if echo.range is not None]
    ranges = np.array([echo.range for echo in heard])
    kept = np.abs(ranges - np.median(ranges)) <= _CAPPED * spread
    if kept.sum() < max(FEWEST, 0.7 * ranges.size):
        raise UntoldError("its ranges at rest are of several distances; see what else it hears")
    distance = float(np.mean([wall.distance_from(echo.at) for echo in heard]))
    turned = float(np.mean([_wrapped(echo.at.yaw - wall.heading) for echo in heard]))
    longer = 1.0 + axis.bend * max(0.0, abs(math.remainder(turned + axis.yaw, math.tau)) - filed.half_cone) ** 2
    sd = math.hypot(spread / math.sqrt(float(kept.sum())), 0.001)
    row = [
        longer * math.cos(turned),
        float(ranges[kept].mean()),
        -longer,
        -longer * (distance - wall.distance),
        longer * (distance + filed.y * math.sin(turned)),
    ]
    return [value / sd for value in row]


def _axis(filed: Ultrasonic, wall: Wall, turn: Sequence[Echo], spread: float) -> _Axis:
    """Return the axis about which the echoes of a turn are symmetrical. Raises UntoldError."""
    turned = np.array([_wrapped(echo.at.yaw - wall.heading) for echo in turn])
    ranges = np.array([math.nan if echo.range is None else echo.range for echo in turn])
    square = np.array([wall.distance_from(echo.at) for echo in turn])
    square += filed.y * np.sin(turned) - filed.x * np.cos(turned)
    incidence = np.abs(_wrapped(turned + filed.yaw))
    core = np.isfinite(ranges) & (incidence < filed.half_cone)
    if core.sum() < FEWEST:
        raise UntoldError(f"only {core.sum()} echoes came while it looked at the wall; check it, or take a bare wall")
    square += float(np.median((ranges - square)[core]))
    with np.errstate(invalid="ignore"):
        nearer = ranges < square - _NEARER
        heard = ~nearer & (ranges < square * _FARTHER)
    within = incidence < _WITHIN
    if nearer[within].sum() > _MOST_NEARER * within.sum():
        side = "left" if np.median(turned[within & nearer]) > 0.0 else "right"
        raise UntoldError(f"it hears something nearer than the wall, to the {side}; clear it away")
    rough = _wrapped(turned)
    yaws = filed.yaw + np.arange(-_SEARCHED, _SEARCHED, _STEP)
    shapes = [_shape(_wrapped(rough + yaw), ranges, square, heard, filed.half_cone, spread) for yaw in yaws]
    sides = np.array([_sides(_wrapped(rough + yaw), heard) for yaw in yaws])
    likelihood = np.array([shape[0] for shape in shapes])
    alike = likelihood + sides.sum(axis=1).max(axis=1)
    unlike = likelihood + sides.max(axis=2).sum(axis=1)
    if unlike.max() - alike.max() > _UNLIKE:
        raise UntoldError(
            "it loses the wall earlier to one side; clear what stands there, or take a wall bare 1.2 m to either side"
        )
    best = int(alike.argmax())
    if _LOST[sides[best].sum(axis=0).argmax()] < _EARLY:
        raise UntoldError("it loses the wall early to both sides; take a wall that is bare 1.2 m to either side")
    weights = np.exp(alike - alike.max())
    weights /= weights.sum()
    yaw = float(weights @ yaws)
    sd = math.sqrt(float(weights @ (yaws - yaw) ** 2) + wall.heading_sd**2 + _HEADING_SD**2)
    if sd > _YAW_SD:
        raise UntoldError(
            f"its axis is known to ± {math.degrees(sd):.1f}° only: it hardly loses the wall, or hears it too seldom"
        )
    if abs(yaw - filed.yaw) > _YAW_CHANGE:
        raise UntoldError("it looks more than 12° aside of the robot file; correct the file, or turn the sensor")
    return _Axis(yaw, sd, shapes[best][1])


def _shape(
    incidence: Floats,
    ranges: Floats,
    square: Floats,
    heard: npt.NDArray[np.bool_],
    half_cone: float,
    spread: float,
) -> tuple[float, float]:
    """Return how likely the heard ranges are if the axis is so, and the bend that fits best."""
    beyond = np.maximum(0.0, np.abs(incidence[heard]) - half_cone) ** 2 * square[heard]
    off = ranges[heard] - square[heard]
    centred = beyond - beyond.mean()
    size = float(centred @ centred)
    bend = max(0.0, float(centred @ off) / size) if size > 0.0 else 0.0
    left = off - bend * beyond
    left -= np.median(left)
    return -0.5 * float(np.minimum((left / spread) ** 2, _CAPPED**2).sum()), bend


def _sides(incidence: Floats, heard: npt.NDArray[np.bool_]) -> list[list[float]]:
    """Return, of the left and the right side, how likely it is to lose the wall at each of `_LOST`."""
    made = []
    for side in (incidence >= 0.0, incidence < 0.0):
        share = (np.abs(incidence[side])[:, None] - _LOST + _LOSING) / (2.0 * _LOSING)
        chance = _HEARD_WITHIN + (_HEARD_BEYOND - _HEARD_WITHIN) * np.clip(share, 0.0, 1.0)
        made.append(np.log(np.where(heard[side][:, None], chance, 1.0 - chance)).sum(axis=0).tolist())
    return made


def _wrapped(angle: Any) -> Any:
    """Return rad within half a turn."""
    return (angle + math.pi) % math.tau - math.pi

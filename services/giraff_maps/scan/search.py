"""Looks for the pose of a turn where the guess may be far off: every place and heading of a window is scored."""

import math
from typing import Final

import numpy as np

from giraff_maps.scan.match import CELL, Cloud, Field, Floats, rotated

_POINTS: Final = 90  # of the turn, that are scored
_SIGMA: Final = 0.09  # m: standard deviation of a point off its wall
_STEP: Final = 2  # cells of the field from place to place
_TURN: Final = math.radians(1.5)
_PEAKS: Final = 2  # of each heading
_PEAK: Final = 4  # places to each side that belong to one peak
_APART, _APART_YAW = 0.25, 0.1  # m, rad between two poses that are not the same


def search(field: Field, cloud: Cloud, guess: Floats, metres: float, angle: float, most: int = 4) -> list[Floats]:
    """Return the best poses, best first, within so many m and rad of `guess`."""
    points = cloud.points[:: max(1, len(cloud.points) // _POINTS)]
    reach = math.ceil(metres / (CELL * _STEP)) * _STEP
    shifts = np.arange(-reach, reach + 1, _STEP)
    likely = field.likelihood(_SIGMA, reach)
    found: list[tuple[float, Floats]] = []
    for turn in np.arange(-angle, angle + _TURN / 2.0, _TURN):
        column, row = field.cells(rotated(guess[2] + turn, points) + guess[:2]).T + 2 * reach
        inside = (
            (column >= reach) & (column < likely.shape[0] - reach) & (row >= reach) & (row < likely.shape[1] - reach)
        )
        column, row = column[inside], row[inside]
        at = column[:, None, None] + shifts[:, None], row[:, None, None] + shifts
        score = likely[at].sum(axis=0) / len(points)
        for _ in range(_PEAKS):
            top = np.unravel_index(int(score.argmax()), score.shape)
            moved = np.array([shifts[top[0]] * CELL, shifts[top[1]] * CELL, turn])
            found.append((float(score[top]), guess + moved))
            around = tuple(slice(max(0, int(each) - _PEAK), int(each) + _PEAK + 1) for each in top)
            score[around] = 0.0
    best: list[Floats] = []
    for _, pose in sorted(found, key=lambda each: -each[0]):
        if len(best) < most and all(are_apart(pose, other, _APART, _APART_YAW) for other in best):
            best.append(pose)
    return best


def are_apart(one: Floats, other: Floats, metres: float, angle: float) -> bool:
    """Tell whether two poses differ by more than that."""
    far = math.hypot(one[0] - other[0], one[1] - other[1])
    return far > metres or abs(math.remainder(one[2] - other[2], math.tau)) > angle

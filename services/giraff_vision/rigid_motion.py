"""From places on the floor and where they are seen now to the motion of the robot that explains most of them."""

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from giraff_vision.ground import Array, Ground

_GATE: Final = 2.0
"""px. A corner that a try leaves farther off does not move with it."""
_REFINED_GATE: Final = 1.2
"""px, by least squares."""
_LARGE: Final = 0.5
"""px from which an error counts less."""
_TRIES: Final = 60
_APART: Final = 0.15
"""m between two corners that make a try: nearer ones tell no turn."""
_STRETCH: Final = 0.05
"""m by which their distance may seem to have changed."""
_FASTEST_TURN: Final = 0.8
"""rad since the key picture."""
_SWAY: Final = math.radians(0.5)
"""rad. Standard deviation of the body's roll and pitch between two pictures: a mast nods."""
_ROUNDS: Final = 4
_PRECISE: Final = 0.3
"""px. Standard deviation of a corner that was followed well."""
_VAGUE: Final = 0.1
"""m or rad. Standard deviation of a motion in its least certain direction, from which corners tell none."""
_LOWEST: Final = 0.2
"""Share of the lens's height that a lean must leave. No body leans farther, and at zero no picture can be warped."""
_LEAST: Final = 6
_SHARED: Final = 3.0
"""Corners near each other are off alike: three count as one."""
_STEP: Final = 1e-4
_STEPS: Final = np.vstack([np.zeros(5), np.eye(5) * _STEP])


class Consensus(NamedTuple):
    """What a try found."""

    motion: Array
    """x, y (m), yaw (rad), roll, pitch."""
    agrees: NDArray[np.bool_]
    """Which corners move as the motion has it."""
    rival: int
    """Number of corners that move alike in another way: something may move by itself."""


class Refined(NamedTuple):
    """Motion by least squares."""

    motion: Array
    agrees: NDArray[np.bool_]
    covariance: Array
    """(3, 3) of x, y and yaw; m², m·rad, rad²."""


def consensus(
    ground: Ground, floor: Array, pixels: Array, sway: Array, chance: "np.random.Generator"
) -> Consensus | None:
    """Return the motion of two corners that most others agree with (RANSAC). None: no two make a motion.

    `floor`: where corners were at the key picture; `pixels`: where they are seen now; `sway`: roll and pitch.
    Fischler and Bolles 1981.
    """
    now = ground.floor(pixels, *sway)
    one, other = chance.integers(0, len(floor), (2, _TRIES))
    before, after = floor[other] - floor[one], now[other] - now[one]
    turn = np.arctan2(before[:, 1], before[:, 0]) - np.arctan2(after[:, 1], after[:, 0])
    turn = np.remainder(turn + math.pi, math.tau) - math.pi
    length = np.hypot(*before.T)
    usable = (length > _APART) & (np.abs(length - np.hypot(*after.T)) < _STRETCH) & (np.abs(turn) < _FASTEST_TURN)
    if not usable.any():
        return None
    turn, at, place = turn[usable], floor[one[usable]], now[one[usable]]
    cos, sin = np.cos(turn), np.sin(turn)
    x = at[:, 0] - (cos * place[:, 0] - sin * place[:, 1])
    y = at[:, 1] - (sin * place[:, 0] + cos * place[:, 1])
    tries = np.column_stack([x, y, turn, np.broadcast_to(sway, (len(x), 2))])
    off = ((ground.seen(floor, tries) - pixels) ** 2).sum(axis=2)
    agrees = off < _GATE**2
    best = int(np.maximum(0.0, 1.0 - off / (_GATE**2)).sum(axis=1).argmax())
    rival = int((agrees & ~agrees[best]).sum(axis=1).max())
    return Consensus(tries[best], agrees[best], rival)


def refined(ground: Ground, floor: Array, pixels: Array, begin: Consensus, sway: Array) -> Refined | None:
    """Return the motion by least squares in pixels, the body's sway estimated with it. None: too few agree.

    `sway`: roll and pitch that are expected, from the picture before. Large errors count less (Huber 1964).
    """
    motion, agrees = begin.motion, begin.agrees
    expected = np.concatenate([np.zeros(3), sway])
    prior = np.diag([0.0, 0.0, 0.0, 1.0, 1.0]) * (_PRECISE / _SWAY) ** 2
    information, off = prior, np.zeros(len(floor))
    for _ in range(_ROUNDS):
        places = ground.seen(floor[agrees], motion + _STEPS)
        error = (pixels[agrees] - places[0]).ravel()
        slope = ((places[1:] - places[0]) / _STEP).reshape(5, -1).T
        weight = 1.0 / np.maximum(1.0, np.abs(error) / _LARGE)
        information = (slope.T * weight) @ slope + prior
        if not np.isfinite(information).all() or np.linalg.eigvalsh(information)[0] < (_PRECISE / _VAGUE) ** 2:
            return None  # rounding may leave a singular matrix regular
        motion = motion + np.linalg.solve(information, slope.T @ (weight * error) - prior @ (motion - expected))
        if ground.lens_height(*motion[3:]) < _LOWEST * ground.lens_height():
            return None
        off = ((ground.seen(floor, motion[None])[0] - pixels) ** 2).sum(axis=1)
        agrees = off < _REFINED_GATE**2
    if agrees.sum() < _LEAST:
        return None
    variance = off[agrees].sum() / max(1, 2 * int(agrees.sum()) - 3)
    return Refined(motion, agrees, (np.linalg.inv(information) * variance * _SHARED)[:3, :3])

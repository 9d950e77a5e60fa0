"""Find the attitude of a tilt sensor in its joystick, from gravity in three poses: flat, forward, to the left."""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

from giraff_core.tilt.clutch import Vector
from giraff_core.tilt.mount import Rows, angles_of, cross, dot

READINGS: Final = 50
"""1 s of a board's readings, of which the mean counts."""
LEAST_TILT: Final = 15.0  # degrees
MOST_TILT: Final = 75.0  # degrees
MOST_OFF: Final = 20.0
"""Degrees. A sensor further off a right angle, or a tilt further off an axis, leaves two answers."""

_GRAVITY: Final = 9.81
_GRAVITY_WITHIN: Final = 2.0  # m/s²; the sensor's own offset is up to 1.5
_STILL: Final = 0.5  # m/s² from the mean: 3 degrees
_SQUARE: Final[tuple[Vector, ...]] = (
    (1.0, 0.0, 0.0),
    (-1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0),
    (0.0, -1.0, 0.0),
    (0.0, 0.0, 1.0),
    (0.0, 0.0, -1.0),
)
"""The axes of the sensor, each in both directions."""

_MIRRORED: Final = "left and right, or forward and backward, were exchanged"
_NOT_SQUARE: Final = "both tilts were along one axis, and one is to be forward, the other to the left"
_TURNED: Final = {0: "not turned", 90: "turned 90° to the left", 180: "turned by 180°", 270: "turned 90° to the right"}
"""By degrees, counter-clockwise as seen from above."""


class PoseError(Exception):
    """The pose cannot be used. One line: what is wrong, and what to do."""


class DoubtError(Exception):
    """The poses do not agree. One line: what is wrong, and what to do."""


class AttitudeFit(NamedTuple):
    """The attitude of the sensor in the joystick."""

    roll: float
    """rad. About the joystick's fixed axes: first roll, then pitch, then yaw."""
    pitch: float
    yaw: float
    off_level: float
    """Degrees between the joystick's level and the sensor's."""
    words: str
    """The turn of the sensor, in words."""


def gravity_of(readings: Sequence[Vector]) -> Vector:
    """Return the mean of `readings`, m/s². Raises PoseError unless they are gravity in something that is still."""
    x, y, z = (sum(axis) / len(readings) for axis in zip(*readings, strict=True))
    mean = (x, y, z)
    if not all(math.dist(reading, mean) <= _STILL for reading in readings):  # also of what is no number
        raise PoseError("the joystick does not keep still; rest it on something firm")
    length = math.hypot(*mean)
    if abs(length - _GRAVITY) > _GRAVITY_WITHIN:
        raise PoseError(
            f"the sensor reads {length:.1f} m/s², and gravity is {_GRAVITY:g}; "
            "unplug the board for a second, or replace the shield"
        )
    return mean


def require_level(flat: Vector) -> None:
    """Raise PoseError where the sensor is too far off every right angle to tell how it was glued."""
    if (off := _off_level(flat)) > MOST_OFF:
        raise PoseError(
            f"the sensor is {off:.0f} degrees off level; lay the joystick flat, or glue the shield at a right angle"
        )


def require_tilt(flat: Vector, tilted: Vector) -> None:
    """Raise PoseError unless the joystick is tilted far enough, and not too far, to tell its axes."""
    angle = degrees_between(flat, tilted)
    if not LEAST_TILT <= angle <= MOST_TILT:
        raise PoseError(
            f"the joystick is tilted by {angle:.0f} degrees; tilt it by {LEAST_TILT:g} to {MOST_TILT:g}, best about 30"
        )


def find(flat: Vector, forward: Vector, left: Vector) -> AttitudeFit:
    """Return how the sensor sits that reads `flat`, `forward` and `left` in the three poses. Raises DoubtError."""
    up = _unit(flat)
    nearest_up = _nearest(up)
    # A tilt to the left is turned back by a quarter turn: each of the two then shows where the axis x is.
    ahead = _axis(_across(_turned(forward, up, nearest_up), nearest_up), "forward")
    by_left = _axis(cross(_across(_turned(left, up, nearest_up), nearest_up), nearest_up), "to the left")
    if ahead != by_left:
        raise DoubtError(f"{_MIRRORED if dot(ahead, by_left) < 0.0 else _NOT_SQUARE}; do it again")
    x = _turned(ahead, nearest_up, up)
    rows = (x, cross(up, x), up)
    roll, pitch, yaw = angles_of(rows)
    return AttitudeFit(roll, pitch, yaw, _off_level(flat), _words((ahead, cross(nearest_up, ahead), nearest_up)))


def degrees_between(one: Vector, other: Vector) -> float:
    """Return the angle between two directions."""
    return math.degrees(math.atan2(math.hypot(*cross(one, other)), dot(one, other)))


def _off_level(flat: Vector) -> float:
    return degrees_between(flat, _nearest(flat))


def _axis(direction: Vector, tilt: str) -> Vector:
    """Return the sensor's axis that points so. Raises DoubtError where it is not clear which one does."""
    nearest = _nearest(direction)
    if (off := degrees_between(direction, nearest)) > MOST_OFF:
        raise DoubtError(
            f"the tilt {tilt} is {off:.0f} degrees beside the sensor's axes; do it again, and tilt straight {tilt}"
        )
    return nearest


def _nearest(direction: Vector) -> Vector:
    return max(_SQUARE, key=lambda axis: dot(axis, direction))


def _across(vector: Vector, up: Vector) -> Vector:
    """Return what is level in `vector`, as a unit vector."""
    along = dot(vector, up)
    x, y, z = (part - along * axis for part, axis in zip(vector, up, strict=True))
    return _unit((x, y, z))


def _turned(vector: Vector, one: Vector, other: Vector) -> Vector:
    """Return `vector` turned by the smallest turn that brings the unit vector `one` to `other`."""
    axis, cosine = cross(one, other), dot(one, other)
    turn, along = cross(axis, vector), dot(axis, vector) / (1.0 + cosine)
    x, y, z = (v * cosine + t + a * along for v, t, a in zip(vector, turn, axis, strict=True))
    return x, y, z


def _unit(vector: Vector) -> Vector:
    length = math.hypot(*vector)
    x, y, z = (part / length for part in vector)
    return x, y, z


def _words(rows: Rows) -> str:
    """Return how the sensor is turned, by right angles. The joystick's axis x is towards the person, y to the right."""
    ahead, left, up = rows
    if up[2] > 0.0:
        quarter = round(math.degrees(angles_of(rows)[2])) % 360
        return _TURNED[quarter]
    if up[2] < 0.0:
        return "upside down"
    if ahead[2]:
        return f"on edge, facing {'backward' if ahead[2] > 0.0 else 'forward'}"
    return f"on edge, facing {'right' if left[2] > 0.0 else 'left'}"

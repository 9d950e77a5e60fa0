"""What a sensor on a body that leans tells of the level way ahead of it."""

import math
from typing import Final

from giraff_core.senses import Ultrasonic
from giraff_guard.motion import Lean

_SEES_FLOOR: Final = math.radians(3.0)
"""rad that a sensor dips, from which on it may hear the floor."""


def floor_from(pose: Ultrasonic, half_cone: float, lean: Lean) -> float:
    """Return m from the sensor from where on it may hear the floor; infinite where it hardly dips."""
    dip = lean.angle * math.cos(pose.yaw)
    if dip <= _SEES_FLOOR:
        return math.inf
    height = lean.pivot + (pose.z - lean.pivot) * math.cos(lean.angle) - pose.x * math.sin(lean.angle)
    return max(0.0, height) / math.sin(dip + half_cone)


def level_distance(distance: float, pose: Ultrasonic, lean: Lean) -> float:
    """Return the level m, from the sensor's place on an upright robot, to what is `distance` m along its axis."""
    along = math.cos(pose.yaw)
    shift = (pose.z - lean.pivot) * math.sin(lean.angle) * along
    return max(0.0, distance * math.cos(lean.angle * along) + shift)

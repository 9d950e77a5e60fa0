"""Where each pixel of a camera looks, from the robot and in the room."""

import math
from typing import Any, Final, NamedTuple

import numpy as np

from giraff_core.senses import Camera
from giraff_sim.camera.textures import Index, Single, level_of
from giraff_sim.world.room import Pose

FARTHEST: Final = 60.0
"""m in the plane. Nothing is farther."""
_DIRECTIONS: Final = 4.0  # in a pixel's width
_LENGTHWISE: Final = 0.7  # a pixel on the floor is longer than wide; nearer to its length, or the far floor sparkles


class View(NamedTuple):
    """From the robot, for one lean: flat arrays, one number a pixel."""

    x: float
    """m, of the lens."""
    y: float
    z: float
    cos: Single
    """Cosine of the direction in the plane."""
    sin: Single
    slope: Single
    """m up for each m in the plane."""
    stretch: Single
    """m of the ray for each m in the plane, and pixel of focal length: what a pixel covers at 1 m in the plane."""
    direction: Index
    """Number of the direction in the plane."""
    cosines: Single
    """Cosines of all directions, which are finer than pixels."""
    sines: Single
    floor: Single
    """m in the plane to the floor; infinite above the horizon."""
    level: Index
    """Softness of the floor."""


class Eye(NamedTuple):
    """Rays of the camera in the room."""

    view: View
    x: float
    y: float
    cos: Single
    sin: Single
    cosines: Single
    sines: Single

    def part(self, pixels: slice) -> "Eye":
        """Return the eye of some pixels only."""
        view = self.view
        some = view._replace(
            slope=view.slope[pixels],
            stretch=view.stretch[pixels],
            direction=view.direction[pixels],
            floor=view.floor[pixels],
            level=view.level[pixels],
        )
        return self._replace(view=some, cos=self.cos[pixels], sin=self.sin[pixels])


def view_from(camera: Camera, rays: Single, lean: float, pivot: float) -> View:
    """Return the view of a robot that leans forward by `lean` rad about an axle at `pivot` m.

    `rays`: of the upright robot, (3, pixels): ahead, left, up.
    """
    cos, sin = math.cos(lean), math.sin(lean)
    above = camera.z - pivot
    ahead, left, up = rays
    ahead, up = ahead * cos + up * sin, up * cos - ahead * sin
    z = pivot + above * cos - camera.x * sin
    plane = np.maximum(np.sqrt(ahead * ahead + left * left), 1e-6)
    slope = up / plane
    stretch = np.sqrt(1.0 + slope * slope) / camera.focal_x
    toward_x, toward_y = turn(ahead, left, math.cos(camera.yaw), -math.sin(camera.yaw))
    toward, step = np.arctan2(toward_y, toward_x), 1.0 / (_DIRECTIONS * camera.focal_x)
    direction = np.rint((toward - toward.min()) / step).astype(np.intp)
    angles = toward.min() + camera.yaw + step * np.arange(direction.max() + 1)
    floor = np.where(slope < 0.0, z / np.maximum(-slope, 1e-9), np.float32(np.inf))
    width = np.minimum(floor, FARTHEST) * stretch
    long = np.maximum(width * camera.focal_x / z, 1.0)
    return View(
        x=camera.x * cos + above * sin,
        y=camera.y,
        z=z,
        cos=ahead / plane,
        sin=left / plane,
        slope=slope,
        stretch=stretch,
        direction=direction,
        cosines=np.cos(angles).astype(np.float32),
        sines=np.sin(angles).astype(np.float32),
        floor=floor,
        level=level_of(width * long**_LENGTHWISE),
    )


def at(view: View, pose: Pose) -> Eye:
    """Return the eye of a robot at this pose."""
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    x, y = turn(view.x, view.y, cos, sin)
    return Eye(
        view,
        pose.x + x,
        pose.y + y,
        *turn(view.cos, view.sin, cos, sin),
        *turn(view.cosines, view.sines, cos, sin),
    )


def turn(x: Any, y: Any, cos: float, sin: float) -> tuple[Any, Any]:
    """Return a vector turned to the left."""
    return x * cos - y * sin, x * sin + y * cos

"""The true lens of a simulated camera: which way each of its pixels looks.

`giraff calibrate camera` estimates a lens with OpenCV. This is a geometry of its own, so that an error of either shows.
"""

import math
from typing import Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from giraff_core.senses import Camera
from giraff_sim.camera.scene import Lens

Array = NDArray[np.float64]

_ITERATIONS: Final = 30
_EXACT: Final = 1e-9
_GRAIN: Final = 0.3  # share of the light that a grain leaves
_THUMB: Final = 0.17  # radius of its print, in heights of the picture
_RIDGES: Final = 0.04  # from one to the next, in heights of the picture


def resized(camera: Camera, width: int, height: int) -> Camera:
    """Return this camera as it is when it gives pictures of another size."""
    across, down = width / camera.width, height / camera.height

    def scaled(center: float | None, share: float) -> float | None:
        return None if center is None else (center + 0.5) * share - 0.5

    return msgspec.structs.replace(
        camera,
        width=width,
        height=height,
        focal_x=camera.focal_x * across,
        focal_y=camera.focal_y * down,
        center_x=scaled(camera.center_x, across),
        center_y=scaled(camera.center_y, down),
    )


def rays(camera: Camera) -> Array:
    """Return for each pixel the point at depth 1 that it sees: (height, width, 3), to the right, down and ahead."""
    center_x = (camera.width - 1) / 2 if camera.center_x is None else camera.center_x
    center_y = (camera.height - 1) / 2 if camera.center_y is None else camera.center_y
    bent_x, bent_y = np.meshgrid(
        (np.arange(camera.width) - center_x) / camera.focal_x, (np.arange(camera.height) - center_y) / camera.focal_y
    )
    k1, k2, p1, p2, k3 = camera.distortion
    x, y = bent_x, bent_y
    for _ in range(_ITERATIONS if any(camera.distortion) else 0):
        square = x * x + y * y
        radial = 1.0 + square * (k1 + square * (k2 + square * k3))
        aside = 2.0 * p1 * x * y + p2 * (square + 2.0 * x * x)
        along = p1 * (square + 2.0 * y * y) + 2.0 * p2 * x * y
        before, x, y = x, (bent_x - aside) / radial, (bent_y - along) / radial
        if np.abs(x - before).max() < _EXACT:
            break
    return np.stack([x, y, np.ones_like(x)], axis=-1).astype(np.float64, copy=False)


def turned(camera: Camera) -> Array:
    """Return the matrix from right, down and ahead of a camera to ahead, left and up of its robot."""
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a), np.sin(a)) for a in (camera.roll, camera.pitch, camera.yaw))
    roll = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    pitch = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    yaw = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    optical = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
    matrix: Array = yaw @ pitch @ roll @ optical
    return matrix


def dirt(lens: Lens, camera: Camera, seed: int) -> Array:
    """Return the share of the light that the dirt on a lens leaves to each pixel: (height, width)."""
    width, height = camera.width, camera.height
    chance, clear = np.random.default_rng(seed), np.ones((height, width))
    row, column = np.mgrid[0:height, 0:width]
    for _ in range(lens.specks):
        at, radius = chance.uniform(0.0, (height, width)), chance.uniform(1.0, 4.0) * width / 320
        inside = np.clip(radius + 0.5 - np.hypot(row - at[0], column - at[1]), 0.0, 1.0)
        clear = np.minimum(clear, 1.0 - (1.0 - _GRAIN) * inside)
    if lens.print:
        off = np.hypot(row / height - 0.68, (column - 0.45 * width) / height)
        clear *= 1.0 - lens.print * np.cos(math.pi * off / _RIDGES) ** 2 * np.exp(-((off / _THUMB) ** 2))
    return clear

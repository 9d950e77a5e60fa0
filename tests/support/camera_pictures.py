"""Pictures of a chessboard and of a sheet on the floor, by a projection of its own: nothing here is used to calibrate.

The lens is the plumb-bob model, written down again, so that an error of it in the product would show.
"""

import math
import random
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]
Grey = NDArray[np.uint8]

FINE = 2
"""Rays a pixel, in each direction."""
SQUARE = 0.025
"""m."""


class TrueCamera(NamedTuple):
    """A camera as it truly is."""

    width: int = 320
    height: int = 240
    focal_x: float = 230.0
    focal_y: float = 230.0
    center_x: float = 159.5
    center_y: float = 119.5
    distortion: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    """k1, k2, p1, p2."""
    z: float = 1.0
    pitch: float = 0.35
    roll: float = 0.0

    def rays(self) -> tuple[Array, Array]:
        """Return x and y of each ray at one metre ahead of the lens; FINE² of each pixel."""
        steps = (np.arange(self.width * FINE) + 0.5) / FINE - 0.5
        rows = (np.arange(self.height * FINE) + 0.5) / FINE - 0.5
        across, down = np.meshgrid((steps - self.center_x) / self.focal_x, (rows - self.center_y) / self.focal_y)
        u: Array = across.astype(np.float32)
        v: Array = down.astype(np.float32)
        x, y = u, v
        k1, k2, p1, p2 = self.distortion
        for _ in range(8 if any(self.distortion) else 0):
            r = x * x + y * y
            radial = 1.0 + k1 * r + k2 * r * r
            x, y = (
                (u - 2.0 * p1 * x * y - p2 * (r + 2.0 * x * x)) / radial,
                (v - p1 * (r + 2.0 * y * y) - 2.0 * p2 * x * y) / radial,
            )
        return x, y


def drawn(seed: int) -> TrueCamera:
    """Draw a camera around the one that the robot file has."""
    rng = random.Random(f"{seed}/camera")
    focal = 230.0 * rng.uniform(0.97, 1.03)
    return TrueCamera(
        focal_x=focal,
        focal_y=focal * rng.uniform(0.995, 1.005),
        center_x=159.5 + rng.uniform(-5.0, 5.0),
        center_y=119.5 + rng.uniform(-5.0, 5.0),
        distortion=(
            rng.uniform(-0.2, 0.05),
            rng.uniform(-0.03, 0.05),
            rng.uniform(-2e-3, 2e-3),
            rng.uniform(-2e-3, 2e-3),
        ),
        z=1.0 * rng.uniform(0.97, 1.03),
        pitch=0.35 + math.radians(rng.uniform(-2.0, 2.0)),
        roll=math.radians(rng.uniform(-1.0, 1.0)),
    )


def turned(axis: int, angle: float) -> NDArray[np.float64]:
    c, s = math.cos(angle), math.sin(angle)
    matrix = np.eye(3)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrix[a, a] = matrix[b, b] = c
    matrix[a, b], matrix[b, a] = -s, s
    return matrix


class Studio:
    """Takes pictures with one camera."""

    def __init__(self, camera: TrueCamera, seed: int = 0, noise: float = 2.5) -> None:
        self.camera = camera
        self._x, self._y = camera.rays()
        self._rng = np.random.default_rng(seed)
        self._noise = noise

    def board(
        self, x: float, y: float, away: float, tilt: float = 0.0, turn: float = 0.0, spin: float = 0.0, **how: Any
    ) -> bytes:
        """Return the JPEG of a board whose middle is `away` m ahead of the lens, and x m right and y m below its axis.

        `tilt`, `turn`, `spin`: rad about the picture's x, y and z.
        """
        axes = turned(2, spin) @ turned(1, turn) @ turned(0, tilt)
        a, b = self._on_plane(axes, np.array([x, y, away]))
        columns, rows = how.pop("squares", (10, 7))
        square = how.pop("square", SQUARE)
        a, b = a / square + columns / 2.0, b / square + rows / 2.0
        on_paper = (abs(a - columns / 2.0) < columns / 2.0 + 0.94) & (b > -0.36) & (b < rows + 1.04)
        on_squares = (a > 0) & (a < columns) & (b > 0) & (b < rows)
        black = on_squares & ((np.floor(a) + np.floor(b)) % 2 == 0)
        light = np.where(on_paper, np.where(black, np.float32(30), np.float32(215)), np.float32(110))
        if how.pop("glare", False):
            light = light + 400 * np.exp(-((a - 4) ** 2 + (b - 4) ** 2) / 3)
        return self._taken(light, **how)

    def sheet(
        self, ahead: float, left: float = 0.0, yaw: float = 0.0, size: tuple[float, float] = (0.297, 0.210), **how: Any
    ) -> bytes:
        """Return the JPEG of a sheet on the floor; `ahead` m, `left` m: its middle from below the lens."""
        camera = self.camera
        rotation = turned(1, camera.pitch) @ turned(0, camera.roll)  # camera (x ahead, y left, z up) to base_link
        directions = np.stack([np.ones_like(self._x), -self._x, -self._y])
        dx, dy, dz = (np.tensordot(rotation[i].astype(np.float32), directions, 1) for i in range(3))
        with np.errstate(divide="ignore", invalid="ignore"):
            far = np.where(dz < -1e-3, -camera.z / dz, np.nan)
        px, py = far * dx - ahead, far * dy - left
        c, s = math.cos(yaw), math.sin(yaw)
        a, b = px * c + py * s, py * c - px * s
        on_sheet = (abs(a) < size[0] / 2.0) & (abs(b) < size[1] / 2.0)
        floor = how.pop("floor", 105.0) + 8.0 * np.sin(9.0 * px) * np.sin(7.0 * py)
        light = np.where(np.isnan(far), np.float32(150.0), np.where(on_sheet, np.float32(225.0), floor))
        return self._taken(light, **how)

    def _on_plane(self, axes: NDArray[np.float64], origin: NDArray[np.float64]) -> tuple[Array, Array]:
        """Return where each ray meets a plane, in the plane's own x and y."""
        inverse = np.linalg.inv(np.column_stack([axes[:, 0], axes[:, 1], origin])).astype(np.float32)
        a, b, w = (inverse[i, 0] * self._x + inverse[i, 1] * self._y + inverse[i, 2] for i in range(3))
        return a / w, b / w

    def _taken(self, light: Array, blur: float = 0.5, smear: int = 0, quality: int = 80) -> bytes:
        camera = self.camera
        grey = light.astype(np.float32).reshape(camera.height, FINE, camera.width, FINE).mean(axis=(1, 3))
        off_axis = self._x[::FINE, ::FINE] ** 2 + self._y[::FINE, ::FINE] ** 2
        grey = grey - grey * off_axis * 0.25
        grey = np.asarray(cv2.GaussianBlur(grey, (0, 0), blur), dtype=np.float32)
        if smear:
            grey = np.asarray(cv2.blur(grey, (smear, 1)), dtype=np.float32)
        grey += self._rng.normal(0.0, self._noise, grey.shape).astype(np.float32)
        done, jpeg = cv2.imencode(".jpg", np.clip(grey, 0, 255).astype(np.uint8), [cv2.IMWRITE_JPEG_QUALITY, quality])
        assert done
        return jpeg.tobytes()


def sheets(studio: Studio, seed: int = 0) -> list[bytes]:
    """Return three pictures of a sheet at each of three places."""
    rng = random.Random(f"{seed}/sheets")
    places = [(rng.uniform(1.15, 1.3), rng.uniform(-0.25, 0.25), rng.uniform(0.0, 3.0)) for _ in range(3)]
    return [studio.sheet(*place) for place in places for _ in range(3)]


def board_views(studio: Studio, seed: int = 0) -> list[bytes]:
    """Return the pictures that a person takes who follows the guide, each a little otherwise."""
    rng = random.Random(f"{seed}/views")
    t = 0.45
    places = (
        (0.0, 0.0, 0.36, 0.0, 0.0, 0.0),
        (-0.10, 0.0, 0.40, 0.0, t, 0.0),
        (0.10, 0.0, 0.40, 0.0, -t, 0.0),
        (0.0, -0.07, 0.40, t, 0.0, 0.0),
        (0.0, 0.07, 0.40, -t, 0.0, 0.0),
        (-0.13, -0.105, 0.45, 0.2, -t, 0.0),
        (0.13, -0.105, 0.45, -0.2, t, 0.0),
        (-0.13, 0.105, 0.45, t, 0.2, 0.0),
        (0.13, 0.105, 0.45, -t, -0.2, 0.0),
        (0.0, 0.02, 0.36, 0.0, -0.6, 3.0),
        (0.0, -0.02, 0.36, -0.6, 0.0, 1.4),
    )
    return [
        studio.board(
            x + rng.uniform(-0.01, 0.01),
            y + rng.uniform(-0.005, 0.005),
            away + rng.uniform(0.0, 0.02),
            tilt + rng.uniform(-0.1, 0.1),
            turn + rng.uniform(-0.1, 0.1),
            spin,
        )
        for x, y, away, tilt, turn, spin in places
    ]

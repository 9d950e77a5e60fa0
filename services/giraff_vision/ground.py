"""Where on the floor each pixel of a camera looks, and where a place on the floor is in its picture.

Pictures are straightened first, so that all pixels here are of a lens without distortion. Floor is x and y in m in
`base_link`. Both are arrays of (n, 2).
"""

from functools import cached_property
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from giraff_core.kinematics.rigid import rigid
from giraff_core.senses import Camera
from giraff_schemas.trouble import Trouble

Array = NDArray[np.float64]
Grey = NDArray[np.uint8]
"""(rows, columns)."""

FARTHEST: Final = 2.6
"""m from the lens. Floor beyond it is a few pixels high, and a small error of the camera's tilt is much there."""
_RIM: Final = 4
"""px at the picture's edges that are left out."""
_MOST_OUTLINE: Final = 24
"""Pixels of an outline of the ground."""
_LEAST_DOWN: Final = 1e-6
_NEAREST: Final = 1e-3
"""m of depth."""


class PictureError(ValueError):
    """A picture that cannot be used. `trouble` says why and what to do."""

    def __init__(self, trouble: Trouble) -> None:
        super().__init__(str(trouble))
        self.trouble = trouble


class Ground:
    """Of one camera and one size of its pictures."""

    def __init__(self, camera: Camera, width: int, height: int) -> None:
        """`width`, `height`: of its pictures, px. Raises PictureError where they are larger, or of another shape."""
        across, down = width / camera.width, height / camera.height
        if width > camera.width or abs(across * camera.height - height) > 1.0:
            raise PictureError(
                Trouble(
                    f"pictures have {width} by {height} px, and the camera of the robot file "
                    f"{camera.width} by {camera.height}",
                    "write the size of its full pictures there, and calibrate the camera anew",
                )
            )
        self.width, self.height = width, height
        center_x = (camera.width - 1) / 2 if camera.center_x is None else camera.center_x
        center_y = (camera.height - 1) / 2 if camera.center_y is None else camera.center_y
        self._lens = np.array(
            [
                [camera.focal_x * across, 0.0, (center_x + 0.5) * across - 0.5],
                [0.0, camera.focal_y * down, (center_y + 0.5) * down - 0.5],
                [0.0, 0.0, 1.0],
            ]
        )
        self._maps: tuple[NDArray[np.float32], NDArray[np.float32]] | None = None
        """Column and row in the picture as it is, of each pixel here; None: it is straight."""
        if any(camera.distortion):
            bends = np.array(camera.distortion)
            across_at, down_at = cv2.initUndistortRectifyMap(
                self._lens, bends, np.eye(3), self._lens, (width, height), cv2.CV_32FC1
            )
            self._maps = np.asarray(across_at, np.float32), np.asarray(down_at, np.float32)
        place = rigid(camera.x, camera.y, camera.z, camera.roll, camera.pitch, camera.yaw)
        body = np.array(place.rotation)
        # Pictures have x to the right, y down and z ahead.
        turned = np.column_stack([-body[:, 1], -body[:, 2], body[:, 0]])
        self._lens_at = np.array(place.translation)
        self._to_body = turned @ np.linalg.inv(self._lens)
        self._to_picture = self._lens @ turned.T

    def straightened(self, grey: Grey) -> Grey:
        """Return the picture as a lens without distortion would give it."""
        if self._maps is None:
            return grey
        return np.asarray(cv2.remap(grey, *self._maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), np.uint8)

    def bent(self, pixels: Array) -> tuple[tuple[int, int], ...]:
        """Return where these pixels are in the picture as it was."""
        columns, rows = np.rint(pixels).astype(np.intp).reshape(-1, 2).T
        if self._maps is not None:
            at = np.clip(rows, 0, self.height - 1), np.clip(columns, 0, self.width - 1)
            columns, rows = (np.rint(each[at]).astype(np.intp) for each in self._maps)
        return tuple(zip(columns.tolist(), rows.tolist(), strict=True))

    def lens_height(self, roll: float = 0.0, pitch: float = 0.0) -> float:
        """Return m of the lens above the floor, of a body that leans. At zero the floor is seen as a line."""
        return -float(self._lens_at @ np.array([pitch, -roll, -1.0]))

    def floor(self, pixels: Array, roll: float = 0.0, pitch: float = 0.0) -> Array:
        """Return the floor at pixels of a body that leans by roll and pitch (rad, small). What looks up is far away."""
        ray = np.column_stack([pixels, np.ones(len(pixels))]) @ self._to_body.T
        down = ray @ np.array([pitch, -roll, -1.0])
        high = self.lens_height(roll, pitch)
        return np.asarray(self._lens_at[:2] + ray[:, :2] * (high / np.maximum(down, _LEAST_DOWN))[:, None])

    def seen(self, floor: Array, motions: Array) -> Array:
        """Return the pixels of the floor after each of some motions, as of `projections`: (k, n, 2)."""
        spots = np.column_stack([floor, np.ones(len(floor))]) @ self.projections(motions).transpose(0, 2, 1)
        return np.asarray(spots[..., :2] / np.maximum(spots[..., 2:], _NEAREST))

    def projections(self, motions: Array) -> Array:
        """Return the matrices from floor (x, y, 1) to pixels (times depth) after motions: (k, 3, 3).

        `motions`: (k, 5) of x, y (m) and yaw (rad) in the `base_link` of before, and of the body's roll and pitch since
        (rad, small).
        """
        x, y, yaw, roll, pitch = motions.T
        cos, sin = np.cos(yaw), np.sin(yaw)
        ahead = np.stack([cos, sin, -cos * x - sin * y], axis=-1)
        left = np.stack([-sin, cos, sin * x - cos * y], axis=-1)
        up = pitch[:, None] * ahead - roll[:, None] * left  # the body leans, which is as if the floor did
        spots = np.stack([ahead, left, up], axis=1)
        spots[:, :, 2] -= self._lens_at
        return np.asarray(self._to_picture @ spots)

    @cached_property
    def away(self) -> NDArray[np.float64]:
        """m in the plane from the lens to the floor that each pixel shows; infinite where it shows none that counts."""
        columns, rows = np.meshgrid(np.arange(self.width), np.arange(self.height))
        pixels = np.column_stack([columns.ravel(), rows.ravel()]).astype(np.float64)
        down = np.column_stack([pixels, np.ones(len(pixels))]) @ self._to_body[2]
        away = np.hypot(*(self.floor(pixels) - self._lens_at[:2]).T)
        away[(down > -_LEAST_DOWN) | (away > FARTHEST)] = np.inf
        away = away.reshape(self.height, self.width)
        away[:_RIM] = away[-_RIM:] = np.inf
        away[:, :_RIM] = away[:, -_RIM:] = np.inf
        return np.asarray(away)

    @cached_property
    def bands(self) -> tuple[NDArray[np.uint8], ...]:
        """Masks of the nearer and of the farther half of the floor, by ratio: 255 where it is. Empty: no floor is seen.

        A near floor and a far one differ in contrast, and corners are sought in each by its own.
        """
        seen = self.away[np.isfinite(self.away)]
        if not len(seen):
            return ()
        middle = np.sqrt(seen.min() * seen.max())
        return tuple(
            np.where(band, 255, 0).astype(np.uint8)
            for band in (self.away <= middle, (self.away > middle) & np.isfinite(self.away))
        )

    @cached_property
    def mask(self) -> NDArray[np.uint8]:
        """Both bands."""
        return np.where(np.isfinite(self.away), 255, 0).astype(np.uint8)

    @cached_property
    def outline(self) -> tuple[tuple[int, int], ...]:
        """Corners of the mask's outline in the picture as it was; empty where no floor is seen."""
        found, _ = cv2.findContours(self.mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        if not found:
            return ()
        largest = max(found, key=len)
        return self.bent(cv2.approxPolyDP(largest, 1.5, True)[:_MOST_OUTLINE, 0].astype(np.float64))

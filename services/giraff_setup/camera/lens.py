"""The lens of a camera, fitted to views of the chessboard."""

import math
from collections.abc import Iterable, Sequence
from typing import Any, Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from giraff_core.senses import Camera
from giraff_setup.camera.picture import Points, UnusableError
from giraff_setup.condition import is_determined
from giraff_tools.chessboard import COLUMNS, ROWS, SQUARE

FEWEST: Final = 10
"""Views of the board."""
_OUTLIER: Final = 3.0
"""Times the median view's error: a view that is farther off was torn, blurred or not flat."""
_SMALLEST_OUTLIER: Final = 0.5  # px
_LARGEST_ERROR: Final = 1.0
"""px, at a width of 320. More is no plumb-bob lens, or no flat board."""
_LARGEST_SD: Final = 0.005
"""Share of the focal length. With a larger deviation the views are too alike."""
_LONGEST: Final = 4.0
"""Focal length in widths of the picture, and the other way round: views that all face the camera fit any."""


class Lens(NamedTuple):
    """A plumb-bob model, as ROS and OpenCV have it."""

    width: int
    """px."""
    height: int
    focal_x: float
    """px."""
    focal_y: float
    center_x: float
    center_y: float
    distortion: tuple[float, float, float, float, float]
    """k1, k2, p1, p2, k3."""

    @property
    def matrix(self) -> NDArray[np.float64]:
        """Return what makes pixels of places at one metre ahead."""
        return np.array([[self.focal_x, 0.0, self.center_x], [0.0, self.focal_y, self.center_y], [0.0, 0.0, 1.0]])

    def undistorted(self, points: Points) -> Points:
        """Return where a lens without distortion would show these points; px."""
        flat = np.ascontiguousarray(points, dtype=np.float64).reshape(-1, 1, 2)
        found = cv2.undistortPoints(flat, self.matrix, np.array(self.distortion), P=self.matrix)
        return np.asarray(found, dtype=np.float64).reshape(-1, 2)

    def distorted(self, points: Points) -> Points:
        """Return where this lens shows what one without distortion shows at these points; px."""
        rays = np.column_stack([points, np.ones(len(points))]) @ np.linalg.inv(self.matrix).T
        found = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), self.matrix, np.array(self.distortion))[0]
        return np.asarray(found, dtype=np.float64).reshape(-1, 2)


class LensFit(NamedTuple):
    """A lens, and how well it explains the views."""

    lens: Lens
    error: float
    """px. Root mean square distance between the corners seen and those of the fitted board."""
    focal_sd: float
    """px. Standard deviation of the focal length."""
    left_out: tuple[int, ...]
    """Numbers of the views that the fit does not explain."""


def lens_of(camera: Camera) -> Lens:
    """Return the lens that the robot file has."""
    x = (camera.width - 1) / 2.0 if camera.center_x is None else camera.center_x
    y = (camera.height - 1) / 2.0 if camera.center_y is None else camera.center_y
    return Lens(camera.width, camera.height, camera.focal_x, camera.focal_y, x, y, camera.distortion)


def fit_lens(views: Sequence[Points], width: int, height: int) -> LensFit:
    """Fit a lens to the board's corners in each view; views that do not fit are left out. Raises UnusableError."""
    kept = list(range(len(views)))
    while True:
        if len(kept) < FEWEST:
            raise UnusableError(
                f"there are {len(kept)} usable views of the board and {FEWEST} are needed; take more, the board at "
                "each edge of the picture and tilted each way"
            )
        lens, error, focal_sd, errors = _fitted([views[number] for number in kept], width, height)
        limit = max(_OUTLIER * float(np.median(errors)), _SMALLEST_OUTLIER * width / 320)
        worst = int(np.argmax(errors))
        if errors[worst] <= limit:
            break
        del kept[worst]
    if error > _LARGEST_ERROR * width / 320:
        raise UnusableError(
            f"the lens cannot be fitted: {error:.2f} px are left; lay the printed board on something flat, and hold "
            "it still"
        )
    is_possible = all(1.0 / _LONGEST < focal / width < _LONGEST for focal in (lens.focal_x, lens.focal_y))
    if not is_possible or focal_sd > _LARGEST_SD * lens.focal_x:
        raise UnusableError(
            f"the views are too alike: the focal length is not known to {100.0 * _LARGEST_SD:.1f} %; tilt the board "
            "more, and hold it closer"
        )
    return LensFit(lens, error, focal_sd, tuple(sorted(set(range(len(views))) - set(kept))))


def _fitted(views: Sequence[Points], width: int, height: int) -> tuple[Lens, float, float, NDArray[np.float64]]:
    """Return the lens, its error, the focal length's standard deviation and each view's error.

    The third radial term stays zero: views of a board do not tell it from the second.
    """
    corners = [np.asarray(view, dtype=np.float32).reshape(-1, 1, 2) for view in views]
    board = [board_corners().astype(np.float32)] * len(views)
    unknown, none = np.eye(3), np.zeros(5)
    error, matrix, distortion, rotations, shifts, _, _, errors = cv2.calibrateCameraExtended(
        board, corners, (width, height), unknown, none, flags=cv2.CALIB_FIX_K3
    )
    k1, k2, p1, p2, k3 = (float(value) for value in np.asarray(distortion).ravel()[:5])
    lens = Lens(
        width,
        height,
        float(matrix[0, 0]),
        float(matrix[1, 1]),
        float(matrix[0, 2]),
        float(matrix[1, 2]),
        (k1, k2, p1, p2, k3),
    )
    focal_sd = _focal_sd(lens, float(error), zip(rotations, shifts, strict=True))
    return lens, float(error), focal_sd, np.asarray(errors, dtype=np.float64).ravel()


def _focal_sd(lens: Lens, error: float, poses: Iterable[tuple[Any, Any]]) -> float:
    """Return the focal length's standard deviation, infinite where the views do not determine it.

    OpenCV's own is near zero there: it leaves out what is not determined.
    """
    normal = np.zeros((8, 8))
    for rotation, shift in poses:
        slopes = cv2.projectPoints(board_corners(), rotation, shift, lens.matrix, np.array(lens.distortion))[1]
        of_pose, of_lens = np.split(slopes[:, :14], [6], axis=1)
        basis = np.linalg.qr(of_pose)[0]
        told = of_lens - basis @ (basis.T @ of_lens)  # beside what the pose explains
        normal += told.T @ told
    # The error is the distance of a corner, which is off in two directions.
    return error * math.sqrt(np.linalg.inv(normal)[0, 0] / 2.0) if is_determined(normal) else math.inf


def board_corners() -> NDArray[np.float64]:
    """Return the board's inner corners, row by row; m on the paper, z 0."""
    corners = np.zeros((COLUMNS * ROWS, 3))
    corners[:, :2] = np.mgrid[0:COLUMNS, 0:ROWS].T.reshape(-1, 2) * (SQUARE / 1000.0)
    return corners

"""Height and tilt of a camera, from one sheet of A4 on the floor ahead of it."""

import math
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from giraff_setup.camera.lens import Lens
from giraff_setup.camera.picture import Grey, Points, UnusableError
from giraff_setup.condition import is_determined
from giraff_tools.chessboard import A4

_LEVELS: Final = 12
"""Brightnesses at which outlines are looked for."""
_SHORTEST: Final = 16.0
"""px of a side: a shorter one tells too little."""
_BORDER: Final = 3.0
"""px between the sheet and the picture's edge."""
_CONTRAST: Final = 15.0
"""Grey levels between the sheet and the floor beside it."""
_REACH: Final = 4
"""px, to each side of an outline, in which its edge is looked for."""
_NEAR: Final = (2.0, 1.5, 1.0, 1.0, 1.0)
"""px beside the line, within which pixels tell where it is; from one step to the next."""
_ROUNDS: Final = 2
_MARGIN: Final = 0.15
"""Share of a side that is left out at its ends, near the other sides."""
_LARGEST_ERROR: Final = 0.3
"""px between the sheet's corners and those of A4, at a width of 320, in one picture."""
_LARGEST_MEAN: Final = 0.2
"""px, of several pictures: what is not A4 is off in all of them."""
_LARGEST_SPREAD: Final = 0.01
"""Share of the height. Largest standard deviation between several pictures."""
FEWEST: Final = 3
"""Pictures of the sheet. One alone may tell the height one part in a hundred wrong."""
_LARGEST_ROLL: Final = math.radians(20.0)
_LARGEST_PITCH: Final = math.radians(80.0)
_LARGEST_SD: Final = 0.007
"""Share of the height. A sheet that is too far away, or seen too flatly, has a larger deviation."""
_CORNER_SD: Final = 0.06
"""px, at a width of 320, that each number of a corner is found wrong by: measured on drawn pictures."""


class FloorPose(NamedTuple):
    """Where a camera is above the floor, and how it is tilted."""

    z: float
    """m above the floor."""
    roll: float
    """rad; as the robot file has it."""
    pitch: float
    error: float
    """px. Root mean square distance between the sheet's corners and those of A4 in this place."""
    z_sd: float
    """m. Standard deviation, as the corners are found."""
    pitch_sd: float
    """rad."""


def find_sheet(grey: Grey, lens: Lens) -> FloorPose:
    """Return the camera's pose from the one sheet that is seen. Raises UnusableError."""
    trouble = (
        "no whole sheet is seen on the floor; lay one sheet of white A4 on darker floor about as far ahead as the "
        "camera is high, all of it in the picture, and check that the camera sees the floor"
    )
    found: list[FloorPose] = []
    for outline in _outlines(grey):
        try:
            found.append(_measured(grey, outline, lens))
        except UnusableError as error:
            trouble = str(error)
    if not found:
        raise UnusableError(trouble)
    return found[0]


def middle_of(poses: Sequence[FloorPose], width: int) -> FloorPose:
    """Return the mean of several pictures. Raises UnusableError where they are too few or do not agree."""
    if len(poses) < FEWEST:
        raise UnusableError(
            f"there are {len(poses)} usable pictures of the sheet on the floor and {FEWEST} are needed; lay it in "
            f"{FEWEST} places, turned"
        )
    pose = FloorPose(*(float(np.mean(values)) for values in zip(*poses, strict=True)))
    if pose.error > _LARGEST_MEAN * width / 320:
        raise _no_sheet(pose.error)
    spread = float(np.std([each.z for each in poses])) / pose.z
    if spread > _LARGEST_SPREAD:
        raise UnusableError(
            f"the pictures of the sheet do not agree: heights differ by {100.0 * spread:.1f} %; lay one of A4, flat, "
            "on a plain floor or cloth that is much darker, nearer, and turned another way each time"
        )
    return pose


def _no_sheet(error: float) -> UnusableError:
    return UnusableError(
        f"what is seen is no flat sheet of A4: its corners are {error:.2f} px off; lay one of 297 x 210 mm, flat, with "
        "no shadow or fold across it"
    )


def _outlines(grey: Grey) -> Iterator[Points]:
    """Give each bright quadrilateral once, those of the strongest contrast first."""
    smooth = cv2.GaussianBlur(grey, (3, 3), 0)
    found: list[tuple[float, Points]] = []
    darkest, brightest = np.percentile(smooth, (5.0, 99.7))
    for level in np.linspace(float(darkest), float(brightest), _LEVELS + 2)[1:-1]:
        mask = (smooth > level).astype(np.uint8)
        for contour in cv2.findContours(mask, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)[0]:
            if len(contour) < 4 * _SHORTEST / 2.0:
                continue
            quad = cv2.approxPolyDP(contour, 0.04 * cv2.arcLength(contour, closed=True), closed=True)
            if len(quad) == 4 and cv2.isContourConvex(quad):
                points = np.asarray(quad, dtype=np.float64).reshape(4, 2)
                if (contrast := _contrast(grey, points)) > _CONTRAST:
                    found.append((contrast, points))
    found.sort(key=lambda pair: -pair[0])
    given: list[Points] = []
    for _, points in found:
        if all(float(np.linalg.norm(points.mean(axis=0) - other.mean(axis=0))) > _SHORTEST / 2 for other in given):
            given.append(points)
            yield points


def _contrast(grey: Grey, quad: Points) -> float:
    """Return by how many grey levels a quadrilateral is brighter than a strip around it; -inf: it is at the edge."""
    height, width = grey.shape
    low, high = quad.min(axis=0), quad.max(axis=0)
    if low.min() < _BORDER or high[0] > width - 1 - _BORDER or high[1] > height - 1 - _BORDER:
        return -math.inf
    inside = np.zeros(grey.shape, dtype=np.uint8)
    cv2.fillConvexPoly(inside, np.round(quad).astype(np.int32), 1)
    kernel = np.ones((5, 5), dtype=np.uint8)
    core, around = cv2.erode(inside, kernel), cv2.dilate(inside, kernel, iterations=2) - cv2.dilate(inside, kernel)
    if not core.any() or not around.any():
        return -math.inf
    # The darkest tenth of the sheet against the brightest tenth of the floor: a chessboard is no sheet.
    return float(np.percentile(grey[core > 0], 10.0) - np.percentile(grey[around > 0], 90.0))


def _measured(grey: Grey, outline: Points, lens: Lens) -> FloorPose:
    """Return the pose from one outline. Raises UnusableError."""
    corners = _corners(grey, outline, lens)
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    if float(sides.min()) < _SHORTEST:
        raise UnusableError("the sheet is too small in the picture; lay it nearer")
    pose = min(_poses(corners, lens), key=lambda pose: pose.error)
    if pose.error > _LARGEST_ERROR * lens.width / 320:
        raise _no_sheet(pose.error)
    if abs(pose.roll) > _LARGEST_ROLL or not -_LARGEST_PITCH < pose.pitch < _LARGEST_PITCH:
        raise UnusableError(
            f"the sheet does not lie on the floor, or the camera is turned by {math.degrees(pose.roll):.0f}° to the "
            f"side and {math.degrees(pose.pitch):.0f}° down; lay a sheet of A4 on the floor ahead"
        )
    if pose.z_sd > _LARGEST_SD * pose.z:
        raise UnusableError(
            f"the sheet is too far away: it tells the height to {100.0 * pose.z_sd / pose.z:.1f} % only; lay it "
            "nearer, or give the camera larger pictures in the robot file"
        )
    return pose


def _corners(grey: Grey, outline: Points, lens: Lens) -> Points:
    """Return the sheet's corners as a lens without distortion shows them, where lines along its edges meet.

    They go round against the clock, as seen from above the floor. Raises UnusableError.
    """
    if float(cv2.contourArea(outline.astype(np.float32), oriented=True)) > 0:  # y is down
        outline = outline[::-1]
    corners = lens.undistorted(outline)
    for _ in range(_ROUNDS):
        lines = [_line(grey, corners[i], corners[(i + 1) % 4], lens) for i in range(4)]
        crossed = [np.cross(lines[i - 1], lines[i]) for i in range(4)]
        corners = np.array([point[:2] / point[2] for point in crossed], dtype=np.float64)
    return corners


def _line(grey: Grey, one: Points, other: Points, lens: Lens) -> NDArray[np.float64]:
    """Return a, b and c of ax + by + c = 0 along the edge near two corners.

    It is fitted to the places where brightness falls outward, of all pixels at once: stones and joints of the floor,
    which lie beside the line, count ever less. Raises UnusableError.
    """
    length = float(np.linalg.norm(other - one))
    along = (other - one) / length
    out = np.array([-along[1], along[0]])
    share = np.linspace(_MARGIN, 1.0 - _MARGIN, max(8, int(length)))
    offsets = np.arange(-_REACH, _REACH + 0.01, 0.5)
    at = (one + share[:, None] * (other - one))[:, None, :] + offsets[None, :, None] * out
    seen = lens.distorted(at.reshape(-1, 2)).reshape(*at.shape).astype(np.float32)
    light = cv2.remap(
        grey.astype(np.float32), seen[..., 0], seen[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    fall = -np.diff(light, axis=1)
    between = np.broadcast_to((offsets[1:] + offsets[:-1]) / 2.0, fall.shape)
    where = np.stack([np.ones_like(fall), np.broadcast_to(share[:, None], fall.shape)], axis=-1)
    line = np.zeros(2)  # px beyond `one`, and as much more beyond `other`
    for near in _NEAR:
        weight = fall * np.exp(-0.5 * ((between - where @ line) / near) ** 2)
        weighted = where * weight[..., None]
        normal = np.einsum("ijk,ijl->kl", weighted, where)
        if not is_determined(normal):
            raise UnusableError("an edge of the sheet is not seen; lay it on plain floor, with nothing on or beside it")
        line = np.linalg.solve(normal, np.einsum("ijk,ij->k", weighted, between))
    first, last = one + line[0] * out, other + (line[0] + line[1]) * out
    return np.asarray(np.cross(np.append(first, 1.0), np.append(last, 1.0)), dtype=np.float64)


def _poses(corners: Points, lens: Lens) -> Iterator[FloorPose]:
    """Give each pose that A4 may have: long side or short side first, and what a flat thing leaves open."""
    long, short = A4[0] / 1000.0, A4[1] / 1000.0
    for a, b in ((long, short), (short, long)):
        sheet = np.array([[-a, -b, 0.0], [a, -b, 0.0], [a, b, 0.0], [-a, b, 0.0]]) / 2.0
        _, rotations, shifts, _ = cv2.solvePnPGeneric(sheet, corners, lens.matrix, None, flags=cv2.SOLVEPNP_IPPE)
        for rotation, shift in zip(rotations, shifts, strict=True):
            best = cv2.solvePnPRefineLM(sheet, corners, lens.matrix, None, rotation, shift)
            yield _pose(sheet, corners, lens, np.array([float(each) for part in best for each in np.ravel(part)]))


def _pose(sheet: NDArray[np.float64], corners: Points, lens: Lens, six: NDArray[np.float64]) -> FloorPose:
    """Return the pose with its standard deviations; `six`: rotation and shift from sheet to camera."""
    seen, slopes = cv2.projectPoints(sheet, six[:3], six[3:], lens.matrix, None)[:2]
    error = math.sqrt(float(((np.reshape(seen, (-1, 2)) - corners) ** 2).sum(axis=1).mean()))
    # Four corners tell six numbers wherever the sheet is, even seen along its edge.
    covariance = (_CORNER_SD * lens.width / 320) ** 2 * np.linalg.inv(slopes[:, :6].T @ slopes[:, :6])
    step = 1e-6
    slope = np.array([(_above_floor(six + step * axis) - _above_floor(six)) / step for axis in np.eye(6)])
    z, roll, pitch = _above_floor(six)
    z_sd, _, pitch_sd = np.sqrt(np.einsum("ia,ij,ja->a", slope, covariance, slope))
    return FloorPose(float(z), float(roll), float(pitch), error, float(z_sd), float(pitch_sd))


def _above_floor(six: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return z, roll and pitch."""
    right, down, ahead = up = np.asarray(cv2.Rodrigues(six[:3])[0], dtype=np.float64)[
        :, 2
    ]  # of the floor, as the camera has it
    return np.array([-up @ six[3:], math.atan2(-right, -down), math.asin(max(-1.0, min(1.0, -ahead)))])

"""The chessboard in a picture, and what the views of it still lack."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import cv2
import numpy as np

from giraff_setup.camera.lens import Lens, board_corners
from giraff_setup.camera.picture import Grey, Points, UnusableError
from giraff_tools.chessboard import COLUMNS, ROWS

_PATTERN: Final = (COLUMNS, ROWS)
_SMALLEST_SQUARE: Final = 7.0
"""px between two corners: in less the corners are not found to a tenth of a pixel."""
_BLURRED: Final = 3.5
"""px from black to white; a sharp picture has two."""
_UNKNOWN: Final = 1000.0
"""px. OpenCV says more where the squares are too small to tell."""
_WHITE: Final = 250
_GLARE: Final = 0.02
"""Share of the picture that is white as paper never is."""
_EDGE: Final = 0.18
"""Share of the picture's width or height. Some corner must come so near to each edge."""
_TILT: Final = 0.3
"""rad that some views must be tilted, each way."""
_NEW: Final = 0.04
"""Share of the picture's width. The corners of a new view lie, on average, so far from those of every other view."""
_STILL: Final = 0.003
"""Share of the picture's width that a still board moves at most between two pictures."""


class View(NamedTuple):
    """The board in one picture."""

    corners: Points
    """Row by row."""
    across: float
    """rad that its right side is farther away than its left side; negative: nearer."""
    down: float
    """rad that its lower side is farther away than its upper side."""


def find_board(grey: Grey, lens: Lens) -> View:
    """Return the board in a picture. `lens`: about right, it only tells the tilt. Raises UnusableError."""
    found, corners = cv2.findChessboardCorners(
        grey,
        _PATTERN,
        flags=cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE,
    )
    if not found:
        if float(np.mean(grey >= _WHITE)) > _GLARE:
            raise UnusableError("the board is not seen, and part of the picture is white; turn it away from the light")
        raise UnusableError(
            f"no whole board of {COLUMNS} x {ROWS} inner corners is seen; show the one of `giraff camera board`, all "
            "of it with its white edge, close enough, flat and in even light"
        )
    corners = np.asarray(corners, dtype=np.float32).reshape(-1, 1, 2)
    grid = corners.reshape(ROWS, COLUMNS, 2)
    square = min(
        float(np.linalg.norm(np.diff(grid, axis=0), axis=2).min()),
        float(np.linalg.norm(np.diff(grid, axis=1), axis=2).min()),
    )
    blur = max(
        float(np.ravel(cv2.estimateChessboardSharpness(grey, _PATTERN, corners, vertical=vertical)[0])[0])
        for vertical in (False, True)
    )
    if square < _SMALLEST_SQUARE or blur > _UNKNOWN:
        raise UnusableError("the board is too small in the picture; hold it closer, or tilt it less")
    if blur > _BLURRED * max(1.0, grey.shape[1] / 640):
        raise UnusableError("the board is blurred; hold it still, in more light")
    reach = max(2, min(11, int(square / 3.0)))
    corners = cv2.cornerSubPix(
        grey, corners, (reach, reach), (-1, -1), (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 30, 0.01)
    )
    return _view(np.asarray(corners, dtype=np.float64).reshape(-1, 2), lens)


def _view(corners: Points, lens: Lens) -> View:
    """Return the view of these corners, which may be found from either end."""
    _, rotation, _ = cv2.solvePnP(board_corners(), corners, lens.matrix, np.array(lens.distortion))
    normal = cv2.Rodrigues(rotation)[0][:, 2]
    normal = normal * (1.0 if normal[2] > 0 else -1.0)  # away from the camera
    across, down = -np.arctan2(normal[0], normal[2]), -np.arctan2(normal[1], normal[2])
    return View(corners, float(across), float(down))


def is_still(before: View | None, now: View, width: int) -> bool:
    """Tell whether the board has not moved since the picture before."""
    return before is not None and _apart(before, now) < _STILL * width


def is_new(view: View, views: Sequence[View], width: int) -> bool:
    """Tell whether no view shows the board so already."""
    return all(_apart(view, other) > _NEW * width for other in views)


def _apart(one: View, other: View) -> float:
    """px between their corners on average; the board may be found from either end."""
    return min(
        float(np.linalg.norm(one.corners - corners, axis=1).mean()) for corners in (other.corners, other.corners[::-1])
    )


def missing(views: Sequence[View], width: int, height: int) -> str:
    """Return what to do with the board next; empty: the views are spread enough."""
    if not views:
        return "hold the board into the middle of the picture, as large as it fits"
    corners = np.concatenate([view.corners for view in views])
    nearest = (
        (float(corners[:, 0].min()) / width, "left edge"),
        (1.0 - float(corners[:, 0].max()) / width, "right edge"),
        (float(corners[:, 1].min()) / height, "upper edge"),
        (1.0 - float(corners[:, 1].max()) / height, "lower edge"),
    )
    for distance, edge in nearest:
        if distance > _EDGE:
            return f"show the board at the {edge} of the picture, all of it in the picture"
    tilts = (
        (max(view.across for view in views), "tilt the board: its right side farther away"),
        (max(-view.across for view in views), "tilt the board: its left side farther away"),
        (max(view.down for view in views), "tilt the board: its lower side farther away"),
        (max(-view.down for view in views), "tilt the board: its upper side farther away"),
    )
    return next((words for tilt, words in tilts if tilt < _TILT), "")

"""White paper in the picture: a sheet on the floor, a chessboard in somebody's hands. Its edges lie between pixels."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from giraff_sim.camera.eye import Eye, turn
from giraff_sim.camera.scene import Board, Sheet
from giraff_sim.camera.textures import Index, Single

Grid = NDArray[np.float64]

WHITE: Final = 215.0
_BLACK: Final = 28.0
_NEAREST: Final = 0.05  # m


def lay(grey: Single, material: Index, covered: Grid, color: Grid | float, tones: Single) -> None:
    """Cover a share of each pixel. `tones`: how bright each material is at a grey; the last one is paper."""
    at = np.flatnonzero(covered > 0.0)
    share = covered[at]
    shown = color[at] if isinstance(color, np.ndarray) else color
    bright = grey[at] * tones[material[at]] * (1.0 - share) + shown * share
    material[at[share > 0.5]] = len(tones) - 1
    grey[at] = bright / tones[material[at]]


def sheet_seen(sheet: Sheet, x: Single, y: Single) -> Grid:
    """Return the share of each pixel that a sheet covers; x, y: of the floor there."""
    along, across = turn(
        x.astype(np.float64) - sheet.x, y.astype(np.float64) - sheet.y, math.cos(sheet.yaw), -math.sin(sheet.yaw)
    )
    return _within(along, -sheet.length / 2, sheet.length / 2) * _within(across, -sheet.width / 2, sheet.width / 2)


def board_seen(board: Board, eye: Eye, shape: tuple[int, int]) -> tuple[Grid, Grid]:
    """Return the share of each pixel that a chessboard covers, and its grey there."""
    rays = np.stack([eye.cos, eye.sin, eye.view.slope], axis=-1).astype(np.float64).reshape(*shape, 3)
    normal = np.cross(board.along, board.down)
    away = np.array(board.corner) - (eye.x, eye.y, eye.view.z)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = (away @ normal) / (rays @ normal)
        depth[~(depth > _NEAREST)] = np.nan
        point = rays * depth[..., None] - away
        column, row = point @ board.along / board.square, point @ board.down / board.square
        covered = _within(column, -1.0, board.columns + 1.0) * _within(row, -1.0, board.rows + 1.0)
        inside = _within(column, 0.0, float(board.columns)) * _within(row, 0.0, float(board.rows))
        black = (1.0 + _wave(column, board.columns) * _wave(row, board.rows)) / 2.0 * inside
    return np.nan_to_num(covered), np.nan_to_num(WHITE + (_BLACK - WHITE) * black)


def _pixel(values: Grid) -> Grid:
    """Return how much a value changes within a pixel."""
    down, across = np.gradient(values)
    change: Grid = np.abs(down) + np.abs(across)
    return change


def _within(values: Grid, begin: float, end: float) -> Grid:
    """Return the share of each pixel that lies between two values."""
    pixel = np.maximum(_pixel(values), 1e-9)
    return np.clip(0.5 + (values - begin) / pixel, 0.0, 1.0) * np.clip(0.5 + (end - values) / pixel, 0.0, 1.0)


def _wave(values: Grid, squares: int) -> Grid:
    """Return 1 in even squares and -1 in odd ones, and what is between on the pixels where two squares meet."""
    square = np.clip(np.floor(values), 0.0, squares - 1.0)
    edge = np.abs(values - np.clip(np.rint(values), 1.0, squares - 1.0))
    sign = np.where(square % 2.0 == 0.0, 1.0, -1.0)
    wave: Grid = sign * np.minimum(1.0, 2.0 * edge / np.maximum(_pixel(values), 1e-9))
    return wave

"""Reads a floor plan from whatever kind of file it is in."""

from pathlib import Path
from typing import Final

from giraff_maps.floor_plan import FloorPlan, MapError, at_home, require_file, usable
from giraff_maps.grid_file import read_grid
from giraff_maps.outlines import walls_of
from giraff_maps.room_file import room_plan

_IMAGES: Final = (".pgm", ".png", ".bmp")
_MOSTLY: Final = 0.9  # share of occupied cells that no map of a home has


def read_map(path: Path) -> FloorPlan:
    """The floor plan in a file: a room (`.toml`), or a grid of ROS's map_server (`.yaml`). Raises MapError."""
    path = at_home(path)
    require_file(path)
    match path.suffix.lower():
        case ".toml":
            return usable(room_plan(path), path)
        case ".yaml" | ".yml":
            return usable(_grid_plan(path), path)
        case suffix if suffix in _IMAGES:
            raise MapError(f"{path}: an image alone has no scale: name the YAML file that belongs to it")
        case _:
            raise MapError(f"{path}: a map is a room (.toml), or a grid of ROS's map_server (.yaml)")


def _grid_plan(path: Path) -> FloorPlan:
    grid = read_grid(path)
    share = float(grid.occupied.mean())
    if share == 0.0:
        raise MapError(f"{path}: no cell is occupied: look at occupied_thresh, negate and mode")
    if share > _MOSTLY:
        raise MapError(f"{path}: {share:.0%} of its cells are occupied: is negate the wrong way round?")
    try:
        return FloorPlan(path.stem, tuple(walls_of(grid)))
    except MapError as error:
        raise MapError(f"{path}: {error}") from error

"""Writes occupancy grids of ROS's map_server: a YAML file and a PGM beside it. A room is drawn as one.

Walls and posts are occupied, what can be reached from the room's start is free, and all else is unknown: the outside,
and the inside of furniture.
"""

import json
import math
from collections import deque
from pathlib import Path
from typing import Final

from giraff_maps.floor_plan import LARGEST, Bounds, FloorPlan, MapError, usable
from giraff_maps.grid_file import MOST_CELLS
from giraff_maps.room_file import read_room_file, room_plan
from giraff_node.process.state import write_file_durably

OCCUPIED, UNKNOWN, FREE = 0, 205, 254
"""Shades of 255, as map_server's own maps have them."""
_MARGIN: Final = 2  # cells about all
_STEP: Final = 0.25  # cells between two points of a wall that are looked at


def write_grid(room: Path, out: Path, resolution: float) -> Path:
    """Write the room as `out` (`.yaml`) with cells of `resolution` m; the image beside it. Raises MapError, OSError."""
    if out.suffix.lower() not in (".yaml", ".yml"):
        raise MapError(f"{out}: a grid of map_server is a YAML file: name it .yaml")
    if not (math.isfinite(resolution) and 0.0 < resolution <= LARGEST):
        raise MapError(f"resolution {resolution:g} must be the side of a cell in metres, most often 0.05")
    plan = usable(room_plan(room), room)
    start = read_room_file(room).start
    raster = _Raster(plan.bounds, resolution)
    if raster.width * raster.height > MOST_CELLS:
        raise MapError(f"{room}: {raster.width} x {raster.height} cells are too many: use a coarser resolution")
    raster.draw(plan)
    raster.fill(start.x, start.y)
    image = out.with_suffix(".pgm")
    if there := next((path for path in (out, image) if path.exists()), None):
        raise MapError(f"{there} is there already, and is left alone: name another file")
    write_file_durably(image, raster.pgm())
    write_file_durably(out, yaml_bytes(image.name, resolution, raster.left, raster.bottom))
    return image


def yaml_bytes(image: str, resolution: float, left: float, bottom: float) -> bytes:
    """Return the YAML file of an image whose lower left corner is there in the map (m)."""
    return (
        f"image: {json.dumps(image, ensure_ascii=False)}\n"
        f"resolution: {resolution!r}\n"
        f"origin: [{left!r}, {bottom!r}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: trinary\n"
    ).encode()


def pgm_bytes(width: int, height: int, shades: bytes) -> bytes:
    """Return the image. `shades`: of its pixels, the topmost row first."""
    return f"P5\n{width} {height}\n255\n".encode() + shades


class _Raster:
    """Cells about a plan. Places that are whole cells from the map's origin are the middles of cells."""

    def __init__(self, bounds: Bounds, resolution: float) -> None:
        first_x, last_x = round(bounds.left / resolution) - _MARGIN, round(bounds.right / resolution) + _MARGIN
        first_y, last_y = round(bounds.bottom / resolution) - _MARGIN, round(bounds.top / resolution) + _MARGIN
        self.width, self.height = last_x - first_x + 1, last_y - first_y + 1
        self.left = round((first_x - 0.5) * resolution, 9)
        """m; of the leftmost cells' left side."""
        self.bottom = round((first_y - 0.5) * resolution, 9)
        self._resolution = resolution
        self._cells = bytearray()

    def draw(self, plan: FloorPlan) -> None:
        """Its walls on unknown ground."""
        self._cells = bytearray([UNKNOWN]) * (self.width * self.height)
        for x, y, end_x, end_y in plan.walls:
            steps = math.ceil(math.hypot(end_x - x, end_y - y) / (self._resolution * _STEP)) + 1
            for step in range(steps + 1):
                part = step / steps
                self._cells[self._cell(x + part * (end_x - x), y + part * (end_y - y))] = OCCUPIED

    def fill(self, x: float, y: float) -> None:
        """Whatever can be reached from there, cell by cell beside each other, is free."""
        column, row = self._place(x, y)
        if not (0 <= column < self.width and 0 <= row < self.height):
            return
        waiting = deque([row * self.width + column])
        while waiting:
            cell = waiting.popleft()
            if self._cells[cell] != UNKNOWN:
                continue
            self._cells[cell] = FREE
            column = cell % self.width
            waiting += [
                *([cell - 1] if column > 0 else ()),
                *([cell + 1] if column < self.width - 1 else ()),
                *([cell - self.width] if cell >= self.width else ()),
                *([cell + self.width] if cell + self.width < len(self._cells) else ()),
            ]

    def pgm(self) -> bytes:
        """With the topmost row first."""
        rows = (self._cells[row * self.width : (row + 1) * self.width] for row in reversed(range(self.height)))
        return pgm_bytes(self.width, self.height, b"".join(rows))

    def _place(self, x: float, y: float) -> tuple[int, int]:
        return (
            math.floor((x - self.left) / self._resolution),
            math.floor((y - self.bottom) / self._resolution),
        )

    def _cell(self, x: float, y: float) -> int:
        column, row = self._place(x, y)
        return row * self.width + column

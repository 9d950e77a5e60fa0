"""Grids and rooms that are written for a test, and distances between their walls."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from PIL import Image

from giraff_maps.floor_plan import Wall
from tests.rules.repository import ROOT

FLAT = ROOT / "deploy" / "worlds" / "flat.toml"
LIVING_ROOM = ROOT / "deploy" / "worlds" / "living_room.toml"
TWINS = ROOT / "tests" / "data" / "worlds" / "twins.toml"

YAML = (
    "image: map.pgm\nresolution: 0.05\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
)
START = "start = { x = 0.0, y = 0.0, yaw_deg = 0.0 }\n"


def painted(tmp_path: Path, rows: Sequence[str], yaml: str = YAML, image: str = "map.pgm") -> Path:
    """A grid from its picture: `#` occupied, `.` free, blank unknown; the first row is the topmost."""
    shade = {"#": 0, ".": 254, " ": 205}
    pixels = bytes(shade[sign] for row in rows for sign in row)
    if image.endswith(".pgm"):
        (tmp_path / image).write_bytes(f"P5\n{len(rows[0])} {len(rows)}\n255\n".encode() + pixels)
    else:
        Image.frombytes("L", (len(rows[0]), len(rows)), pixels).save(tmp_path / image)
    return written(tmp_path, yaml)


def written(tmp_path: Path, yaml: str) -> Path:
    """A YAML file."""
    path = tmp_path / "map.yaml"
    path.write_text(yaml)
    return path


def room(tmp_path: Path, walls: str, name: str = "small") -> Path:
    """A room file with these tables of walls and posts."""
    path = tmp_path / "room.toml"
    path.write_text(f'name = "{name}"\n{START}{walls}')
    return path


def polyline(*points: tuple[float, float]) -> str:
    """A table of one wall."""
    return f'[[walls]]\nname = "wall"\npoints = {[list(point) for point in points]}\n'


def off(walls: Sequence[Wall], others: Sequence[Wall], every: float) -> list[float]:
    """m from points of some walls, `every` m, to the nearest of others."""
    return [min(_distance(point, other) for other in others) for wall in walls for point in _points(wall, every)]


def _points(wall: Wall, every: float) -> Iterator[tuple[float, float]]:
    x, y, end_x, end_y = wall
    steps = max(1, math.ceil(math.hypot(end_x - x, end_y - y) / every))
    for step in range(steps + 1):
        yield x + step / steps * (end_x - x), y + step / steps * (end_y - y)


def _distance(point: tuple[float, float], wall: Wall) -> float:
    x, y, end_x, end_y = wall
    along_x, along_y = end_x - x, end_y - y
    share = ((point[0] - x) * along_x + (point[1] - y) * along_y) / (along_x**2 + along_y**2)
    share = min(1.0, max(0.0, share))
    return math.hypot(point[0] - x - share * along_x, point[1] - y - share * along_y)

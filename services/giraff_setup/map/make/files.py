"""The three files of a plan that was made: a grid (YAML and PGM), and a room of straight walls (TOML)."""

import contextlib
import json
import math
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from giraff_maps.floor_plan import FloorPlan, MapError
from giraff_maps.grid_write import FREE, OCCUPIED, UNKNOWN, pgm_bytes, yaml_bytes
from giraff_maps.read import read_map
from giraff_maps.room_file import SHORTEST_WALL
from giraff_node.process.state import write_file_durably
from giraff_schemas.text import printable
from giraff_tools.robot_file import before_today, keep
from giraff_tools.terminal.output import require_fresh

if TYPE_CHECKING:
    from giraff_maps.scan.occupancy import OccupancyGrid
    from giraff_maps.scan.plan import MadePlan

_TYPED: Final = (".toml", ".yaml", ".yml", ".pgm")
_LONGEST: Final = 200
"""Bytes of a name. A file system takes 255, with the ending and what a file has before it is whole."""
_MOST: Final = 1000
"""Names that are tried in one folder."""


class PlanFiles(NamedTuple):
    """Paths of the three."""

    yaml: Path
    pgm: Path
    toml: Path

    @classmethod
    def of(cls, stem: Path) -> "PlanFiles":
        """`stem`: their path without the ending."""
        return cls(*(stem.with_name(f"{stem.name}{ending}") for ending in (".yaml", ".pgm", ".toml")))


def stem_of(name: Path) -> Path:
    """Return the path of a new plan, without an ending. Raises MapError where no plan can be written there."""
    stem = _stem(name)
    if len(os.fsencode(stem.name)) > _LONGEST:
        raise MapError(f"the name {stem.name[:20]}... is too long: give one of {_LONGEST} characters at most")
    if not stem.name or stem.name == ".." or os.path.isdir(stem):  # noqa: PTH112  Path's own raises for some
        raise MapError(f"{stem} is a folder: give the plan a name in it, like {stem / 'home'}")
    for path in PlanFiles.of(stem):
        try:
            require_fresh(path)
        except ValueError as error:
            raise MapError(str(error)) from error
    return stem


def plan_of(name: Path) -> tuple[Path, FloorPlan]:
    """Return the path of a plan that is there, without an ending, and the plan. Raises MapError."""
    stem = _stem(name)
    files = PlanFiles.of(stem)
    return stem, read_map(files.toml if files.toml.exists() or not files.yaml.exists() else files.yaml)


def rewrite_plan(stem: Path, plan: "MadePlan") -> PlanFiles:
    """Write all three in place of those that are there. These stay beside them, by their date.

    Raises OSError; what was there is then as it was.
    """
    files = PlanFiles.of(stem)
    new = PlanFiles(*(path.with_name(f".{path.name}.new") for path in files))
    try:
        _write(new, stem.name, plan, files.pgm.name)
        for path in files:
            if path.exists():
                keep(path, path.read_bytes(), before_today())
        for path, written in zip(files, new, strict=True):
            written.replace(path)
    finally:
        for path in new:
            _remove(path)
    return files


def write_plan(stem: Path, plan: "MadePlan") -> tuple[PlanFiles, str]:
    """Write all three. Return them, and why they have another name or folder than `stem` where that takes none.

    Raises OSError where no folder takes them.
    """
    homes = (stem.parent, Path(os.path.expanduser("~")), Path(tempfile.gettempdir()))  # noqa: PTH111  never raises
    why: OSError | None = None
    for folder in homes:
        try:
            files = _write_in(folder, stem.name, plan)
        except OSError as error:
            why = why or error
            continue
        if why is not None:
            return files, f"{why.filename or stem}: cannot be written: {why.strerror or why}"
        return files, "" if files == PlanFiles.of(stem) else f"{stem} was taken meanwhile"
    raise why or OSError


def _write_in(folder: Path, name: str, plan: "MadePlan") -> PlanFiles:
    """Write under this name, or the next one that is free. Raises OSError; nothing new is then there."""
    for stem in (folder / each for each in _names(name)):
        with contextlib.suppress(FileExistsError), contextlib.ExitStack() as undo:
            files = PlanFiles.of(stem)
            for path in files:
                path.open("xb").close()  # the name is now this plan's
                undo.callback(_remove, path)
            _write(files, stem.name, plan, files.pgm.name)
            undo.pop_all()
            return files
    raise FileExistsError(None, f"{_MOST} plans of this name are there", str(folder / name))


def _write(files: PlanFiles, name: str, plan: "MadePlan", image: str) -> None:
    write_file_durably(files.pgm, _pgm(plan.grid))
    write_file_durably(files.yaml, yaml_bytes(image, float(plan.grid.cell), *_corner(plan.grid)))
    write_file_durably(files.toml, room_bytes(name, plan))


def _stem(name: Path) -> Path:
    return name.with_suffix("") if name.suffix.lower() in _TYPED else name


def _names(name: str) -> Iterator[str]:
    yield name
    yield from (f"{name}-{number}" for number in range(2, _MOST))


def _remove(path: Path) -> None:
    with contextlib.suppress(OSError):
        path.unlink()


def _corner(grid: "OccupancyGrid") -> tuple[float, float]:
    left, bottom = (round(float(value), 6) for value in grid.low)
    return left, bottom


def _pgm(grid: "OccupancyGrid") -> bytes:
    import numpy as np  # noqa: PLC0415

    shades = np.array([FREE, OCCUPIED, UNKNOWN], dtype=np.uint8)[grid.state]  # -1 is the last one
    width, height = shades.shape
    return pgm_bytes(width, height, shades.T[::-1].tobytes())


def room_bytes(name: str, plan: "MadePlan") -> bytes:
    """Return the room file: points to the millimetre, and no wall that is a point then."""
    x, y, yaw = plan.start
    start = f"{{ x = {x:z.3f}, y = {y:z.3f}, yaw_deg = {math.degrees(yaw):z.1f} }}"
    way = ", ".join(f"[{x:z.2f}, {y:z.2f}]" for x, y in plan.way)
    lines = [f"name = {json.dumps(printable(name), ensure_ascii=False)}", f"start = {start}", f"waypoints = [{way}]"]
    for number, wall in enumerate(plan.walls, 1):
        x, y, end_x, end_y = (round(float(value), 3) for value in wall)
        if math.hypot(end_x - x, end_y - y) >= 2.0 * SHORTEST_WALL:
            points = f"[[{x:z.3f}, {y:z.3f}], [{end_x:z.3f}, {end_y:z.3f}]]"
            lines += ["", "[[walls]]", f'name = "wall {number}"', f"points = {points}"]
    return "\n".join([*lines, ""]).encode()

"""A room becomes a grid, and the grid the room's walls again."""

import statistics
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from giraff_maps.floor_plan import MapError
from giraff_maps.grid_file import read_grid
from giraff_maps.grid_write import write_grid
from giraff_maps.outlines import walls_of
from giraff_maps.read import read_map
from tests.unit.maps.grids import FLAT, LIVING_ROOM, TWINS, off, polyline, room

CELL = 0.05


@pytest.mark.parametrize("world", [FLAT, LIVING_ROOM, TWINS], ids=lambda path: path.stem)
def test_walls_come_back_where_they_were(tmp_path: Path, world: Path) -> None:
    """A grid has them as thick as a cell: its surfaces are half a cell off, at corners a little more."""
    out = tmp_path / "grid.yaml"
    write_grid(world, out, CELL)
    before, after = read_map(world), read_map(out)
    assert max(off(before.walls, after.walls, 0.2)) < 1.01 * CELL
    distances = off(after.walls, before.walls, 0.2)
    assert max(distances) < 1.4 * CELL
    assert statistics.mean(distances) < 0.7 * CELL


coordinates = st.integers(-60, 60).map(lambda number: number * 0.1)


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(coordinates, coordinates, coordinates, coordinates, st.sampled_from([0.03, 0.05, 0.1]))
def test_any_wall_comes_back(
    tmp_path_factory: pytest.TempPathFactory, x: float, y: float, end_x: float, end_y: float, cell: float
) -> None:
    if max(abs(end_x - x), abs(end_y - y)) < 1.0:
        return
    folder = tmp_path_factory.mktemp("wall")
    source = room(folder, polyline((x, y), (end_x, end_y)))
    write_grid(source, folder / "grid.yaml", cell)
    found = walls_of(read_grid(folder / "grid.yaml"))
    assert max(off([(x, y, end_x, end_y)], found, 0.2)) < 1.5 * cell
    assert max(off(found, [(x, y, end_x, end_y)], 0.2)) < 2.0 * cell


def test_inside_is_free_and_outside_is_unknown(tmp_path: Path) -> None:
    write_grid(LIVING_ROOM, tmp_path / "grid.yaml", CELL)
    image = Image.open(tmp_path / "grid.pgm")
    assert image.getpixel((0, 0)) == 205
    occupied, unknown, free = (image.histogram()[shade] for shade in (0, 205, 254))
    assert occupied + unknown + free == image.width * image.height
    assert free * CELL**2 == pytest.approx(27.0, abs=2.0)


def test_what_is_there_is_left_alone(tmp_path: Path) -> None:
    for name in ("grid.yaml", "grid.pgm"):
        (tmp_path / name).write_text("mine")
        with pytest.raises(MapError, match=rf"{name} is there already"):
            write_grid(LIVING_ROOM, tmp_path / "grid.yaml", CELL)
        assert [path.read_text() for path in tmp_path.iterdir()] == ["mine"]
        (tmp_path / name).unlink()


@pytest.mark.parametrize(
    ("out", "resolution", "complaint"),
    [("grid.pgm", 0.05, "name it .yaml"), ("grid.yaml", 0.0001, "too many"), ("grid.yaml", 0.0, "side of a cell")],
)
def test_what_cannot_be_written_is_told(tmp_path: Path, out: str, resolution: float, complaint: str) -> None:
    with pytest.raises(MapError, match=complaint):
        write_grid(LIVING_ROOM, tmp_path / out, resolution)
    assert list(tmp_path.iterdir()) == []

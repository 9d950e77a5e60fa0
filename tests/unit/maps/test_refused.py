"""Maps that cannot be used: one plain line that names the file, the cause and the way out."""

import os
import sys
from pathlib import Path

import pytest
from PIL import Image

import giraff_maps.floor_plan
import giraff_maps.outlines
from giraff_maps.floor_plan import MapError
from giraff_maps.read import read_map
from giraff_maps.room_file import read_room_file
from tests.unit.maps.grids import YAML, painted, polyline, room, written

FREE = ("....",) * 12
WALL = ("####", *FREE)


def refused(path: Path) -> str:
    """The line."""
    with pytest.raises(MapError) as error:
        read_map(path)
    [line] = str(error.value).splitlines()
    assert str(path.parent) in line
    return line


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("none.toml", "none.toml: cannot be read: No such file"),
        ("none.yaml", "none.yaml: cannot be read: No such file"),
        ("map.pgm", "an image alone has no scale: name the YAML file"),
        ("map.dxf", "a map is a room (.toml), or a grid of ROS's map_server (.yaml)"),
    ],
)
def test_a_name_that_is_no_maps(tmp_path: Path, name: str, complaint: str) -> None:
    assert complaint in refused(tmp_path / name)


@pytest.mark.parametrize(
    ("walls", "complaint"),
    [
        ("", "it has no walls and no posts"),
        ("walls = [", "not TOML"),
        (f"x = {'[' * 5000}", "not TOML"),
        (f"x = {'9' * 5000}", "not TOML"),
        (polyline((0, 0)), "'wall' has 1 points"),
        ('[[walls]]\nname = "w"\npoints = [[0, 0], [nan, 1]]\n', "not finite"),
        ('[[posts]]\nname = "p"\nx = 0\ny = 0\nradius = -1\n', "radius must be positive"),
        ('[[wals]]\nname = "w"\n', "unknown field `wals`"),
        (polyline((0, 0), (6000, 0), (6000, 5000)), "6000 x 5000 m is too large: are these millimetres?"),
        (polyline((0, 0), (600, 0), (600, 500)), "600 x 500 m is too large: are these centimetres?"),
        (polyline((0, 0), (0.006, 0), (0.006, 0.005)), "is too small: it takes metres"),
    ],
)
def test_a_room(tmp_path: Path, walls: str, complaint: str) -> None:
    assert complaint in refused(room(tmp_path, walls))


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("image: map.pgm", "image: [", "not YAML"),
        ("image: map.pgm", "image: !!python/object:os.system x", "not YAML"),
        ("image: map.pgm\n", "", "`image` is missing"),
        ("image: map.pgm", "image: other.pgm", "other.pgm is not there: both files belong together"),
        ("image: map.pgm", "image: map.yaml", "no image of the kinds PGM, PNG and BMP"),
        ("image: map.pgm", "image: .", "it is no file, but a folder, a pipe or a device: give the file itself"),
        ("image: map.pgm", "image: ~nobody-here/map.pgm", "map.pgm is not there"),
        ("resolution: 0.05", "resolution: 0", "resolution 0 must be the side of a cell in metres"),
        ("resolution: 0.05", "resolution: -0.05", "resolution -0.05 must be"),
        ("resolution: 0.05", "resolution: .nan", "resolution nan must be"),
        ("resolution: 0.05", "resolution: 50", "is too large: resolution is the side of a cell in metres"),
        ("resolution: 0.05", "resolution: 0.0005", "is too small: resolution is the side of a cell in metres"),
        (
            "resolution: 0.05",
            "resolution: 0,05",
            "resolution must be a number, and is text ('0,05'); write it like 0.05",
        ),
        ("[-1.0, 2.0, 0.0]", "[-1.0, 2.0]", "no grid of map_server"),
        ("[-1.0, 2.0, 0.0]", "[-1.0, .inf, 0.0]", "origin must be three finite numbers"),
        (
            "[-1.0, 2.0, 0.0]",
            "[-4, -3, 90]",
            "the yaw in origin is 90: it must be within -2π..2π rad; are these degrees? 90 degrees are 1.5708 rad",
        ),
        ("negate: 0", "negate: 2", "negate 2 must be 0 or 1"),
        ("negate: 0", "negat: 1", "unknown field `negat`; did you mean 'negate'?"),
        ("occupied_thresh: 0.65", "occupied_thresh: 65", "occupied_thresh 65 must be in this order and from 0 to 1"),
        ("occupied_thresh: 0.65", "occupied_thresh: 0.1", "free_thresh 0.196 and occupied_thresh 0.1 must be in this"),
        ("negate: 0", "mode: ternary", "mode cannot be 'ternary'; known are: trinary, scale, raw"),
        ("negate: 0", "negate: 1", "of its cells are occupied: is negate the wrong way round?"),
    ],
)
def test_a_grid(tmp_path: Path, old: str, new: str, complaint: str) -> None:
    assert complaint in refused(painted(tmp_path, WALL, YAML.replace(old, new)))


@pytest.mark.parametrize("name", ["map.yaml", "map.pgm", "room.toml"])
def test_nothing_waits_for_a_pipe(tmp_path: Path, name: str) -> None:
    grid, drawn = written(tmp_path, YAML), room(tmp_path, "")
    (tmp_path / name).unlink(missing_ok=True)
    os.mkfifo(tmp_path / name)
    with pytest.raises(MapError, match=f"{name}: it is no file, but a folder, a pipe or a device"):
        _ = read_room_file(drawn) if name == "room.toml" else read_map(grid)


def test_a_grid_of_nothing(tmp_path: Path) -> None:
    assert "no cell is occupied" in refused(painted(tmp_path, FREE))
    assert "no grid of map_server: it must be a table of fields, and is none" in refused(written(tmp_path, ""))


@pytest.mark.parametrize("keep", [3, 9, 12, 40])
@pytest.mark.parametrize("image", ["map.pgm", "map.png"])
def test_a_torn_image(tmp_path: Path, image: str, keep: int) -> None:
    path = painted(tmp_path, WALL, YAML.replace("map.pgm", image), image)
    whole = (tmp_path / image).read_bytes()
    (tmp_path / image).write_bytes(whole[:keep])
    assert "torn" in (line := refused(path)) or "no image of the kinds" in line


def test_an_image_that_is_far_too_large_is_not_even_read(tmp_path: Path) -> None:
    path = written(tmp_path, YAML)
    for side, complaint in ((6000, "6000 x 6000 pixels"), (60_000, "far too many pixels")):
        (tmp_path / "map.pgm").write_bytes(f"P5\n{side} {side}\n255\n".encode())
        assert complaint in refused(path)


def test_specks_without_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (giraff_maps.floor_plan, giraff_maps.outlines):
        monkeypatch.setattr(module, "MOST_WALLS", 200)
    Image.effect_noise((100, 100), 200.0).save(tmp_path / "map.pgm")
    assert "more than 200 walls: clean it of specks" in refused(written(tmp_path, YAML))


@pytest.mark.parametrize("library", ["yaml", "PIL", "numpy", "contourpy"])
def test_a_library_that_is_missing(tmp_path: Path, library: str, monkeypatch: pytest.MonkeyPatch) -> None:
    path = painted(tmp_path, WALL)
    monkeypatch.setitem(sys.modules, library, None)
    line = refused(path)
    named = {"PIL": "pillow"}.get(library, library)
    assert f"the library {named} is missing; in the clone: make setup" in line

"""Occupancy grids: which pixels are walls, and where in the map they are."""

import math
from pathlib import Path

import pytest
from PIL import Image

from giraff_maps.read import read_map
from tests.unit.maps.grids import YAML, painted, polyline, room, written

BOX = tuple(f"{'.' * 4}{sign * 16}{'.' * 4}" for sign in "." * 4 + "#" * 20 + "." * 8)
"""24 cells across and 32 up; occupied are 4 to 20 of them and 8 to 28."""


def test_a_blob_is_a_box_at_the_cells_edges(tmp_path: Path) -> None:
    plan = read_map(painted(tmp_path, BOX))
    assert plan.name == "map"
    left, bottom, right, top = plan.bounds
    assert (left, right) == pytest.approx((-1.0 + 0.2, -1.0 + 1.0), abs=0.002)
    assert (bottom, top) == pytest.approx((2.0 + 0.4, 2.0 + 1.4), abs=0.002)


def test_the_origins_yaw_turns_the_image_about_its_lower_left_corner(tmp_path: Path) -> None:
    plan = read_map(painted(tmp_path, BOX, YAML.replace("2.0, 0.0]", "2.0, 1.5707963]")))
    left, bottom, right, top = plan.bounds
    assert (left, right) == pytest.approx((-1.0 - 1.4, -1.0 - 0.4), abs=0.002)
    assert (bottom, top) == pytest.approx((2.0 + 0.2, 2.0 + 1.0), abs=0.002)


@pytest.mark.parametrize("image", ["map.pgm", "map.png", "map.bmp"])
def test_kinds_of_images_are_one(tmp_path: Path, image: str) -> None:
    plan = read_map(painted(tmp_path, BOX, YAML.replace("map.pgm", image), image))
    assert plan.walls == read_map(painted(tmp_path, BOX)).walls


def test_what_others_write_is_meant_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = read_map(painted(tmp_path, BOX))
    monkeypatch.setenv("HOME", str(tmp_path))
    yaml = f"\ufeff{YAML}mode: Trinary\n".replace("map.pgm", "~/map.pgm")
    (tmp_path / "maps").mkdir()
    assert read_map(written(tmp_path / "maps", yaml)) == plan
    assert read_map(Path("~") / "maps" / "map.yaml") == plan
    (drawn := room(tmp_path, polyline((0, 0), (1, 0)))).write_text(f"\ufeff{drawn.read_text()}")
    assert len(read_map(drawn).walls) == 1


def test_a_plain_pgm_with_comments_is_read(tmp_path: Path) -> None:
    rows = "\n".join(" ".join("0" if sign == "#" else "254" for sign in row) for row in BOX)
    (tmp_path / "map.pgm").write_text(f"P2\n# drawn by hand\n24 32\n255\n{rows}\n")
    assert read_map(written(tmp_path, YAML)).walls == read_map(painted(tmp_path, BOX)).walls


def test_sixteen_bits_are_as_good_as_eight(tmp_path: Path) -> None:
    pixels = b"".join(b"\x00\x00" if sign == "#" else b"\xfe\xfe" for row in BOX for sign in row)
    (tmp_path / "map.pgm").write_bytes(b"P5\n24 32\n65535\n" + pixels)
    assert read_map(written(tmp_path, YAML)).walls == read_map(painted(tmp_path, BOX)).walls


@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
def test_what_is_transparent_is_no_wall(tmp_path: Path, mode: str) -> None:
    black = 100 if mode == "raw" else 0
    image = Image.new("RGBA", (20, 20), (255, 255, 255, 255))
    image.paste((black, black, black, 255), (2, 2, 14, 6))
    image.paste((black, black, black, 0), (2, 10, 14, 18))
    image.save(tmp_path / "map.png")
    plan = read_map(written(tmp_path, YAML.replace("map.pgm", "map.png") + f"mode: {mode}\n"))
    assert plan.bounds.bottom == pytest.approx(2.0 + 14 * 0.05, abs=0.002)


def test_negate_takes_the_light_for_walls(tmp_path: Path) -> None:
    turned = tuple(row.translate(str.maketrans("#.", ".#")) for row in BOX)
    plan = read_map(painted(tmp_path, turned, YAML.replace("negate: 0", "negate: true")))
    assert plan.walls == read_map(painted(tmp_path, BOX)).walls


def test_raw_is_percent_and_more_than_a_hundred_is_unknown(tmp_path: Path) -> None:
    image = Image.new("L", (20, 20), 0)
    image.paste(80, (2, 2, 14, 6))
    image.paste(60, (2, 8, 14, 12))
    image.paste(255, (2, 14, 14, 18))
    image.save(tmp_path / "map.pgm")
    left, bottom, right, top = read_map(written(tmp_path, YAML + "mode: raw\n")).bounds
    assert (right - left, top - bottom) == pytest.approx((0.6, 0.2), abs=0.003)


def test_numbers_may_have_the_form_that_yaml_takes_for_text(tmp_path: Path) -> None:
    plan = read_map(painted(tmp_path, BOX, YAML.replace("0.05", "5e-2")))
    assert plan.walls == read_map(painted(tmp_path, BOX)).walls


def _band(degrees: float, half: float, size: int = 120) -> list[str]:
    """A slanted wall of 2 * `half` cells, through the middle of a picture."""
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    middle = (size - 1) / 2.0

    def sign(column: int, row: int) -> str:
        x, y = column - middle, middle - row
        return "#" if abs(x * cos + y * sin) < 45.0 and abs(y * cos - x * sin) <= half else "."

    return ["".join(sign(column, row) for column in range(size)) for row in range(size)]


@pytest.mark.parametrize("half", [0.5, 0.75, 1.5, 4.0])
@pytest.mark.parametrize("degrees", [0.0, 3.0, 10.0, 26.0, 45.0, 70.0, 90.0])
def test_a_slanted_wall_faces_where_it_does(tmp_path: Path, half: float, degrees: float) -> None:
    """However thin: the sensor model asks for the angle at which an echo meets it."""
    plan = read_map(painted(tmp_path, _band(degrees, half)))
    right = wrong = 0.0
    for x, y, end_x, end_y in plan.walls:
        slant = math.degrees(math.atan2(end_y - y, end_x - x)) - degrees
        length = math.hypot(end_x - x, end_y - y)
        if abs((slant + 90.0) % 180.0 - 90.0) < 5.0:
            right += length
        elif length > 2.0 * (half + 1.0) * 0.05:  # longer than its ends
            wrong += length
    assert right > 0.9 * 90 * 0.05
    assert wrong < 0.15 * right


@pytest.mark.parametrize(
    "rows", [("......", "..#...", "......"), ("#.....", ".#....", "..#..."), ("......", ".####.", "......")]
)
def test_what_is_as_thin_as_a_cell_does_not_vanish(tmp_path: Path, rows: tuple[str, ...]) -> None:
    plan = read_map(painted(tmp_path, rows, YAML.replace("0.05", "0.5")))
    cells = sum(row.count("#") for row in rows)
    assert sum(math.hypot(wall[2] - wall[0], wall[3] - wall[1]) for wall in plan.walls) > 0.5 * cells * 0.5
    assert len({*plan.walls}) == len(plan.walls)


def test_a_single_cell_can_be_met_from_every_side(tmp_path: Path) -> None:
    left, bottom, right, top = read_map(painted(tmp_path, ("...", ".#.", "..."), YAML.replace("0.05", "0.5"))).bounds
    assert (right - left, top - bottom) == pytest.approx((0.5, 0.5), abs=0.02)

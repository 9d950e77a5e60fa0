"""`giraff map`: a plan in the terminal and as SVG, and a room as a grid."""

import io
import math
import os
import shutil
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import msgspec
import pytest
from rich.console import Console
from rich.file_proxy import FileProxy

import giraff_setup.map.show
from giraff_core.kinematics.pose import Pose
from giraff_maps.floor_plan import FloorPlan
from giraff_maps.read import read_map
from giraff_schemas.localization import Candidate, MapPose
from giraff_tools.terminal.dots import takes_dots
from giraff_tools.terminal.floor import FloorDrawing
from tests.unit.cli.map_poses import map_pose
from tests.unit.cli.typed import Giraff, giraff
from tests.unit.maps.grids import FLAT, LIVING_ROOM, polyline, room

__all__ = ["giraff"]

PLACE = Candidate(x=1.5, y=0.5, yaw=0.0, belief=0.3)
SQUARE = FloorPlan("square", ((0, 0, 2, 0), (2, 0, 2, 2), (2, 2, 0, 2), (0, 2, 0, 0)))


def drawn(plan: FloorPlan, columns: int, lines: int, *, dots: bool, pose: MapPose | None = None) -> list[str]:
    return FloorDrawing(plan, columns, lines, dots=dots).draw(pose).plain.splitlines()


def test_a_square_has_four_sides_and_axes_in_metres() -> None:
    assert drawn(SQUARE, 24, 13, dots=False) == [
        "  2+####################",
        *["   |#                  #"] * 4,
        "  1+#                  #",
        *["   |#                  #"] * 3,
        "  0++###################",
        "   |+---------+--------+",
        "  m 0         1        2",
        "    + origin",
    ]
    assert drawn(SQUARE, 9, 13, dots=True)[-4:] == ["  0┤┼⠒⠒⠒⠚", "   └┴────", "  m 0", "    ┼ origin"]


@pytest.mark.parametrize("columns", [10, 41, 80, 120])
@pytest.mark.parametrize("world", [FLAT, LIVING_ROOM], ids=lambda path: path.stem)
def test_a_drawing_fits(world: Path, columns: int) -> None:
    lines = drawn(read_map(world), columns, 24, dots=True)
    assert max(map(len, lines[:-1])) <= columns
    assert len(lines) <= 24


def test_a_single_wall_is_a_line_with_its_own_axes() -> None:
    *_, figures, origin = drawn(FloorPlan("wall", ((-9, 4, -3, 4),)), 30, 10, dots=False)
    assert (figures, origin.strip()) == ("  m    -8       -6      -4", "its origin is outside")
    assert len(drawn(FloorPlan("wall", ((1, 0, 1, 3),)), 12, 10, dots=False)) == 10


def test_the_robot_is_drawn_with_its_ellipse_and_what_is_off_the_plan_is_not() -> None:
    there = Pose(1.0, 1.0, math.pi / 2.0)
    pose = msgspec.structs.replace(map_pose(1, there), covariance=(0.06, 0.0, 0.0, 0.015, 0.0, 0.1))
    lines = drawn(SQUARE, 45, 23, dots=False, pose=pose)
    assert lines[10] == "  1+#       #           ^          #       #"
    assert [line.count("#") for line in lines[6:14]] == [2, 20, 10, 4, 4, 10, 20, 2]
    for far in (Pose(1e6, 1.0, 0.0), Pose(-1.0, 1.0, 0.0)):
        assert drawn(SQUARE, 45, 23, dots=False, pose=map_pose(1, far)) == drawn(SQUARE, 45, 23, dots=False)
    other = msgspec.structs.replace(map_pose(1, there, "ambiguous"), candidates=(PLACE, PLACE))
    assert "".join(drawn(SQUARE, 45, 23, dots=False, pose=other)).count("?") == 1


def test_it_is_shown(giraff: Giraff, tmp_path: Path) -> None:
    svg = tmp_path / "flat.svg"
    code, out, complaint = giraff("map", "show", str(FLAT), "--svg", str(svg))
    heading, *lines = out.splitlines()
    assert (code, complaint) == (0, "")
    assert heading == "flat: 12.70 x 8.20 m, 104.1 m², 206 walls"
    assert lines[-2].split() == ["m", "0", "2", "4", "6", "8", "10", "12"]
    assert "\x1b" not in out
    drawing = ET.fromstring(svg.read_text())  # noqa: S314
    texts = [each.text for each in drawing.iter("{http://www.w3.org/2000/svg}text")]
    assert texts[0] == heading
    assert {"m", "0", "12", "8"} <= {*texts}


def test_places_and_no_go_lines_are_drawn_with_the_plan(giraff: Giraff, tmp_path: Path) -> None:
    plan = room(tmp_path, polyline((0, 0), (2, 0), (2, 2), (0, 2), (0, 0)))
    svg, beside = tmp_path / "out.svg", tmp_path / "room.places.toml"
    bare = giraff("map", "show", str(plan), "--svg", str(svg))[1], svg.read_text()
    beside.write_text(
        "[places]\nkitchen = {x = 0.5, y = 1.5, yaw_deg = 90}\n'Küche' = {x = 1.5, y = 1.5, yaw_deg = 0}\n"
        "attic = {x = 9, y = 9, yaw_deg = 0}\n[no_go]\nstairs = {points = [[-9000.0, 1.0], [1.0, 1.0]]}\n"
        "rug = {points = [[0.5, 0.5], [1.5, 0.5]]}\n"
    )
    code, out, complaint = giraff("map", "show", str(plan), "--svg", str(svg))
    assert (code, complaint) == (0, "")
    lines = out.splitlines()
    assert lines[-1] == "k kitchen; c Küche; a attic; ▒ no-go: stairs, rug"
    assert [line.count("k") + line.count("c") for line in lines[1:-1]].count(2) == 1
    assert sum(line.count("▒") for line in lines[1:-1]) > 20
    image = svg.read_text()
    assert [image.count(name) for name in ("kitchen", "Küche", "stroke-dasharray", "rotate(-90.0)")] == [1, 1, 2, 1]
    ET.fromstring(image)  # noqa: S314
    told = msgspec.json.decode(giraff("map", "show", str(plan), "--json")[1])
    assert told["places"][0] == {"name": "kitchen", "x": 0.5, "y": 1.5, "yaw": pytest.approx(math.pi / 2.0)}
    assert told["no_go"][1] == {"name": "rug", "x": 0.5, "y": 0.5, "end_x": 1.5, "end_y": 0.5}
    beside.write_text("[places.kitchen]\nx = 1")
    code, out, complaint = giraff("map", "show", str(plan))
    assert (code, out) == (2, "")
    assert str(beside) in complaint
    beside.write_text("")
    assert (giraff("map", "show", str(plan), "--svg", str(svg))[1], svg.read_text()) == bare, "as without the file"


def test_a_name_steers_neither_terminal_nor_drawing(giraff: Giraff, tmp_path: Path) -> None:
    path = room(tmp_path, polyline((0, 0), (2, 0)), name="<b>\\u001b[2J")
    code, out, _ = giraff("map", "show", str(path), "--svg", str(tmp_path / "out.svg"))
    assert code == 0
    assert out.startswith("<b>?[2J: 2.00 x 0.00 m, 0.0 m², 1 wall\n")
    assert ET.fromstring((tmp_path / "out.svg").read_text()) is not None  # noqa: S314


def test_a_terminal_without_other_characters_gets_ascii(monkeypatch: pytest.MonkeyPatch) -> None:
    stdout = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr(sys, "stdout", stdout)
    assert giraff_setup.map.show.show(FLAT, None) == 0
    stdout.seek(0)
    assert "#" in stdout.read()


def test_a_live_view_does_not_hide_what_a_terminal_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    for encoding, takes in (("utf-8", True), ("ascii", False)):
        stdout = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
        monkeypatch.setattr(sys, "stdout", FileProxy(Console(file=io.StringIO()), stdout))
        assert takes_dots() is takes


def test_it_is_as_wide_as_the_terminal(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setattr(shutil, "get_terminal_size", lambda *_, **__: os.terminal_size((41, 50)))
    assert giraff_setup.map.show.show(FLAT, None) == 0
    _, *lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) == 40


def test_a_room_is_converted(monkeypatch: pytest.MonkeyPatch, giraff: Giraff, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    code, out, complaint = giraff("map", "convert", str(FLAT), "flat.yaml", "--resolution", "0.1")
    assert (code, out, complaint) == (0, "flat.yaml and flat.pgm, by cells of 0.1 m\n", "")
    code, out, _ = giraff("map", "show", "flat.yaml")
    assert code == 0
    assert out.startswith("flat: 12.80 x 8.30 m")

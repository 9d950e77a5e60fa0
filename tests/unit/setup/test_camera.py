"""A camera's lens, height and tilt, by pictures of drawn cameras whose truth the calibration never sees."""

import math
import shutil
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Final, NamedTuple

import msgspec
import pytest

from giraff_core.senses import Camera
from giraff_schemas.camera import Picture
from giraff_setup.camera.board import View, find_board, missing
from giraff_setup.camera.calibrate import guide, measure_folder, measure_live
from giraff_setup.camera.guide import read
from giraff_setup.camera.lens import fit_lens, lens_of
from giraff_setup.camera.picture import Points, UnusableError
from giraff_setup.camera.sheet import find_sheet, middle_of
from giraff_sim.board import ROOT
from giraff_tools.chessboard import drawing
from tests.support.camera_pictures import Studio, TrueCamera, board_views, drawn, sheets
from tests.support.picture_source import Source

FILED: Final = Camera(x=0.05, z=1.0, pitch=0.35)
LENS: Final = lens_of(FILED)
STUDIO: Final = Studio(TrueCamera())


def views_of(pictures: list[bytes]) -> list[View]:
    return [find_board(read(each, LENS), LENS) for each in pictures]


def corners_of(views: list[View]) -> list[Points]:
    return [view.corners.copy() for view in views]


class Taken(NamedTuple):
    """The pictures that a person takes of a board and of a sheet."""

    true: TrueCamera
    boards: list[bytes]
    sheets: list[bytes]


@pytest.fixture(scope="module")
def one() -> Taken:
    studio = Studio(drawn(3), 3)
    return Taken(studio.camera, board_views(studio, 3), sheets(studio, 3))


@pytest.fixture(scope="module")
def views(one: Taken) -> list[View]:
    return views_of(one.boards)


def test_a_drawn_camera_is_found(one: Taken, views: list[View]) -> None:
    """The campaign has more of them."""
    true, _, papers = one
    assert not missing(views, true.width, true.height)
    fit = fit_lens(corners_of(views), true.width, true.height)
    pose = middle_of([find_sheet(read(each, LENS), fit.lens) for each in papers], true.width)
    assert fit.lens.focal_x == pytest.approx(true.focal_x, rel=0.01)
    assert fit.lens.focal_y == pytest.approx(true.focal_y, rel=0.01)
    assert pose.z == pytest.approx(true.z, rel=0.01)
    assert math.degrees(pose.pitch - true.pitch) == pytest.approx(0.0, abs=0.5)
    assert math.degrees(pose.roll - true.roll) == pytest.approx(0.0, abs=0.5)


BOARDS: Final[dict[str, tuple[Callable[[Studio], bytes], str]]] = {
    "fewer squares": (lambda studio: studio.board(0.0, 0.0, 0.36, squares=(9, 6)), "no whole board of 9 x 6"),
    "more squares": (lambda studio: studio.board(0.0, 0.0, 0.36, squares=(11, 8)), "no whole board of 9 x 6"),
    "partly outside": (lambda studio: studio.board(0.2, 0.0, 0.36), "no whole board of 9 x 6"),
    "glare": (lambda studio: studio.board(0.0, 0.0, 0.36, glare=True), "away from the light"),
    "out of focus": (lambda studio: studio.board(0.0, 0.0, 0.36, blur=1.5), "blurred"),
    "moved": (lambda studio: studio.board(0.0, 0.0, 0.36, smear=5), "blurred"),
    "torn": (lambda studio: studio.board(0.0, 0.0, 0.36)[:4000], "torn"),
    "no picture": (lambda studio: b"GIF89a" + bytes(studio.camera.width), "no picture that can be read"),
    "another size": (lambda _: Studio(TrueCamera(width=160, height=120)).board(0.0, 0.0, 0.36), "160 x 120"),
}


@pytest.mark.parametrize("case", BOARDS)
def test_a_bad_picture_of_the_board_is_refused(case: str) -> None:
    take, words = BOARDS[case]
    with pytest.raises(UnusableError, match=words):
        find_board(read(take(STUDIO), LENS), LENS)


def test_a_board_that_is_upside_down_counts() -> None:
    views_of([STUDIO.board(0.0, 0.0, 0.36, spin=math.pi)])


SHEETS: Final[dict[str, tuple[Callable[[Studio], bytes], str]]] = {
    "a square": (lambda studio: studio.sheet(1.2, yaw=0.4, size=(0.21, 0.21)), "no flat sheet of A4"),
    "far away": (lambda studio: studio.sheet(2.5), "too small"),
    "too far": (lambda studio: studio.sheet(1.8, yaw=1.6), "lay it nearer"),
    "at the horizon": (lambda studio: studio.sheet(8.0), "no whole sheet is seen"),
    "partly outside": (lambda studio: studio.sheet(0.92), "no whole sheet is seen"),
    "on white floor": (lambda studio: studio.sheet(1.2, floor=210.0), "on darker floor"),
    "no sheet": (lambda studio: studio.sheet(-5.0), "no whole sheet is seen"),
    "camera looks up": (lambda _: Studio(TrueCamera(pitch=-0.6)).sheet(1.2), "that the camera sees the floor"),
    "camera is turned": (lambda _: Studio(TrueCamera(roll=0.5)).sheet(1.2), "turned by 29° to the side"),
    "the board": (lambda studio: studio.board(0.0, 0.0, 0.5, tilt=-0.5), "no whole sheet is seen"),
}


@pytest.mark.parametrize("case", SHEETS)
def test_a_bad_picture_of_the_sheet_is_refused(case: str) -> None:
    take, words = SHEETS[case]
    with pytest.raises(UnusableError, match=words):
        find_sheet(read(take(STUDIO), LENS), LENS)


def test_views_that_tell_too_little_are_refused(views: list[View]) -> None:
    with pytest.raises(UnusableError, match="9 usable views"):
        fit_lens(corners_of(views[:9]), 320, 240)
    facing = [STUDIO.board(x, y, 0.5) for x in (-0.1, 0.0, 0.1) for y in (-0.08, -0.03, 0.03, 0.08)]
    with pytest.raises(UnusableError, match="too alike"):
        fit_lens(corners_of(views_of(facing)), 320, 240)


def test_a_sheet_of_us_letter_is_refused() -> None:
    """One picture may leave it open; several do not."""
    pictures = [STUDIO.sheet(1.1 + 0.05 * turn, yaw=turn, size=(0.279, 0.216)) for turn in (0.1, 0.9, 1.7)]
    with pytest.raises(UnusableError, match="sheet"):
        middle_of([find_sheet(read(each, LENS), LENS) for each in pictures], 320)


def test_a_view_that_does_not_fit_the_others_is_left_out(one: Taken, views: list[View]) -> None:
    corners = corners_of(views)
    corners[4][27:, 0] += 6.0  # the lower half of a picture that was torn as it was read out
    fit = fit_lens(corners, 320, 240)
    assert fit.left_out == (4,)
    assert fit.lens.focal_x == pytest.approx(one.true.focal_x, rel=0.01)


class Person:
    """Answers the question whether to write, and lays the sheet where it is asked."""

    def __init__(self, answer: str) -> None:
        self._answer = answer
        self.told: list[str] = []

    def show(self, text: str) -> None:
        self.told.append(text)

    def ask(self, question: str, meanwhile: Callable[[], str]) -> str:
        self.told += [question, meanwhile()]
        return self._answer if "Write" in question else ""


class Shown(Source):
    """Pictures of a board that is moved from place to place and held still at each, then of the sheet."""

    def __init__(self, taken: Taken) -> None:
        super().__init__()
        moving = [STUDIO.board(0.01 * number, 0.0, 0.5) for number in range(2)]
        still = [each for view in taken.boards for each in (view, view)]
        self._left = iter([*moving, *still, *(each for one in taken.sheets for each in (one, one))])

    def next_picture(self) -> Picture:
        return Picture(camera="head", jpeg=next(self._left), width=0, height=0, tick=None)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return Path(shutil.copy(ROOT / "deploy" / "robot.toml", tmp_path / "robot.toml"))


def filed(path: Path) -> Camera:
    """Return the camera that the robot file has."""
    table = tomllib.loads(path.read_text(encoding="utf-8"))["robot"]["sensors"]["head"]
    del table["type"]
    return msgspec.convert(table, Camera)


def test_a_guided_person_calibrates_a_live_camera(path: Path, one: Taken) -> None:
    before, was = path.read_text(encoding="utf-8"), filed(path)
    person = Person("yes")
    assert guide(person, "head", was, path, measure_live(Shown(one))) == 0
    found = filed(path)
    assert found.focal_x == pytest.approx(one.true.focal_x, rel=0.01)
    assert found.z == pytest.approx(one.true.z, rel=0.01)
    assert (found.x, found.y, found.yaw) == (was.x, was.y, was.yaw)
    assert [each.read_text() for each in path.parent.iterdir() if each != path] == [before]
    assert any("is taken; show the board at the left edge" in line for line in person.told)
    assert any("Error left: lens 0.1" in line for line in person.told)
    assert any("    0.000 0.000 0.000 0.000\n" in line for line in person.told)  # the lens of the file


def test_a_folder_of_pictures_calibrates_a_camera(path: Path, tmp_path: Path, one: Taken) -> None:
    folder = tmp_path / "pictures"
    folder.mkdir()
    names = [*(f"board{number:02}.jpg" for number in range(len(one.boards))), "same.jpg", "torn.jpg"]
    for name, picture in zip(names, [*one.boards, one.boards[0], one.boards[0][:4000]], strict=True):
        (folder / name).write_bytes(picture)
    person, text = Person("yes"), path.read_text(encoding="utf-8")
    assert guide(person, "head", filed(path), path, measure_folder(folder)) == 1  # there is no sheet
    for number, picture in enumerate(one.sheets):
        (folder / f"sheet{number}.jpg").write_bytes(picture)
    assert guide(Person("no"), "head", filed(path), path, measure_folder(folder)) == 1
    assert path.read_text(encoding="utf-8") == text
    assert guide(person, "head", filed(path), path, measure_folder(folder)) == 0
    assert filed(path).z == pytest.approx(one.true.z, rel=0.01)
    assert sum("same.jpg does not count" in line or "torn.jpg does not count" in line for line in person.told) == 4


def test_the_board_is_drawn_in_true_size() -> None:
    svg = drawing()
    assert 'width="297mm" height="210mm" viewBox="0 0 297 210"' in svg
    assert svg.count("h25v25h-25z") == 35
    assert svg.count("h100M") == svg.count("v100") == 1  # the rulers

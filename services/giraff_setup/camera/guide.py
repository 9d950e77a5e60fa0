"""A person with a board and a sheet before the camera: what to do next, and when a picture is taken."""

import time
from typing import Final

from giraff_core.picture.receiver import PictureSource
from giraff_setup.camera.board import View, find_board, is_new, is_still, missing
from giraff_setup.camera.lens import FEWEST, Lens, LensFit, fit_lens
from giraff_setup.camera.picture import Grey, UnusableError, decode
from giraff_setup.camera.sheet import FloorPose, find_sheet, middle_of
from giraff_tools.terminal.human import Human

PLACES: Final = 3
"""Number of places of the sheet. Pixels and JPEG move its edges a little, differently at each place."""
_PICTURES: Final = 3
"""At each place."""
_SAME: Final = 10
"""Pictures in a row with the same trouble, until the person is told of it."""
_PAUSE: Final = 0.03  # s
_PATIENCE: Final = 150
"""Pauses and pictures until the person is asked again."""


def read(data: bytes, lens: Lens) -> Grey:
    """Return a picture of the camera's size. Raises UnusableError."""
    return decode(data, lens.width, lens.height)


class ViewGuide:
    """Takes a view when the board is still and the view is new."""

    def __init__(self, lens: Lens) -> None:
        """`lens`: of the robot file."""
        self._lens = lens
        self._before: View | None = None
        self._views: list[View] = []
        self._unlike = ""
        self.fit: LensFit | None = None
        """The lens that fits all views; None: there are too few."""

    def see(self, data: bytes) -> tuple[str, bool]:
        """Look at the next picture; return what to tell the person, and whether a view was taken."""
        try:
            view = find_board(read(data, self._lens), self._lens)
        except UnusableError as error:
            self._before = None
            return str(error), False
        width, height = self._lens.width, self._lens.height
        still = is_still(self._before, view, width)
        self._before = view
        if not still:
            return "hold the board still", False
        if not is_new(view, self._views, width):
            return self.next or "move the board", False
        self._views.append(view)
        if len(self._views) >= FEWEST and not missing(self._views, width, height):
            try:
                self.fit = fit_lens([view.corners for view in self._views], width, height)
            except UnusableError as error:
                self._unlike = str(error)
        return f"view {len(self._views)} of {max(FEWEST, len(self._views))} is taken; {self.next}", True

    @property
    def next(self) -> str:
        """What to do next."""
        if self.fit:
            return "that is enough"
        words = missing(self._views, self._lens.width, self._lens.height)
        return words or self._unlike or "show the board elsewhere, tilted another way"


def take_views(human: Human, pictures: PictureSource, lens: Lens) -> LensFit:
    """Guide the person with the board until the lens is known; Ctrl-C ends it."""
    human.show(
        "Hold the board of `giraff camera board` before the camera, flat, and still for a moment at each place. "
        "A view is taken by itself; Ctrl-C ends it and nothing is written.\n"
        "First: hold it into the middle of the picture, as large as it fits."
    )
    guide = ViewGuide(lens)
    told, trouble, count = "", "", 0
    while guide.fit is None:
        picture = pictures.ask()
        words, taken = guide.see(picture.jpeg) if picture is not None else (str(pictures.trouble), False)
        if picture is None:
            time.sleep(_PAUSE)
        count = count + 1 if words == trouble else 1
        trouble = words
        if words and (taken or (count == _SAME and words != told)):
            human.show(words[0].upper() + words[1:] + ".")
            told = words
    return guide.fit


def take_sheets(human: Human, pictures: PictureSource, lens: Lens) -> list[FloorPose]:
    """Guide the person with the sheet. Raises NobodyError."""

    def find() -> str:
        if (picture := pictures.ask()) is None:
            return str(pictures.trouble) or shown[0]
        try:
            pose = find_sheet(read(picture.jpeg, lens), lens)
            shown[0] = f"the sheet is seen: the camera is {pose.z:.3f} m high"
        except UnusableError as error:
            shown[0] = str(error)
        return shown[0]

    shown = [""]
    while True:
        found: list[FloorPose] = []
        for place in range(PLACES):
            where = "about as far ahead as the camera is high" if place == 0 else "nearby, turned another way"
            while len(found) < (place + 1) * _PICTURES:
                human.ask(
                    f"Place {place + 1} of {PLACES}: lay a sheet of white A4 on darker floor, {where}. Press Enter "
                    "when it lies there.",
                    find,
                )
                found = found[: place * _PICTURES]
                if trouble := _collect(found, (place + 1) * _PICTURES, pictures, lens):
                    human.show(trouble[0].upper() + trouble[1:] + ".")
        try:
            middle_of(found, lens.width)
        except UnusableError as error:
            human.show(f"Once more: {error}.")
        else:
            return found


def _collect(found: list[FloorPose], wanted: int, pictures: PictureSource, lens: Lens) -> str:
    """Add poses until there are so many; return why they do not come, empty: they have."""
    trouble = "no picture comes"
    for _ in range(_PATIENCE):
        if (picture := pictures.ask()) is None:
            trouble = str(pictures.trouble) or trouble
            time.sleep(_PAUSE)
            continue
        try:
            found.append(find_sheet(read(picture.jpeg, lens), lens))
        except UnusableError as error:
            trouble = str(error)
        if len(found) >= wanted:
            return ""
    return trouble

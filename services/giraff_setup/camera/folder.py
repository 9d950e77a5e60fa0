"""Pictures in a folder: those whose name begins with "sheet" show the sheet, all others the board."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from giraff_setup.camera.board import View, find_board, is_new, missing
from giraff_setup.camera.guide import read
from giraff_setup.camera.lens import FEWEST, Lens, LensFit, fit_lens
from giraff_setup.camera.picture import Grey, UnusableError
from giraff_setup.camera.sheet import FloorPose, find_sheet
from giraff_tools.terminal.human import Human

SHEET: Final = "sheet"
_KINDS: Final = frozenset({".jpg", ".jpeg", ".png"})


def lens_from(folder: Path, human: Human, lens: Lens) -> LensFit:
    """Fit the lens to the pictures of the board, and tell which were of no use. Raises UnusableError."""
    views: list[View] = []
    names: list[str] = []
    for path in _pictures(folder):
        if path.name.startswith(SHEET):
            continue
        try:
            view = find_board(_read(path, lens), lens)
        except UnusableError as error:
            human.show(f"{path.name} does not count: {error}.")
            continue
        if is_new(view, views, lens.width):
            views.append(view)
            names.append(path.name)
        else:
            human.show(f"{path.name} does not count: another picture shows the board so already.")
    if (words := missing(views, lens.width, lens.height)) and len(views) >= FEWEST:
        raise UnusableError(f"the {len(views)} views of the board are not spread enough; {words}")
    fit = fit_lens([view.corners for view in views], lens.width, lens.height)
    for number in fit.left_out:
        human.show(f"{names[number]} does not count: its corners do not fit the others'; it may be torn or blurred.")
    return fit


def poses_from(folder: Path, human: Human, lens: Lens) -> list[FloorPose]:
    """Return the pose from each picture of the sheet that tells it."""
    found: list[FloorPose] = []
    for path in _pictures(folder):
        if path.name.startswith(SHEET):
            try:
                found.append(find_sheet(_read(path, lens), lens))
            except UnusableError as error:
                human.show(f"{path.name} does not count: {error}.")
    return found


def _pictures(folder: Path) -> list[Path]:
    try:
        return sorted(path for path in folder.iterdir() if path.suffix.lower() in _KINDS)
    except OSError as error:
        raise UnusableError(f"{folder} cannot be read: {error.strerror}; name a folder of pictures") from error


def _read(path: Path, lens: Lens) -> Grey:
    try:
        return read(path.read_bytes(), lens)
    except OSError as error:
        raise UnusableError(f"it cannot be read: {error.strerror}") from error

"""A floor plan: walls as segments, whatever file they come from."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from giraff_schemas.checks import refuse_to_read

Wall = tuple[float, float, float, float]
"""m; from x, y to x, y."""


class MapError(Exception):
    """A map that cannot be used. The message names the file and the place in it, the likely cause and the way out."""


def at_home(path: Path) -> Path:
    """Return the path with the home folder in place of a leading `~`, which no shell replaces in a file."""
    try:
        return path.expanduser()
    except RuntimeError:  # there is no such user
        return path


def require_file(path: Path) -> None:
    """Raise MapError for what is there and is no regular file."""
    if why := refuse_to_read(path):
        raise MapError(why)


def read_text(path: Path) -> str:
    """Return the text of a file, less a byte order mark. Raises MapError; ValueError where it is no text."""
    try:
        require_file(path)
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise MapError(f"{path}: cannot be read: {error.strerror}") from error


class Bounds(NamedTuple):
    """m."""

    left: float
    bottom: float
    right: float
    top: float


class FloorPlan(NamedTuple):
    """What stands on a floor: never empty, all finite."""

    name: str
    walls: tuple[Wall, ...]

    @property
    def bounds(self) -> Bounds:
        """The rectangle about all walls."""
        xs = [x for wall in self.walls for x in (wall[0], wall[2])]
        ys = [y for wall in self.walls for y in (wall[1], wall[3])]
        return Bounds(min(xs), min(ys), max(xs), max(ys))

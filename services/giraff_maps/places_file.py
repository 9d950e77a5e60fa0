"""The file of places and no-go lines, which stands beside its floor plan: `home.places.toml` beside `home.toml`.

It is TOML, metres, in the plan's own frame:

    [places.kitchen]
    x = 3.2
    y = 1.5
    yaw_deg = 90.0                            # degrees counter-clockwise from x

    [no_go.stairs]
    points = [[5.0, 0.0], [5.0, 1.2]]         # a line that no route crosses
"""

import contextlib
import math
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeVar

import msgspec

from giraff_maps.floor_plan import MapError, read_text
from giraff_maps.room_file import Point
from giraff_schemas.places import MOST, NoGoLine, Place
from giraff_schemas.text import plain, printable

_ENDING: Final = ".places.toml"
_HEAD: Final = "# Places and no-go lines of the floor plan {}. `giraff place` writes them, and people may, too.\n"
MadeT = TypeVar("MadeT")
_BARE: Final = re.compile(r"[A-Za-z0-9_-]+")
"""A key of TOML that needs no quotes."""


class _Strict(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    pass


class PlaceTable(_Strict, frozen=True, kw_only=True):
    """m, m, degrees counter-clockwise from x."""

    x: float
    y: float
    yaw_deg: float


class LineTable(_Strict, frozen=True, kw_only=True):
    """m. Both ends of a line."""

    points: tuple[Point, Point]


class PlacesFile(_Strict, frozen=True, kw_only=True):
    """Content of the file: a `PlaceTable` and a `LineTable` by each name."""

    places: dict[str, Any] = {}
    no_go: dict[str, Any] = {}


class KnownPlaces(NamedTuple):
    """Places and lines of one plan, in the file's order."""

    places: tuple[Place, ...] = ()
    no_go: tuple[NoGoLine, ...] = ()


def places_path(plan: Path) -> Path:
    """Return the path of the file that belongs to a floor plan."""
    return plan.with_name(f"{plan.stem}{_ENDING}")


class PlacesStore:
    """The file that belongs to a floor plan. Raises MapError, whatever is wrong with it."""

    def __init__(self, plan: Path, write: Callable[[Path, bytes], None]) -> None:
        """`write`: replaces a file durably, or raises OSError."""
        self._path, self._write = places_path(plan), write

    def read(self) -> KnownPlaces:
        """Return what the file has. A file that is not there has nothing."""
        return read_places(self._path)

    def write(self, known: KnownPlaces) -> None:
        """Add to the file and remove from it, so that it has these places and lines. All else in it stays."""
        try:
            self._write(self._path, _changed(self._path, known).encode())
        except OSError as error:
            raise MapError(
                f"{self._path} cannot be written: {error.strerror or error}; make room on that disk, or put the floor "
                "plan into a folder that giraff_places may write to"
            ) from error


def read_places(path: Path) -> KnownPlaces:
    """Return what the file has. A file that is not there has nothing. Raises MapError."""
    text = _text(path)
    return KnownPlaces() if text is None else _known(text, path)


def _text(path: Path) -> str | None:
    """Return the text of a file. None: it is not there. Raises MapError."""
    try:
        return read_text(path) if path.exists() or path.is_symlink() else None
    except (OSError, ValueError) as error:  # nobody may look into the folder, or it is no text
        raise MapError(f"{path}: {plain(error)}") from error


def _changed(path: Path, known: KnownPlaces) -> str:
    """Return the text of the file with these places and lines. Raises MapError."""
    text = _text(path) or _HEAD.format(path.name.removesuffix(_ENDING))
    there = _known(text, path)
    for table, before, now in (("places", there.places, known.places), ("no_go", there.no_go, known.no_go)):
        for each in before:
            if each not in now:
                text = _without(text, {table: {each.name: {}}})
        text += "".join(_table_of(each) for each in now if each not in before)
    with contextlib.suppress(MapError):
        if _known(text, path) == known:
            return text
    raise MapError(f"{path}: not in a form that can be changed: give each place and line a table of its own")


def _known(text: str, path: Path) -> KnownPlaces:
    """Return what a file with this text has. Raises MapError."""
    try:
        content = msgspec.convert(tomllib.loads(text), PlacesFile)
    except (ValueError, RecursionError) as error:
        raise MapError(f"{path}: {plain(error)}") from error
    places = tuple(_made(path, "places", name, table, _place) for name, table in content.places.items())
    no_go = tuple(_made(path, "no_go", name, table, _line) for name, table in content.no_go.items())
    if both := content.places.keys() & content.no_go.keys():
        raise MapError(f"{path}: {min(both)!r} is a place and a line: give one of them another name")
    if max(len(places), len(no_go)) > MOST:
        raise MapError(f"{path}: more than {MOST} places or lines: remove some")
    return KnownPlaces(places, no_go)


def _made(path: Path, kind: str, name: str, table: object, make: Callable[[str, object], MadeT]) -> MadeT:
    try:
        return make(name, table)
    except ValueError as error:
        raise MapError(f"{path}: [{kind}.{printable(name)}]: {plain(error)}; mend it, or remove it") from error


def _place(name: str, table: object) -> Place:
    fields = msgspec.convert(table, PlaceTable)
    yaw = math.remainder(math.radians(fields.yaw_deg), math.tau) if math.isfinite(fields.yaw_deg) else math.nan
    return Place(name=name, x=fields.x, y=fields.y, yaw=yaw)


def _line(name: str, table: object) -> NoGoLine:
    (x, y), (end_x, end_y) = msgspec.convert(table, LineTable).points
    return NoGoLine(name=name, x=x, y=y, end_x=end_x, end_y=end_y)


def _table_of(each: Place | NoGoLine) -> str:
    key = each.name if _BARE.fullmatch(each.name) else f'"{each.name}"'
    if isinstance(each, Place):
        yaw = round(math.degrees(each.yaw), 1) + 0.0
        return f"\n[places.{key}]\nx = {each.x!r}\ny = {each.y!r}\nyaw_deg = {yaw!r}\n"
    return f"\n[no_go.{key}]\npoints = [[{each.x!r}, {each.y!r}], [{each.end_x!r}, {each.end_y!r}]]\n"


def _without(text: str, header: dict[str, dict[str, dict[str, float]]]) -> str:
    """Return the text without the table of this header. Comments before it and behind it stay."""
    lines = re.findall("[^\n]*\n|[^\n]+", text)
    headers = {at: found for at, line in enumerate(lines) if (found := _header(line))}
    begin = next((at for at, found in headers.items() if found == header), None)
    if begin is None:
        return text
    end = next((at for at in headers if at > begin), len(lines))
    while lines[end - 1].strip()[:1] in {"", "#"}:
        end -= 1
    if begin and not lines[begin - 1].strip():
        begin -= 1
    return "".join(lines[:begin] + lines[end:])


def _header(line: str) -> dict[str, object]:
    """Return the tables that a line is the header of; empty: it is none."""
    try:
        return tomllib.loads(line) if line.lstrip().startswith("[") else {}
    except ValueError:
        return {}

"""The file of places and no-go lines, which stands beside its floor plan: `home.places.toml` beside `home.toml`.

It is TOML, metres, in the plan's own frame:

    [places.kitchen]
    x = 3.2
    y = 1.5
    yaw_deg = 90.0                            # degrees counter-clockwise from x

    [no_go.stairs]
    points = [[5.0, 0.0], [5.0, 1.2]]         # a line that no route crosses
"""

import math
import tomllib
from pathlib import Path
from typing import Final, NamedTuple

import msgspec

from giraff_maps.floor_plan import MapError, read_text
from giraff_maps.room_file import Point
from giraff_schemas.places import MOST, NoGoLine, Place
from giraff_schemas.text import plain

_ENDING: Final = ".places.toml"


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
    """Content of the file."""

    places: dict[str, PlaceTable] = {}
    no_go: dict[str, LineTable] = {}


class KnownPlaces(NamedTuple):
    """Places and lines of one plan, in the file's order."""

    places: tuple[Place, ...] = ()
    no_go: tuple[NoGoLine, ...] = ()


def places_path(plan: Path) -> Path:
    """Return the path of the file that belongs to a floor plan."""
    return plan.with_name(f"{plan.stem}{_ENDING}")


def read_places(path: Path) -> KnownPlaces:
    """Return what the file has. A file that is not there has nothing. Raises MapError."""
    if not path.exists():
        return KnownPlaces()
    try:
        content = msgspec.convert(tomllib.loads(read_text(path)), PlacesFile)
        places = tuple(_place(name, table) for name, table in content.places.items())
        no_go = tuple(
            NoGoLine(name=name, x=x, y=y, end_x=end_x, end_y=end_y)
            for name, ((x, y), (end_x, end_y)) in ((name, table.points) for name, table in content.no_go.items())
        )
        if both := content.places.keys() & content.no_go.keys():
            raise ValueError(f"{min(both)!r} is a place and a line: give one of them another name")
    except (ValueError, RecursionError) as error:
        raise MapError(f"{path}: {plain(error)}") from error
    if max(len(places), len(no_go)) > MOST:
        raise MapError(f"{path}: more than {MOST} places or lines: remove some")
    return KnownPlaces(places, no_go)


def _place(name: str, table: PlaceTable) -> Place:
    yaw = math.remainder(math.radians(table.yaw_deg), math.tau) if math.isfinite(table.yaw_deg) else math.nan
    return Place(name=name, x=table.x, y=table.y, yaw=yaw)

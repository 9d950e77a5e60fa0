"""A disk of two rings of black sectors: its drawing for a printer, and the edges that such a drawing gives an encoder.

Angles of the drawing grow counter-clockwise, as they pass a sensor while the disk turns clockwise. Black is a high
level. The outer ring is channel A, and the inner ring is channel B.
"""

import itertools
import math
import re
import statistics
from collections import defaultdict
from typing import Annotated, Final, NamedTuple
from xml.etree import ElementTree as ET

import msgspec

from giraff_core.bounds import Bounds, check_bounds

LONGEST: Final = 2_000_000
"""Characters of a drawing that is read. A disk of 40 pairs has 14 000."""

_A4: Final = (210.0, 297.0)  # mm, in portrait
_BORDER: Final = 15.0  # mm that printers leave white
_WHITE: Final = 1.0  # mm between the rings, and between the outer one and the rim
_NARROWEST: Final = 0.5  # mm of a sector that a printer draws cleanly and a sensor still sees
_NARROWEST_RING: Final = 2.0  # mm from its inner edge to its outer edge
_RULER: Final = 100  # mm
_TICK: Final = 10  # mm
_LINE: Final = 7.0  # mm from one line of words to the next
_SVG: Final = "{http://www.w3.org/2000/svg}"
_NUMBER: Final = r"(-?\d+(?:\.\d+)?)"
_ARC: Final = rf"A{_NUMBER} {_NUMBER} 0 ([01]) ([01]) {_NUMBER} {_NUMBER}"
_SECTOR: Final = re.compile(rf"M{_NUMBER} {_NUMBER}{_ARC}L{_NUMBER} {_NUMBER}{_ARC}Z")
_OFF: Final = 0.01  # mm by which the corners of a sector may be off
_DIGITS: Final = 6  # of an angle as a share of a turn: finer than any printer draws
_REMEDY: Final = "draw a new one with giraff encoder disk"


class Edge(NamedTuple):
    """A change of one channel or both."""

    at: float
    """Share of a turn, 0 up to but not including 1, in the forward direction."""
    a: bool
    """Level of channel A just after the edge, while the disk turns forward."""
    b: bool
    """Level of channel B just after the edge, while the disk turns forward."""


class Pattern(NamedTuple):
    """All edges of one turn."""

    states_per_turn: int
    """States by which the position grows in a turn: four for each black and white pair of the ideal disk."""
    edges: tuple[Edge, ...]
    """In the order of their positions."""


class Disk(msgspec.Struct, frozen=True, kw_only=True):
    """The disk that is printed. Raises ValueError for one that cannot be."""

    pairs: Annotated[int, Bounds(1, 5000)] = 40
    """Black and white sectors of a ring, counted in pairs."""
    outer: Annotated[float, Bounds(10.0, 400.0, "mm")] = 60.0
    """mm. Diameter of the disk."""
    inner: Annotated[float, Bounds(2.0, 400.0, "mm")] = 30.0
    """mm. Diameter of the inner ring at its inner edge."""
    hole: Annotated[float, Bounds(0.5, 400.0, "mm")] = 6.0
    """mm. Diameter of the hole for the shaft."""
    offset: Annotated[float, Bounds(0.0, 1.0)] = 0.25
    """Share of a pair by which the inner ring is turned against the outer one, counter-clockwise."""
    black: Annotated[float, Bounds(0.01, 0.99)] = 0.5
    """Share of a pair that is black."""

    def __post_init__(self) -> None:
        check_bounds(self)
        if not self.hole < self.inner:
            raise ValueError(f"hole is {self.hole:g} mm: it must be less than inner, which is {self.inner:g} mm")
        least = self.inner + 2.0 * (2.0 * _NARROWEST_RING + 2.0 * _WHITE)
        if not self.outer >= least:
            raise ValueError(f"outer is {self.outer:g} mm: with inner {self.inner:g} mm, it must be {least:g} at least")
        most = math.floor(math.pi * self.inner * min(self.black, 1.0 - self.black) / _NARROWEST)
        if self.pairs > most:
            room = f"at most {most} fit" if most else "not even one fits"
            raise ValueError(
                f"pairs is {self.pairs}: {room} on an inner diameter of {self.inner:g} mm, because a sector must be "
                f"{_NARROWEST:g} mm wide; make inner and outer larger, or pairs fewer"
            )

    @property
    def states_per_turn(self) -> int:
        """Changes of either sensor in one turn."""
        return 4 * self.pairs

    @property
    def ticks_per_turn(self) -> int:
        """Ticks of a base board in one turn: it counts both edges of A."""
        return 2 * self.pairs

    @property
    def rings(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """mm. Inner and outer radius of A's ring, which is the outer one, and of B's."""
        begin, end = self.inner / 2.0, self.outer / 2.0 - _WHITE
        width = (end - begin - _WHITE) / 2.0
        return (end - width, end), (begin, begin + width)


def drawing(disk: Disk) -> str:
    """Return the disk as SVG, in true size."""
    width = max(_A4[0], disk.outer + 2.0 * _BORDER)
    height = max(_A4[1], disk.outer + 6.0 * _BORDER)
    x, y = width / 2.0, _BORDER + disk.outer / 2.0
    sectors = "".join(
        f'<path d="{_sector(x, y, ring, (number + turned) / disk.pairs, disk.black / disk.pairs)}" fill="#000"/>\n'
        for ring, turned in zip(disk.rings, (0.0, disk.offset), strict=True)
        for number in range(disk.pairs)
    )
    cuts = "".join(f'<circle cx="{x:g}" cy="{y:g}" r="{across / 2.0:g}"/>\n' for across in (disk.outer, disk.hole))
    arm = disk.inner / 2.0 - _WHITE
    left, across = x - _RULER / 2.0, y + disk.outer / 2.0 + _BORDER
    ruler = f"M{left:g} {across:g}h{_RULER}" + "".join(
        f"M{left + tick:g} {across:g}v-3" for tick in range(0, _RULER + 1, _TICK)
    )
    words = (
        f"Print at 100 %, not fitted to the page. The ruler must be {_RULER} mm long. Cut along both circles.",
        f"{disk.pairs} pairs: {disk.states_per_turn} states a turn. Outer ring: channel A. Inner ring: channel B.",
        "Both sensors stand on one radius. A leads B while this side is seen to turn clockwise.",
    )
    lines = "".join(
        f'<text x="{_BORDER:g}" y="{across + _LINE * nth:g}" font-family="sans-serif" font-size="3.5">{line}</text>\n'
        for nth, line in enumerate(words, start=1)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}mm" height="{height:g}mm" '
        f'viewBox="0 0 {width:g} {height:g}">\n'
        f'<rect width="{width:g}" height="{height:g}" fill="#fff"/>\n'
        f"{sectors}"
        f'<g fill="none" stroke="#000" stroke-width="0.1">\n{cuts}'
        f'<path d="M{x - arm:g} {y:g}h{2.0 * arm:g}M{x:g} {y - arm:g}v{2.0 * arm:g}"/>\n'
        f'<path d="{ruler}" stroke-width="0.3"/>\n</g>\n'
        f"{lines}</svg>\n"
    )


def _sector(x: float, y: float, ring: tuple[float, float], start: float, span: float) -> str:
    """Return the path of a black sector; start and span are shares of a turn."""

    def point(radius: float, share: float) -> str:
        angle = math.tau * share
        return f"{x + radius * math.cos(angle):.5f} {y - radius * math.sin(angle):.5f}"

    inside, outside = ring
    end, is_large = start + span, int(round(span, _DIGITS) > 0.5)
    return (
        f"M{point(outside, start)}A{outside:.5f} {outside:.5f} 0 {is_large} 0 {point(outside, end)}"
        f"L{point(inside, end)}A{inside:.5f} {inside:.5f} 0 {is_large} 1 {point(inside, start)}Z"
    )


class _Sector(NamedTuple):
    """A black sector of a drawing. Both angles are shares of a turn."""

    start: float
    end: float


def read_pattern(text: str) -> Pattern:
    """Return the edges that a drawing gives, by where its black sectors begin and end. ValueError: it is no disk."""
    root = _parsed(text)
    centres = {(each.get("cx"), each.get("cy")) for each in root.iter(f"{_SVG}circle")}
    paths = [path.get("d", "") for path in root.iter(f"{_SVG}path") if path.get("fill") == "#000"]
    if len(centres) != 1 or not paths:
        raise ValueError(f"it is no drawing of an encoder's disk; {_REMEDY}")
    if any(element.get("transform") for element in root.iter()):
        raise ValueError(f"another program has moved or scaled its parts; {_REMEDY}")
    centre = _centre(*centres.pop())
    by_ring: defaultdict[float, list[_Sector]] = defaultdict(list)
    for path in paths:
        radius, sector = _read_sector(path, centre)
        by_ring[radius].append(sector)
    if len(by_ring) != 2:
        raise ValueError(f"rings of black sectors in it: {len(by_ring)}, and an encoder has two; {_REMEDY}")
    inner, outer = (by_ring[radius] for radius in sorted(by_ring))
    spaces = [space for ring in (inner, outer) for space in _spaces(ring)]
    # The middle one: where a sector is missing, one space is two pairs wide.
    pairs = round(1.0 / statistics.median(spaces))
    return Pattern(4 * pairs, tuple(_edges(outer, inner)))


def _parsed(text: str) -> ET.Element:
    if len(text) > LONGEST:
        raise ValueError(f"it is longer than {LONGEST} characters, and no drawing of an encoder's disk is")
    if "<!" in text.replace("<!--", ""):  # entities that grow without bound are declared so
        raise ValueError(f"it declares a document type, which no drawing of an encoder's disk does; {_REMEDY}")
    try:
        return ET.fromstring(text)  # noqa: S314  without a document type there are no entities
    except ET.ParseError as error:
        raise ValueError(f"it is no SVG, or not all of one: {error}; {_REMEDY}") from error


def _centre(x: str | None, y: str | None) -> tuple[float, float]:
    try:
        return float(x or "0"), float(y or "0")
    except ValueError as error:
        raise ValueError(f"its circles have no centre: {x!r}, {y!r}; {_REMEDY}") from error


def _read_sector(path: str, centre: tuple[float, float]) -> tuple[float, _Sector]:
    """Return the outer radius of a sector and the sector."""
    found = _SECTOR.fullmatch(path)
    if found is None:
        raise ValueError(f"a black part of it is no sector of a ring: {path[:60]!r}; {_REMEDY}")
    x1, y1, rx, ry, large, sweep, x2, y2, x3, y3, *_inner_arc, x4, y4 = map(float, found.groups())
    corners = [complex(x - centre[0], centre[1] - y) for x, y in ((x1, y1), (x2, y2), (x3, y3), (x4, y4))]
    first, second, third, fourth = corners
    sector = _Sector(_share(first), _share(second))
    is_large = (sector.end - sector.start) % 1.0 > 0.5
    is_sector = (
        0.0 < abs(fourth) < abs(first)
        and all(abs(radius - abs(first)) <= _OFF for radius in (abs(second), rx, ry))
        and abs(abs(third) - abs(fourth)) <= _OFF
        and _stand_on_one_radius(first, fourth)
        and _stand_on_one_radius(second, third)
    )
    if not is_sector or sweep or is_large != bool(large):
        raise ValueError(f"a black part of it is no sector around its centre: {path[:60]!r}; {_REMEDY}")
    return rx, sector


def _stand_on_one_radius(outside: complex, inside: complex) -> bool:
    product = outside.conjugate() * inside
    return product.real > 0.0 and abs(product.imag) <= _OFF * abs(outside)


def _share(corner: complex) -> float:
    """Return the angle of a corner as a share of a turn."""
    return round(math.atan2(corner.imag, corner.real) / math.tau, _DIGITS) % 1.0


def _spaces(ring: list[_Sector]) -> list[float]:
    """Return the shares of a turn from each sector's start to the next one's. ValueError where sectors overlap."""
    ring.sort()
    spaces = []
    for sector, following in itertools.pairwise([*ring, ring[0]]):
        space = (following.start - sector.start) % 1.0 if len(ring) > 1 else 1.0
        if (sector.end - sector.start) % 1.0 >= space:
            raise ValueError(f"black sectors of it touch, at {sector.end * 360.0:.1f}°; {_REMEDY}")
        spaces.append(space)
    return spaces


def _edges(outer: list[_Sector], inner: list[_Sector]) -> list[Edge]:
    """Return the edges of a turn, of channel A on the outer ring and B on the inner one."""
    changes: defaultdict[float, dict[int, bool]] = defaultdict(dict)
    for channel, ring in enumerate((outer, inner)):
        for sector in ring:
            changes[sector.start][channel] = True
            changes[sector.end][channel] = False
    # A ring is black where a turn begins if one of its sectors ends before it starts.
    levels = [any(sector.end < sector.start for sector in ring) for ring in (outer, inner)]
    edges = []
    for at in sorted(changes):
        for channel, level in changes[at].items():
            levels[channel] = level
        edges.append(Edge(at, *levels))
    return edges

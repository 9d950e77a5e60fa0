"""Walls, furniture and people as a camera meets them: upright surfaces, each from a height to a height."""

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from giraff_sim.camera.scene import Walker
from giraff_sim.camera.textures import Index, Single, Texture

Wall = tuple[str, float, float, float, float]
"""Its name and its ends, m."""
Post = tuple[str, float, float, float]
"""Its name, its middle and its radius, m."""
Color = tuple[int, int, int]
"""Blue, green, red of the middle grey."""

CEILING: Final = 2.5
"""m."""
_NEAREST: Final = 0.02  # m
_BEHIND: Final = 0.002  # m by which the far side of a piece of furniture is nearer than the wall that it touches
_SAME: Final = 1e-6  # m
_SLACK: Final = 0.1  # share, of a distance beside the surface's end
_PERSON: Final = "person"  # a name that holds it is a person's
_DARKEST: Final = 0.6  # share of the light at the rim of a round surface


class Kind(NamedTuple):
    """What something of a name looks like."""

    word: str
    """A name that holds it is of this kind."""
    top: float
    """m."""
    texture: Texture
    color: Color
    bottom: float = 0.0


WALL: Final = Kind("", CEILING, "plaster", (176, 200, 208))
_COLUMN: Final = Kind("", CEILING, "plaster", (168, 176, 178))
_TROUSERS: Final = Kind("trousers", 0.85, "cloth", (92, 58, 44))
_SHIRT: Final = Kind("shirt", 1.48, "cloth", (70, 70, 168), 0.85)
_HEAD: Final = Kind("head", 1.72, "lino", (128, 158, 206), 1.48)
KINDS: Final = (
    Kind("sofa", 0.80, "cloth", (120, 92, 66)),
    Kind("armchair", 0.85, "cloth", (62, 98, 128)),
    Kind("bed", 0.50, "cloth", (150, 140, 130)),
    Kind("shelf", 1.90, "wood", (70, 112, 158)),
    Kind("cupboard", 1.90, "wood", (70, 112, 158)),
    Kind("television", 0.55, "wood", (58, 64, 74)),
    Kind("table", 0.74, "wood", (74, 108, 148)),
    Kind("chair", 0.90, "wood", (74, 108, 148)),
    Kind("desk", 0.74, "wood", (74, 108, 148)),
    Kind("plant", 0.45, "cloth", (52, 92, 150)),
    Kind("box", 0.40, "wood", (96, 140, 170)),
    _TROUSERS,
    _SHIRT,
    _HEAD,
    WALL,
    _COLUMN,
)
"""Looks by word of a name; the first word that fits counts. A wall or post without one goes up to the ceiling."""


def _kind_of(name: str, otherwise: Kind) -> int:
    low = name.lower()
    return KINDS.index(next((kind for kind in KINDS if kind.word and kind.word in low), otherwise))


class _Side(NamedTuple):
    """An upright rectangle. Of a piece of furniture, outside is to its right."""

    x: float
    y: float
    along_x: float
    along_y: float
    length: float
    kind: int
    is_closed: bool
    """It belongs to something with an inside."""


class SurfaceHits(NamedTuple):
    """The surfaces that the directions meet: arrays by surface and direction, or by surface."""

    far: Single
    """m in the plane; infinite where it is not met."""
    is_far_side: NDArray[np.bool_]
    """It is met from inside: a ray that comes there from above has met the top."""
    shade: Single
    inverse_x: Single
    """A flat surface is met at 1 / (inverse_x cos + inverse_y sin)."""
    inverse_y: Single
    along_x: Single
    along_y: Single
    kind: Index
    flat: int
    """So many of the first are flat."""

    def exact(self, which: Index, cos: Single, sin: Single, away: Single) -> Single:
        """Return how far these surfaces are along just these directions; `away`: along those that were numbered."""
        with np.errstate(divide="ignore", invalid="ignore"):
            exact = np.float32(1.0) / (self.inverse_x[which] * cos + self.inverse_y[which] * sin)
        exact = np.minimum(np.maximum(exact, away * np.float32(1.0 - _SLACK)), away * np.float32(1.0 + _SLACK))
        return np.where(which < self.flat, exact, away)


class Layer(NamedTuple):
    """One surface a direction."""

    surface: Index
    far: Single
    shade: Single
    is_far_side: NDArray[np.bool_]


class Layers:
    """The surfaces of each direction: the nearest, the second, and so on. None is sorted before somebody asks."""

    def __init__(self, seen: SurfaceHits) -> None:
        self.seen = seen
        self._far = seen.far.copy()
        self._every = np.arange(self._far.shape[1])
        self._made: list[Layer] = []

    def __len__(self) -> int:
        return len(self._far)

    def __getitem__(self, number: int) -> Layer:
        while len(self._made) <= number:
            surface = self._far.argmin(axis=0)
            at = surface, self._every
            self._made.append(Layer(surface, self._far[at], self.seen.shade[at], self.seen.is_far_side[at]))
            self._far[at] = np.inf
        return self._made[number]


class Solids:
    """All of them, for many directions at once."""

    def __init__(self, walls: Sequence[Wall] = (), posts: Sequence[Post] = ()) -> None:
        people = [Walker(middle, middle, 0.0) for middle in _people(walls, posts)]
        sides = list(_sides([wall for wall in walls if _PERSON not in wall[0]]))
        column = np.array(sides, np.float32).reshape(-1, len(_Side._fields)).T[:, :, None]
        self._x, self._y, self._along_x, self._along_y, self._length = column[:5]
        self._is_closed = column[6] > 0.5
        self._kind = np.array([side.kind for side in sides], np.intp)
        self._posts = [(_kind_of(name, _COLUMN), x, y, radius) for name, x, y, radius in posts if _PERSON not in name]
        self._posts += [post for person in people for post in _person(person, 0.0)]

    def seen(self, x: float, y: float, cos: Single, sin: Single, people: Iterable[Walker], t: float) -> SurfaceHits:
        """Return what is met from a place in these directions."""
        flat = self._flat(x, y, cos, sin)
        posts = [*self._posts, *(post for person in people for post in _person(person, t))]
        if not posts:
            return flat
        kinds = [post[0] for post in posts]
        post_x, post_y, radius = np.array([post[1:] for post in posts], np.float32).T[:, :, None]
        ahead_x, ahead_y = post_x - np.float32(x), post_y - np.float32(y)
        middle, miss = ahead_x * cos + ahead_y * sin, (ahead_x * sin - ahead_y * cos) / radius
        is_met = (np.abs(miss) < 1.0) & (middle > 0.0)
        height = np.sqrt(np.maximum(np.float32(0.0), np.float32(1.0) - miss * miss))
        near = np.where(is_met, np.maximum(middle - radius * height, np.float32(_NEAREST)), np.float32(np.inf))
        beyond = np.where(is_met, middle + radius * height, np.float32(np.inf))
        shade, even = np.float32(_DARKEST) + np.float32(1.0 - _DARKEST) * height, np.ones_like(height)
        none, slant = np.zeros(2 * len(posts), np.float32), np.full(2 * len(posts), 0.7, np.float32)
        return SurfaceHits(
            far=np.concatenate([flat.far, near, beyond]),
            is_far_side=np.concatenate([flat.is_far_side, np.zeros_like(is_met), np.ones_like(is_met)]),
            shade=np.concatenate([flat.shade, shade, even]),
            inverse_x=np.concatenate([flat.inverse_x, none]),
            inverse_y=np.concatenate([flat.inverse_y, none]),
            along_x=np.concatenate([flat.along_x, slant]),
            along_y=np.concatenate([flat.along_y, slant]),
            kind=np.array([*flat.kind, *kinds, *kinds], np.intp),
            flat=flat.flat,
        )

    def _flat(self, x: float, y: float, cos: Single, sin: Single) -> SurfaceHits:
        ahead_x, ahead_y = self._x - np.float32(x), self._y - np.float32(y)
        across = cos * self._along_y - sin * self._along_x
        apart = ahead_x * self._along_y - ahead_y * self._along_x
        with np.errstate(divide="ignore", invalid="ignore"):
            far = apart / across
            along = (ahead_x * sin - ahead_y * cos) / across
            inverse_x, inverse_y = (self._along_y / apart)[:, 0], (-self._along_x / apart)[:, 0]
        far[~((along >= 0.0) & (along <= self._length) & (far > _NEAREST))] = np.inf
        is_far_side = (across > 0.0) & self._is_closed
        far[is_far_side] -= np.float32(_BEHIND)
        shade = np.float32(0.82) + np.float32(0.18) * np.abs(
            self._along_x * np.float32(0.8) + self._along_y * np.float32(0.6)
        )
        return SurfaceHits(
            far=far,
            is_far_side=is_far_side,
            shade=np.broadcast_to(shade, far.shape),
            inverse_x=inverse_x,
            inverse_y=inverse_y,
            along_x=self._along_x[:, 0],
            along_y=self._along_y[:, 0],
            kind=self._kind,
            flat=len(self._kind),
        )


def _sides(walls: Sequence[Wall]) -> Iterator[_Side]:
    for name, group in itertools.groupby(walls, key=lambda wall: wall[0]):
        kind, lines = _kind_of(name, WALL), [wall[1:] for wall in group]
        is_closed = False
        is_chain = all(math.dist(a[2:], b[:2]) < _SAME for a, b in itertools.pairwise(lines))
        if KINDS[kind].top < CEILING and len(lines) > 1 and is_chain:
            points = [lines[0][:2], *(line[2:] for line in lines)]
            if len(lines) == 2:  # two sides of furniture in a corner
                (x0, y0), (x1, y1), (x2, y2) = points
                points.append((x0 + x2 - x1, y0 + y2 - y1))
            if math.dist(points[0], points[-1]) > _SAME:
                points.append(points[0])
            area = sum(x * next_y - next_x * y for (x, y), (next_x, next_y) in itertools.pairwise(points))
            points = points if area > 0.0 else points[::-1]
            lines, is_closed = [(*a, *b) for a, b in itertools.pairwise(points)], True
        for x, y, end_x, end_y in lines:
            length = math.hypot(end_x - x, end_y - y)
            yield _Side(x, y, (end_x - x) / length, (end_y - y) / length, length, kind, is_closed)


def _people(walls: Sequence[Wall], posts: Sequence[Post]) -> Iterator[tuple[float, float]]:
    """Return where people stand, whatever the room has in their places."""
    for name, group in itertools.groupby(walls, key=lambda wall: wall[0]):
        if _PERSON in name:
            xs, ys = zip(*(end for _, x, y, end_x, end_y in group for end in ((x, y), (end_x, end_y))), strict=True)
            yield sum(xs) / len(xs), sum(ys) / len(ys)
    yield from ((x, y) for name, x, y, _ in posts if _PERSON in name)


def _person(walker: Walker, t: float) -> Iterator[tuple[int, float, float, float]]:
    """Two legs that step, a body and a head."""
    x, y, toward, walked = walker.at(t)
    cos, sin = math.cos(toward), math.sin(toward)
    step = 0.14 * math.sin(walked * math.tau / 1.3)
    for side in (-1, 1):
        ahead, aside = side * step, side * 0.09
        yield KINDS.index(_TROUSERS), x + ahead * cos - aside * sin, y + ahead * sin + aside * cos, 0.085
    yield KINDS.index(_SHIRT), x, y, 0.19
    yield KINDS.index(_HEAD), x, y, 0.095

"""A floor plan in characters: its walls, axes in metres, its places, and where the robot is on it."""

import math
import shutil
from collections.abc import Iterator
from functools import lru_cache
from string import ascii_letters
from typing import Final

from rich.console import Group, RenderableType
from rich.text import Text

from giraff_core.kinematics.pose import ELLIPSE_95
from giraff_maps.floor_plan import FloorPlan, Wall
from giraff_maps.places_file import KnownPlaces
from giraff_schemas.localization import MapPose
from giraff_schemas.places import Place
from giraff_schemas.text import printable
from giraff_tools.terminal.dots import ACROSS, DOWN, Dots, takes_dots

_STEPS: Final = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
"""m from one figure on an axis to the next."""
_APART: Final = 8  # columns at least from one figure to the next
_BELOW: Final = 3  # lines below the drawing: the axis, its figures, and the origin
_ARROWS: Final = ("→↗↑↖←↙↓↘", ">/^\\</v\\")
_AXES: Final = ("┤│└┴─", "+||+-")
_ORIGIN: Final = ("┼", "+")
_NO_GO: Final = ("▒", "!")
_NO_PLACES: Final = KnownPlaces()
_AROUND: Final = 256  # dots of an ellipse
_MOST_STEPS: Final = 4096  # along a line. A longer one ends far outside the plan

_LARGEST: Final = 80, 24
"""Columns and lines of a floor plan above words."""
_WORDS: Final = 5
"""Lines of the terminal that it leaves to the words."""

Cell = tuple[int, int]
"""Line and column of a character of the drawing, from the upper left one."""


class FloorDrawing:
    """Takes no more than so many columns and lines, all of it."""

    def __init__(self, plan: FloorPlan, columns: int, lines: int, *, dots: bool) -> None:
        self._dots = dots
        left, bottom, right, top = self._bounds = plan.bounds
        self._margin = max(len(f"{value:.1f}") for value in (bottom, top)) + 1
        self._per_metre = min(
            (max(1, columns - self._margin) * ACROSS - 1) / max(right - left, 1e-9),
            (max(1, lines - _BELOW) * DOWN - 1) / max(top - bottom, 1e-9),
        )
        self._height, self._width = (number + 1 for number in self._cell(right, bottom))
        self._step = next((step for step in _STEPS if step * self._per_metre >= _APART * ACROSS), _STEPS[-1])
        self._walls = Dots()
        for wall in plan.walls:
            for x, y in _points(wall, self._per_metre):
                self._walls.set(*self._dot(x, y))

    def draw(self, pose: MapPose | None = None, style: str = "", known: KnownPlaces = _NO_PLACES) -> Text:
        """`pose`: the robot's, drawn in this style, with the ellipse that holds it with 95 % and its other places.

        `known`: drawn with the signs of `legend`.
        """
        drawing, ellipse, marks = self._walls.copy(), set[Cell](), self._marks(known)
        if pose is not None and pose.state != "no_map":
            for x, y in filter(lambda point: self._is_inside(*point), _ellipse(pose)):
                drawing.set(*self._dot(x, y))
                ellipse.add(self._cell(x, y))
            places = [place for place in pose.candidates[1:] if self._is_inside(place.x, place.y)]
            robot = {self._cell(place.x, place.y): "?" for place in places}
            if self._is_inside(pose.x, pose.y):
                robot[self._cell(pose.x, pose.y)] = self._either(_ARROWS)[round(pose.yaw / (math.pi / 4.0)) % 8]
            ellipse |= robot.keys()
            marks |= robot
        text = Text(no_wrap=True, overflow="crop")
        for line in range(self._height):
            text.append(self._beside(line))
            for column in range(self._width):
                cell = line, column
                sign = marks.get(cell) or drawing.sign(*cell, dots=self._dots)
                text.append(sign, style if cell in ellipse else "")
            text.rstrip()
            text.append("\n")
        text.append("\n".join(self._below()))
        return text

    def _marks(self, known: KnownPlaces) -> dict[Cell, str]:
        """Return the signs of no-go lines, of the origin above them, and of places above both."""
        lines = [(line.x, line.y, line.end_x, line.end_y) for line in known.no_go]
        marks = [(*point, self._either(_NO_GO)) for line in lines for point in _points(line, self._per_metre)]
        marks.append((0.0, 0.0, self._either(_ORIGIN)))
        marks += [(place.x, place.y, sign) for place, sign in _signs(known.places)]
        return {self._cell(x, y): sign for x, y, sign in marks if self._is_inside(x, y)}

    def _dot(self, x: float, y: float) -> tuple[int, int]:
        return round((x - self._bounds.left) * self._per_metre), round((self._bounds.top - y) * self._per_metre)

    def _cell(self, x: float, y: float) -> Cell:
        across, down = self._dot(x, y)
        return down // DOWN, across // ACROSS

    def _is_inside(self, x: float, y: float) -> bool:
        left, bottom, right, top = self._bounds
        return left <= x <= right and bottom <= y <= top

    def _either(self, signs: tuple[str, str]) -> str:
        return signs[not self._dots]

    def _beside(self, line: int) -> str:
        axes = self._either(_AXES)
        left, bottom, _, top = self._bounds
        figures = {self._cell(left, y)[0]: f"{y:g}" for y in _figures(bottom, top, self._step)}
        return f"{figures.get(line, ''):>{self._margin - 1}}{axes[line not in figures]}"

    def _below(self) -> Iterator[str]:
        axes = self._either(_AXES)
        left, bottom, right, _ = self._bounds
        columns = {self._cell(x, bottom)[1]: f"{x:g}" for x in _figures(left, right, self._step)}
        line = "".join(axes[3 if at in columns else 4] for at in range(self._width))
        yield f"{' ' * (self._margin - 1)}{axes[2]}{line}"
        figures = f"{'m':>{self._margin - 1}} "
        for column, figure in columns.items():
            begin = min(self._margin + column - len(figure) // 2, self._margin + self._width - len(figure))
            figures = f"{figures:<{max(begin, self._margin)}}{figure}"
        yield figures
        where = f"{self._either(_ORIGIN)} origin" if self._is_inside(0.0, 0.0) else "its origin is outside"
        yield f"{' ' * self._margin}{where}"


def legend(known: KnownPlaces, *, dots: bool) -> str:
    """Return the signs of places and no-go lines with their names, in one line. Empty: the plan has none."""
    parts = [f"{sign} {place.name}" for place, sign in _signs(known.places)]
    if known.no_go:
        parts.append(f"{_NO_GO[not dots]} no-go: {', '.join(line.name for line in known.no_go)}")
    text = printable("; ".join(parts))
    return text if dots else text.encode("ascii", "replace").decode()


def plan_and_words(plan: FloorPlan | None, pose: MapPose | None, words: str, style: str) -> RenderableType:
    """Return a floor plan, as large as the terminal takes it, above words in one style. None: the words alone."""
    told = Text(words, style)
    if plan is None:
        return told
    columns, lines = shutil.get_terminal_size()
    size = min(columns - 1, _LARGEST[0]), max(_WORDS, min(lines - _WORDS, _LARGEST[1]))
    return Group(_drawing(plan, *size, dots=takes_dots()).draw(pose, style), told)


_drawing = lru_cache(maxsize=4)(FloorDrawing)
"""The newest drawings: of one plan in few sizes of a terminal, or of one that grows."""


def _points(wall: Wall, per_metre: float) -> Iterator[tuple[float, float]]:
    """Points of a wall, two for each dot that it crosses."""
    x, y, end_x, end_y = wall
    steps = max(1, math.ceil(min(2.0 * per_metre * math.hypot(end_x - x, end_y - y), _MOST_STEPS)))
    for step in range(steps + 1):
        part = step / steps
        yield x + part * (end_x - x), y + part * (end_y - y)


def _signs(places: tuple[Place, ...]) -> Iterator[tuple[Place, str]]:
    """Yield each place with a letter that no other has: of its name if possible. After all letters: `*`."""
    free = dict.fromkeys(ascii_letters)
    for place in places:
        sign = next((each for each in (*place.name.lower(), *free) if each in free), "*")
        free.pop(sign, None)
        yield place, sign


def _figures(begin: float, end: float, step: float) -> Iterator[float]:
    """Multiples of a step from one value to another."""
    for number in range(math.ceil(begin / step - 1e-9), math.floor(end / step + 1e-9) + 1):
        yield round(number * step, 6) + 0.0  # never -0


def _ellipse(pose: MapPose) -> Iterator[tuple[float, float]]:
    """A circle, stretched by the lower triangle whose square is the covariance (Cholesky)."""
    xx, xy, _, yy, _, _ = pose.covariance
    along = math.sqrt(max(xx, 1e-12))
    across = math.sqrt(max(0.0, yy - (xy / along) ** 2))
    for number in range(_AROUND):
        angle = math.tau * number / _AROUND
        x, y = ELLIPSE_95 * math.cos(angle), ELLIPSE_95 * math.sin(angle)
        yield pose.x + along * x, pose.y + xy / along * x + across * y

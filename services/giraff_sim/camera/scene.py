"""What a simulated camera can see beside the room: floor, light, people who walk, and what it is calibrated by."""

import math
from typing import NamedTuple

from giraff_sim.camera.textures import Floor

Point3 = tuple[float, float, float]


class Shadow(NamedTuple):
    """A strip of shadow that sways over the floor, as of a curtain or a tree."""

    toward: float = 0.5
    """rad. Direction in which it moves; it lies across it."""
    middle: float = 2.5
    """m along that direction."""
    swing: float = 1.5
    """m, to either side."""
    period: float = 12.0
    """s."""
    half_width: float = 0.25
    """m."""
    light: float = 0.55
    """Share of the light that is left in it."""


class Walker(NamedTuple):
    """A person who walks to and fro between two places, m."""

    begin: tuple[float, float]
    end: tuple[float, float]
    speed: float = 0.8
    """m/s; 0: stands at `begin`."""

    def at(self, t: float) -> tuple[float, float, float, float]:
        """Return x, y, the direction of the way (rad) and the m walked, at a second."""
        length = math.dist(self.begin, self.end)
        walked = self.speed * t
        toward = math.atan2(self.end[1] - self.begin[1], self.end[0] - self.begin[0])
        if not (walked and length):
            return *self.begin, toward, 0.0
        part = walked / length % 2.0
        share = min(part, 2.0 - part)
        x, y = (b + (e - b) * share for b, e in zip(self.begin, self.end, strict=True))
        return x, y, toward, walked


class Board(NamedTuple):
    """A chessboard on white paper, held before everything else. It has a white margin of one square."""

    corner: Point3
    """m, in the room. Outer corner of its first square, which is black."""
    along: Point3
    """Unit vector along its rows."""
    down: Point3
    """Unit vector along its columns."""
    columns: int
    """Squares, not inner corners."""
    rows: int
    square: float
    """m."""


class Sheet(NamedTuple):
    """White paper flat on the floor; A4 unless it says otherwise. m."""

    x: float
    """Its middle."""
    y: float
    yaw: float = 0.0
    """rad. Direction of its longer side."""
    length: float = 0.297
    width: float = 0.210


class Lens(NamedTuple):
    """Dirt and hands on the lens. They stay in the picture wherever the robot goes."""

    specks: int = 0
    """Number of grains, of a radius up to 4 px in a picture of 320 px."""
    print: float = 0.0
    """Share of the light that the ridges of a thumb's print take."""
    covered: float = 0.0
    """Share of the picture, from its left side, that a hand covers."""


class Scene(NamedTuple):
    """All of it. The same scene, seed and calls give the same pictures."""

    floor: Floor = "planks"
    light: float = 1.0
    """1: as the colours are meant; less: darker."""
    switching: float = 0.0
    """s. Period in which half of the lamps go off and on again; 0: they stay on."""
    gradient: float = 0.12
    """Share by which one side of the room is lighter or darker than its middle."""
    noise: float = 2.5
    """Grey levels of 255, standard deviation."""
    exposure: float = 1.0 / 60.0
    """s."""
    shadow: Shadow | None = None
    people: tuple[Walker, ...] = ()
    board: Board | None = None
    sheet: Sheet | None = None
    lens: Lens = Lens()

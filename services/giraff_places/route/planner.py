"""Routes: which way the robot gets to a pose on its floor plan, or why it does not."""

import itertools
import math
from collections.abc import Iterable, Sequence
from typing import Final, Literal, NamedTuple

import numpy as np

from giraff_core.kinematics.pose import Pose
from giraff_maps.floor_plan import FloorPlan, Wall, require_area
from giraff_places.route.floor import SPOT, Floats, Floor
from giraff_places.route.legs import straighten
from giraff_places.route.search import Costs, cheapest, narrowest
from giraff_schemas.places import NoGoLine
from giraff_schemas.trouble import NO_TROUBLE, Trouble

NoWay = Literal["no_room", "no_way", "too_narrow", "forbidden"]
"""`no_room`: the robot cannot stand at the goal; `no_way`: walls all round; `too_narrow`: each way has a gap that is
narrower than the robot needs; `forbidden`: each way crosses a no-go line."""

_COMFORT: Final = 0.35
"""m beyond what the robot needs, within which a way costs more: it goes through the middle of doors."""
_PULL: Final = 1.0
"""Times that a metre costs more where the robot has just the room it needs."""
_TIGHT: Final = 8.0
"""Times that a metre costs more where a leg has less than that: it is `_ALONG` off the middle of a door."""
_ROUNDING: Final = 0.035
"""m by which a cell may lack what the robot needs: its best spot misses the best place in it by up to 0.018 m, and a
plan that was made by driving draws doors up to 0.04 m too narrow."""
_ALONG: Final = 0.04
"""m less than it needs that a leg may have between two spots."""
_BESIDE: Final = 0.05
"""m between footprint and wall that a place needs. The guard keeps as much beside the robot."""
_LEAVES: Final = 0.5
"""m around start and goal where the robot may have as little room as it has there."""
_LEAST: Final = 0.14
"""m of clearance without which no cell counts. The spots of two neighbours are 0.27 m apart at most, so that no wall
can be between them then."""
_IN_A_WALL: Final = Trouble(
    "the robot is in a wall or off the map, by where it is taken to be",
    "say where it is",
    "run",
    "giraff localize --at X,Y,YAW",
)


class Route(NamedTuple):
    """A way: straight legs, a turn on the spot before each, and one at the end."""

    corners: tuple[tuple[float, float], ...]
    """m, in `map`; from the start to the goal."""
    yaw: float
    """rad; heading at the goal."""
    room: float
    """m. Smallest clearance on it: half of its narrowest gap."""

    @property
    def length(self) -> float:
        """m."""
        return sum(math.dist(*ends) for ends in itertools.pairwise(self.corners))


class NoRoute(NamedTuple):
    """There is none."""

    reason: NoWay
    trouble: Trouble
    x: float
    """m, in `map`; of what is in the way."""
    y: float


class RoutePlanner:
    """Plans the routes of one robot on one floor plan."""

    def __init__(self, plan: FloorPlan, footprint_radius: float, passage_radius: float) -> None:
        """`passage_radius`: m; half of the narrowest gap that the guard lets the robot through.

        Raises MapError for a plan that is too large.
        """
        require_area(plan)
        self._plan = plan
        self._footprint = footprint_radius
        self._needs = passage_radius
        self.floor = Floor.of(plan, passage_radius + _COMFORT)
        """Floor of the plan alone."""

    def place_fault(self, x: float, y: float) -> Trouble:
        """Return why the robot cannot stand, and turn, at a place of `map`, m."""
        room, needs = self.floor.near(x, y), max(self._footprint + _BESIDE, _LEAST + SPOT)
        if room >= needs - SPOT:
            return NO_TROUBLE
        left, bottom, right, top = self._plan.bounds
        if not (left <= x <= right and bottom <= y <= top):
            extent = f"from ({left:.1f}, {bottom:.1f}) to ({right:.1f}, {top:.1f}) m"
            return Trouble(f"({x:g}, {y:g}) is off the map, which goes {extent}", "give a place on the plan")
        return Trouble(
            f"({x:g}, {y:g}) is about {room:.2f} m from a wall, and the robot needs {needs:.2f} m to turn there",
            "give a place with more room",
        )

    def route(
        self, start: Pose, goal: Pose, no_go: Sequence[NoGoLine] = (), things: Iterable[Wall] = ()
    ) -> Route | NoRoute:
        """Return the way from `start` to `goal`. `things`: what stands there now, and is not on the plan."""
        if trouble := self.place_fault(goal.x, goal.y):
            return NoRoute("no_room", trouble, goal.x, goal.y)
        lines = [(line.x, line.y, line.end_x, line.end_y) for line in no_go]
        open_floor = self.floor.with_walls(things) if things else self.floor
        if open_floor.near(start.x, start.y) < _LEAST:
            return NoRoute("no_way", _IN_A_WALL, start.x, start.y)
        floor = open_floor.with_walls(lines) if lines else open_floor
        for end, least in (start, _LEAST), (goal, self._footprint):
            if floor.near(end.x, end.y) < least <= open_floor.near(end.x, end.y):
                return _forbidden(((end.x, end.y), (end.x, end.y)), no_go)
        if (route := self._on(floor, start, goal)) is not None:
            return route
        if lines and (route := self._on(open_floor, start, goal)) is not None:
            return _forbidden(route.corners, no_go)
        return self._narrowest(floor, start, goal)

    def _on(self, floor: Floor, start: Pose, goal: Pose) -> Route | None:
        columns, rows = floor.middles()
        required = self._required(floor, (start, goal), columns[:, None], rows[None, :], _ROUNDING)
        weights = self._weights(floor.clearance, required)
        first, last = floor.cell(start.x, start.y), floor.cell(goal.x, goal.y)
        if (cells := cheapest(first, last, weights)) is None:
            return None
        points = floor.best_spots(np.array(cells))
        first_and_last = np.array([start[:2], goal[:2]], np.float32)
        points = np.concatenate([first_and_last[:1], points[1:-1], first_and_last[1:]])

        def weigh(x: Floats, y: Floats) -> Costs:
            return self._weights(floor.at(x, y), self._required(floor, (start, goal), x, y, _ALONG))

        corners = tuple((float(x), float(y)) for x, y in straighten(points, weigh))
        return Route(corners, goal.yaw, float(floor.at(*_along(corners)).min()))

    def _required(self, floor: Floor, ends: tuple[Pose, Pose], x: Floats, y: Floats, slack: float) -> Costs:
        """Return the clearance that each place must have, m. `slack`: m that it may lack elsewhere than at the ends."""
        required = np.full(np.broadcast_shapes(x.shape, y.shape), self._needs - slack)
        for end in ends:
            room = max(_LEAST, floor.near(end.x, end.y) - _ROUNDING)
            if room < self._needs - slack:
                there = np.hypot(x - end.x, y - end.y) <= _LEAVES
                required[there] = np.minimum(required[there], room)
        return required

    def _weights(self, clearance: Floats, required: Costs) -> Costs:
        """Return the cost of a metre where the clearance is so large."""
        lacks = np.clip((self._needs + _COMFORT - clearance) / _COMFORT, 0.0, 1.0)
        tight = np.clip((self._needs - clearance) / _ALONG, 0.0, 1.0)
        return np.where(clearance >= required, 1.0 + _PULL * lacks * lacks + _TIGHT * tight, np.inf)

    def _narrowest(self, floor: Floor, start: Pose, goal: Pose) -> NoRoute:
        """Tell the narrowest gap of the widest way."""
        clearance = floor.clearance.astype(np.float64)
        columns, rows = floor.middles()
        required = self._required(floor, (start, goal), columns[:, None], rows[None, :], _ROUNDING)
        room = np.where(clearance >= required, self._needs, clearance)
        room[clearance < _LEAST] = -np.inf
        first, last = floor.cell(start.x, start.y), floor.cell(goal.x, goal.y)
        if (gap := narrowest(first, last, room)) is None:
            trouble = Trouble("there are walls all round", "see the plan, and where the robot is on it")
            return NoRoute("no_way", trouble, goal.x, goal.y)
        ((x, y),) = floor.best_spots(np.array([gap]))
        trouble = Trouble(
            f"the widest way has a gap of {2.0 * clearance[gap]:.2f} m at ({x:.1f}, {y:.1f}), and the robot needs "
            f"{2.0 * self._needs:.2f} m",
            "make room there, or give another place",
        )
        return NoRoute("too_narrow", trouble, float(x), float(y))


def _forbidden(free: Sequence[tuple[float, float]], no_go: Sequence[NoGoLine]) -> NoRoute:
    """Name the line that is nearest to a way that would be free."""
    x, y = _along(free)
    distances = [_from(line, x, y) for line in no_go]
    nearest = min(range(len(no_go)), key=lambda each: float(distances[each].min()))
    spot = int(distances[nearest].argmin())
    there = f"({x[spot]:.1f}, {y[spot]:.1f})"
    trouble = Trouble(
        f"the no-go line {no_go[nearest].name} is in the way at {there}", "remove the line, or give another place"
    )
    return NoRoute("forbidden", trouble, float(x[spot]), float(y[spot]))


def _along(corners: Sequence[tuple[float, float]]) -> tuple[Floats, Floats]:
    """Return x and y of places along legs, a spot apart."""
    pieces = []
    for (x, y), (end_x, end_y) in itertools.pairwise(corners):
        count = int(math.dist((x, y), (end_x, end_y)) / SPOT) + 2
        pieces.append(np.linspace((x, y), (end_x, end_y), count, dtype=np.float32))
    x_and_y = np.concatenate(pieces)
    return x_and_y[:, 0], x_and_y[:, 1]


def _from(line: NoGoLine, x: Floats, y: Floats) -> Floats:
    """Return the distance of places from a line, m."""
    along_x, along_y = line.end_x - line.x, line.end_y - line.y
    squared = along_x * along_x + along_y * along_y
    part = np.clip(((x - line.x) * along_x + (y - line.y) * along_y) / squared, 0.0, 1.0)
    distances: Floats = np.hypot(x - line.x - part * along_x, y - line.y - part * along_y)
    return distances

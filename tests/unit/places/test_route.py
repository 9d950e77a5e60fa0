"""Routes on floor plans: never through a wall, through each door that is wide enough, and else the reason and where."""

import heapq
import itertools
import math
from collections.abc import Sequence
from typing import Final

import numpy as np
import numpy.typing as npt
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_maps.floor_plan import FloorPlan, Wall
from giraff_places.route.planner import NoRoute, Route, RoutePlanner
from giraff_schemas.places import NoGoLine
from tests.unit.places.plans import CELL, drawn

FOOTPRINT: Final = 0.30
NEEDS: Final = 0.42
"""m from its middle to either side of a gap."""
START, GOAL = Pose(1.0, 2.0, 0.0), Pose(5.0, 2.0, 1.0)
"""To the left and right of the middle wall."""
DOOR: Final = 2.0 * NEEDS + 0.02


def two_rooms(*doors: tuple[float, float]) -> FloorPlan:
    """Return rooms of 3 by 4 m with doors in the wall between them: y of the middle and width, m, upwards."""
    ends = [0.0, *(edge for y, width in doors for edge in (y - width / 2.0, y + width / 2.0)), 4.0]
    outer = ((0.0, 0.0, 6.0, 0.0), (6.0, 0.0, 6.0, 4.0), (6.0, 4.0, 0.0, 4.0), (0.0, 4.0, 0.0, 0.0))
    faces = [(x, low, x, high) for x in (2.95, 3.05) for low, high in zip(ends[::2], ends[1::2], strict=True)]
    jambs = [(2.95, y, 3.05, y) for y in ends[1:-1]]
    return FloorPlan("two rooms", (*outer, *faces, *jambs))


def planned(
    plan: FloorPlan, *lines: NoGoLine, start: Pose = START, goal: Pose = GOAL, things: Sequence[Wall] = ()
) -> Route | NoRoute:
    return RoutePlanner(plan, FOOTPRINT, NEEDS).route(start, goal, lines, things)


def line(name: str, x: float, y: float, end_x: float, end_y: float) -> NoGoLine:
    return NoGoLine(name=name, x=x, y=y, end_x=end_x, end_y=end_y)


def crossing(route: Route | NoRoute, x: float = 3.0) -> float:
    """Return the y, m, at which a route goes over a line of x."""
    assert isinstance(route, Route), route
    for (x0, y0), (x1, y1) in itertools.pairwise(route.corners):
        if min(x0, x1) <= x <= max(x0, x1):
            return y0 + (x - x0) / (x1 - x0) * (y1 - y0)
    raise AssertionError(route)


def test_it_goes_through_the_middle_of_a_door_that_is_just_wide_enough() -> None:
    for y in (0.6, 2.0, 3.37):
        route = planned(two_rooms((y, DOOR)))
        assert crossing(route) == pytest.approx(y, abs=0.05)
        assert isinstance(route, Route)
        assert route.room == pytest.approx(NEEDS, abs=0.04)
        assert (route.corners[0], route.corners[-1], route.yaw) == (START[:2], GOAL[:2], GOAL.yaw)


def test_a_door_that_is_too_narrow_is_no_way_and_its_place_and_width_are_told() -> None:
    none = planned(two_rooms((1.0, 0.5), (2.5, 2.0 * NEEDS - 0.10)))
    assert isinstance(none, NoRoute)
    assert none.reason == "too_narrow"
    assert math.dist((none.x, none.y), (3.0, 2.5)) < 0.15
    width = float(str(none.trouble).split("gap of ")[1].split()[0])
    assert width == pytest.approx(2.0 * NEEDS - 0.10, abs=0.05)


def test_no_route_crosses_a_no_go_line_and_where_all_would_its_name_is_told() -> None:
    plan = two_rooms((1.0, 1.0), (3.0, 1.0))
    shut = line("shut", 2.5, 0.3, 2.5, 1.7)
    assert crossing(planned(plan, start=Pose(1.0, 1.0, 0.0))) == pytest.approx(1.0, abs=0.1)
    assert crossing(planned(plan, shut, start=Pose(1.0, 1.0, 0.0))) == pytest.approx(3.0, abs=0.1)
    none = planned(plan, line("elsewhere", 0.2, 3.5, 0.5, 3.5), line("across", 2.0, 0.0, 2.0, 4.0))
    assert isinstance(none, NoRoute)
    assert (none.reason, "no-go line across" in str(none.trouble)) == ("forbidden", True)
    assert none.x == pytest.approx(2.0, abs=0.1)
    for start, goal in ((Pose(2.5, 1.0, 0.0), GOAL), (START, Pose(2.4, 1.0, 0.0))):  # on it, or to it
        on_it = planned(plan, shut, start=start, goal=goal)
        assert isinstance(on_it, NoRoute)
        assert on_it.reason == "forbidden"


def test_what_stands_in_a_door_now_sends_it_through_another() -> None:
    plan = two_rooms((1.0, 1.0), (3.0, 1.0))
    assert crossing(planned(plan, things=[(2.9, 0.9, 3.1, 1.1)], start=Pose(1.0, 1.0, 0.0))) == pytest.approx(
        3.0, abs=0.1
    )


@pytest.mark.parametrize(
    ("start", "goal", "reason", "told"),
    [
        (START, Pose(3.0, 0.5, 0.0), "no_room", "m from a wall, and the robot needs 0.35 m to turn there"),
        (START, Pose(9.0, 2.0, 0.0), "no_room", "off the map, which goes from (0.0, 0.0) to (6.0, 4.0) m"),
        (START, Pose(0.2, 2.0, 0.0), "no_room", "m from a wall, and the robot needs"),
        (Pose(3.0, 0.5, 0.0), GOAL, "no_way", "the robot is in a wall"),
        (Pose(-5.0, 0.5, 0.0), GOAL, "no_way", "or off the map"),
    ],
)
def test_ends_that_cannot_be_are_told(start: Pose, goal: Pose, reason: str, told: str) -> None:
    none = planned(two_rooms((2.0, 1.2)), start=start, goal=goal)
    assert isinstance(none, NoRoute)
    assert none.reason == reason
    assert told in str(none.trouble)


def test_a_room_without_a_door_has_no_way_in() -> None:
    none = planned(two_rooms())
    assert isinstance(none, NoRoute)
    assert (none.reason, str(none.trouble).split(";")[0]) == ("no_way", "there are walls all round")


def test_it_leaves_a_wall_and_goes_to_a_place_beside_one() -> None:
    route = planned(two_rooms((2.0, 1.2)), start=Pose(0.5, 0.32, 0.0), goal=Pose(5.6, 3.64, 0.0))
    assert isinstance(route, Route)
    assert route.room >= 0.30


def test_no_route_leaves_through_a_wall_or_a_line_that_it_stands_beside() -> None:
    """Start and goal are on the two sides of a slanted line across the room, and near it."""
    corners = [(0.0, 0.0, 4.0, 0.0), (4.0, 0.0, 4.0, 4.0), (4.0, 4.0, 0.0, 4.0), (0.0, 4.0, 0.0, 0.0)]
    for number in range(60):
        angle, far = 0.05 + number * 0.05, 0.05 + 0.01 * (number % 30)
        across, along = (math.sin(angle), -math.cos(angle)), (3.0 * math.cos(angle), 3.0 * math.sin(angle))
        wall = (2.0 - along[0], 2.0 - along[1], 2.0 + along[0], 2.0 + along[1])
        start, goal = (Pose(2.0 + side * across[0], 2.0 + side * across[1], 0.0) for side in (far, -far - 0.3))
        for footprint in (0.1, 0.3):
            walled = RoutePlanner(FloorPlan("halves", (*corners, wall)), footprint, footprint + 0.15)
            lined = RoutePlanner(FloorPlan("room", tuple(corners)), footprint, footprint + 0.15)
            assert isinstance(walled.route(start, goal), NoRoute), (number, footprint)
            assert isinstance(lined.route(start, goal, [line("across", *wall)]), NoRoute), (number, footprint)


def test_a_gap_beside_start_or_goal_is_too_narrow_as_any_other_is() -> None:
    for start, goal in ((START, Pose(3.4, 1.8, 0.0)), (Pose(2.6, 1.8, 0.0), GOAL), (START, Pose(3.5, 2.0, 0.0))):
        none = planned(two_rooms((2.0, 0.5)), start=start, goal=goal)
        assert isinstance(none, NoRoute)
        assert math.dist((none.x, none.y), (3.0, 2.0)) < 0.15
        assert "a gap of 0.4" in str(none.trouble) or "a gap of 0.5" in str(none.trouble)


def test_the_edge_of_an_open_plan_is_on_it_and_a_large_robot_fits_into_a_hall() -> None:
    plan = FloorPlan("posts", ((-0.3, -0.3, -0.3, -0.2), (12.6, 12.6, 12.6, 12.5)))
    for x, y in ((12.6, 6.0), (6.0, 12.6), (-0.3, 6.0), (6.0, -0.3)):
        assert not RoutePlanner(plan, 1.5, 1.65).place_fault(x, y)
    for x, y in ((12.61, 6.0), (6.0, -0.31)):
        assert "off the map" in str(RoutePlanner(plan, 1.5, 1.65).place_fault(x, y))


def test_a_goal_where_it_is_takes_no_way() -> None:
    route = planned(two_rooms((2.0, 1.2)), goal=START)
    assert isinstance(route, Route)
    assert route.length == 0.0


def test_drawn_plans_are_as_a_plain_search_has_them() -> None:
    """Dijkstra's algorithm on the corners of the cells, and distances to each occupied cell."""
    routes = 0
    for seed in range(8):
        plan, occupied, no_go, start, goal = drawn(seed, side=50)
        route = RoutePlanner(plan, FOOTPRINT, NEEDS).route(start, goal, no_go)
        clearance = _clearance(np.array(occupied), no_go)
        sure = _shortest(clearance >= NEEDS + 0.08, start, goal)
        if isinstance(route, NoRoute):
            assert sure is None, (seed, route)
            continue
        routes += 1
        assert _least(clearance, route) >= NEEDS - 0.10, seed
        if sure is not None:
            assert route.length <= 1.25 * sure, seed
    assert 2 <= routes <= 7


_NODE: Final = 0.1


def _clearance(occupied: npt.NDArray[np.bool_], no_go: Sequence[NoGoLine]) -> npt.NDArray[np.float64]:
    """Return m from each node to the nearest occupied cell or line."""
    count = round(len(occupied) * CELL / _NODE)
    x = np.arange(count)[:, None] * _NODE
    y = np.arange(count)[None, :] * _NODE
    clearance = np.full((count, count), np.inf)
    for column, row in np.argwhere(occupied):
        beside = np.maximum(np.maximum(column * CELL - x, x - (column + 1) * CELL), 0.0)
        above = np.maximum(np.maximum(row * CELL - y, y - (row + 1) * CELL), 0.0)
        clearance = np.minimum(clearance, np.hypot(beside, above))
    for each in no_go:
        for part in np.linspace(0.0, 1.0, 100):
            spot = each.x + part * (each.end_x - each.x), each.y + part * (each.end_y - each.y)
            clearance = np.minimum(clearance, np.hypot(x - spot[0], y - spot[1]))
    return clearance


def _shortest(is_open: npt.NDArray[np.bool_], start: Pose, goal: Pose) -> float | None:
    """Return m from one place to the other; None: there is no way."""
    first, last = ((round(end.x / _NODE), round(end.y / _NODE)) for end in (start, goal))
    done: set[tuple[int, int]] = set()
    heap = [(0.0, first)]
    while heap:
        way, node = heapq.heappop(heap)
        if node == last:
            return way
        if node in done:
            continue
        done.add(node)
        for right, up in itertools.product((-1, 0, 1), repeat=2):
            beside = node[0] + right, node[1] + up
            if is_open[beside] and beside not in done:
                heapq.heappush(heap, (way + math.hypot(right, up) * _NODE, beside))
    return None


def _least(clearance: npt.NDArray[np.float64], route: Route) -> float:
    """Return the smallest clearance of the nodes that are nearest to a route, m."""
    places = [
        (x + part * (end_x - x), y + part * (end_y - y))
        for (x, y), (end_x, end_y) in itertools.pairwise(route.corners)
        for part in np.linspace(0.0, 1.0, 100)
    ]
    return float(min(clearance[round(x / _NODE), round(y / _NODE)] for x, y in places))

"""A floor plan of simulated drives before a laser scanner, judged by the true walls and the true poses."""

import math
from collections.abc import Callable
from typing import Final, NamedTuple

import msgspec
import numpy as np
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_maps.floor_plan import Wall
from giraff_maps.scan.mapper import Mapper
from giraff_maps.scan.match import Cloud, Field, cloud_of
from giraff_maps.scan.occupancy import OCCUPIED
from giraff_maps.scan.plan import MadePlan, make_plan
from giraff_maps.scan.turns import Turn, Turns
from tests.support.scan_drives import SCANNER, PoseError, ScannedDrive, drive, pose_error, wall_error
from tests.support.scan_worlds import Floats, corridor, home

_MOUNT: Final = Pose(SCANNER.x, SCANNER.y, 0.0)
_HZ: Final = 5.0


class _Mapped(NamedTuple):
    mapper: Mapper
    plan: MadePlan
    error: PoseError


def _mapped(driven: ScannedDrive) -> _Mapped:
    mapper, turns, truth = Mapper(), Turns(SCANNER), list[Pose]()
    for scan, true in zip(driven.scans, driven.truth, strict=True):
        turn = turns.add(scan)
        if turn is not None and mapper.add(turn):
            truth.append(true)
    *_, plan = make_plan(mapper, _MOUNT)
    assert isinstance(plan, MadePlan)
    return _Mapped(mapper, plan, pose_error(truth, [key.pose.placed_in(plan.start) for key in mapper.keys]))


def _points(walls: tuple[Wall, ...]) -> Floats:
    """Return points each 5 cm along walls."""
    lines = []
    for x, y, end_x, end_y in walls:
        part = np.linspace(0.0, 1.0, math.ceil(math.hypot(end_x - x, end_y - y) / 0.05) + 1)[:, None]
        lines.append((1.0 - part) * (x, y) + part * (end_x, end_y))
    return np.concatenate(lines)


@pytest.mark.parametrize(("name", "length"), [("living_room", 20.0), ("twins", 55.0), ("flat", 72.0), ("ring", 105.0)])
def test_a_plan_lies_on_the_true_walls(name: str, length: float) -> None:
    world = home(name)
    driven = drive(world, 7, hz=_HZ)
    mapper, plan, error = _mapped(driven)
    assert error.mean < 0.012
    assert error.worst < 0.04
    grid = plan.grid
    cells = (np.argwhere(grid.state == OCCUPIED) + 0.5) * grid.cell + grid.low
    off = wall_error(world, cells, error.alignment)
    assert float(off.mean()) < 0.03
    assert float(np.quantile(off, 0.95)) < 0.055
    off = wall_error(world, _points(plan.walls), error.alignment)
    assert float(off.mean()) < 0.012
    assert float(np.quantile(off, 0.95)) < 0.03
    assert sum(math.dist(wall[:2], wall[2:]) for wall in plan.walls) > length
    assert plan.figures.missing == ()
    assert abs(mapper.scale / driven.forward_scale - 1.0) < 0.015
    along = [abs(math.sin(2.0 * math.atan2(y1 - y0, x1 - x0))) for x0, y0, x1, y1 in plan.walls[:5]]
    assert np.median(along) < 0.02


def _with_odometry(change: Callable[[Pose], tuple[float, float, float]], goals: int = 7) -> ScannedDrive:
    driven = _in_living_room(goals=goals)
    scans = [msgspec.structs.replace(scan, odom=change(Pose(*scan.odom or ()))) for scan in driven.scans]
    return driven._replace(scans=scans)


def _in_living_room(carried: bool = False, bias: float = 0.01, goals: int = 99) -> ScannedDrive:
    world = home("living_room")
    return drive(world, 3, hz=_HZ, carried=carried, bias=bias, route=world.goals[:goals])


def _upside_down() -> ScannedDrive:
    driven = _in_living_room(goals=7)
    return driven._replace(scans=[msgspec.structs.replace(scan, step=-scan.step) for scan in driven.scans])


def _into_another_home() -> ScannedDrive:
    """Odometry goes on as if the robot had stood while it was carried."""
    one, other = _in_living_room(), drive(home("flat"), 3, hz=_HZ, route=home("flat").goals[:4])
    half = len(one.scans) // 2
    here, there = Pose(*one.scans[half].odom or ()), Pose(*other.scans[0].odom or ())
    shift = [a - b for a, b in zip(here, there, strict=True)]
    moved = [
        msgspec.structs.replace(scan, odom=tuple(a + b for a, b in zip(scan.odom or (), shift, strict=True)))
        for scan in other.scans
    ]
    begin = one.scans[half].tick
    assert begin is not None
    later = [
        msgspec.structs.replace(
            scan, tick=msgspec.structs.replace(begin, robot_ns=begin.robot_ns + round(number / _HZ * 1e9))
        )
        for number, scan in enumerate(moved)
    ]
    return one._replace(scans=one.scans[:half] + later, truth=one.truth[:half] + other.truth)


_BAD: Final[dict[str, tuple[Callable[[], ScannedDrive], str]]] = {
    "one way only": (lambda: _in_living_room(goals=5), "no place was seen a second time"),
    "a smooth corridor": (
        lambda: drive(corridor(), 3, hz=_HZ, route=[(1.0, 0.8), (12.0, 0.8), (1.0, 0.8)]),
        "walls let the robot slide",
    ),
    "carried": (lambda: _in_living_room(carried=True), "nothing that the scanner saw fitted"),
    "into another home": (_into_another_home, "nothing that the scanner saw fitted"),
    "ranges 0.1 m too long or too short": (lambda: _in_living_room(bias=0.1), "does not fit"),
    "scanner the other way up": (_upside_down, "nothing that the scanner saw fitted"),
    "odometry turns the wrong way": (
        lambda: _with_odometry(lambda odom: (odom.x, -odom.y, -odom.yaw)),
        "nothing that the scanner saw fitted",
    ),
    "odometry drives backward": (
        lambda: _with_odometry(lambda odom: (-odom.x, -odom.y, odom.yaw), goals=99),
        "drawn twice",
    ),
    "odometry stands": (lambda: _with_odometry(lambda _: (1.0, 2.0, 0.5)), "only 0.0 m were driven"),
}


@pytest.mark.parametrize("kind", _BAD)
def test_a_bad_drive_makes_no_good_plan(kind: str) -> None:
    driven, cause = _BAD[kind]
    figures = _mapped(driven()).plan.figures
    assert any(cause in str(trouble) for trouble in figures.missing), figures


def _seen(angles: Floats, ranges: Floats, x: float) -> Turn:
    return Turn(cloud_of(angles, ranges).placed(_MOUNT), Pose(x, 0.0, 0.0), leapt=False)


def test_a_wall_far_to_one_side_makes_a_grid_that_holds_the_robots_way_too() -> None:
    mapper, angles = Mapper(), np.linspace(-0.3, 0.3, 60)
    for step in range(8):
        mapper.add(_seen(angles, 5.0 / np.cos(angles), -0.25 * step))
    *_, plan = make_plan(mapper, _MOUNT)
    assert isinstance(plan, MadePlan)
    low, size = plan.grid.low, np.array(plan.grid.state.shape) * plan.grid.cell
    assert all((low < (x, y)).all() and ((x, y) < low + size).all() for x, y in plan.way)


def test_a_first_turn_without_a_flat_wall_ends_no_drive() -> None:
    mapper, turns = Mapper(), Turns(SCANNER)
    bush = Cloud(np.random.default_rng(1).uniform(-3.0, 3.0, (90, 2)), np.zeros((90, 2)))
    mapper.add(Turn(bush, Pose(*_in_living_room(goals=5).scans[0].odom or ()), leapt=False))
    for scan in _in_living_room(goals=5).scans:
        if (turn := turns.add(scan)) is not None:
            mapper.add(turn)
    assert len(mapper.keys) >= 1


def test_a_field_is_no_larger_where_it_is_far_from_the_origin() -> None:
    angles = np.linspace(0.0, 6.28, 450)
    near, far = (Field([cloud_of(angles, np.full(450, 2.0)).placed((x, x, 0.0))]) for x in (0.0, 5000.0))
    sizes = [field.likelihood(0.1).shape for field in (near, far)]
    assert np.abs(np.subtract(*sizes)).max() <= 1

"""Turns of a scanner are where the walls are: at rest, on the move, and none where the motion is not known."""

import math
from array import array
from collections.abc import Callable, Sequence
from typing import Final

import msgspec
import numpy as np
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import LaserScanner
from giraff_maps.scan.match import points_of
from giraff_maps.scan.turns import FEWEST, Turn, Turns
from giraff_schemas.messages import RobotTime
from giraff_schemas.scan import NEAREST, NO_ECHO, OWN, RAYS, LaserScan, packed
from giraff_schemas.trouble import Trouble
from tests.support.scan_drives import SCANNER, Track, Unit, drive, pose_error, scanned, wall_error
from tests.support.scan_worlds import Floats, home

_HERE: Final = Pose(2.6, 2.4, 0.7)
"""In the living room."""


def exact(
    speed: float, turn: float, scanner: LaserScanner = SCANNER, hz: float = 10.0
) -> tuple[list[LaserScan], list[Pose]]:
    """Return the scans of a robot that drives an arc from `_HERE`, and its true poses: nothing errs."""
    times = np.arange(50) * 0.02
    yaw = _HERE.yaw + turn * times
    middle = _HERE.yaw + turn * times / 2.0
    chord = speed * times * np.sinc(turn * times / math.tau)
    true = np.stack([_HERE.x + chord * np.cos(middle), _HERE.y + chord * np.sin(middle), yaw], axis=1)
    found = scanned(home("living_room"), Track(true, true), Unit(1, scanner, exact=True), scanner, hz=hz)
    return found.scans, found.truth


def turned(scans: Sequence[LaserScan], scanner: LaserScanner = SCANNER) -> list[Turn | None]:
    turns = Turns(scanner)
    return [turns.add(scan) for scan in scans]


def off_the_walls(turn: Turn | None, robot: Pose) -> Floats:
    """Return m from each point to the nearest wall, the robot being there."""
    assert turn is not None
    return wall_error(home("living_room"), turn.cloud.points, robot)


def test_at_rest_all_points_lie_on_the_walls_whichever_way_up_the_scanner_hangs() -> None:
    clouds = []
    for scanner in (SCANNER, msgspec.structs.replace(SCANNER, upside_down=True)):
        scans, truth = exact(0.0, 0.0, scanner)
        _, turn, *_ = turned(scans, scanner)
        assert turn is not None
        assert scans[0].step * (1.0 if scanner.upside_down else -1.0) > 0.0
        assert len(turn.cloud.points) > RAYS - 10
        assert off_the_walls(turn, truth[1]).max() < 0.002
        clouds.append(turn.cloud)
    assert (clouds[0].normals != 0.0).any(axis=1).mean() > 0.6
    upright, hanging = (cloud.points[np.argsort(np.arctan2(*(cloud.points - (SCANNER.x, 0.0)).T))] for cloud in clouds)
    assert np.abs(upright - hanging).max() < 0.001


def test_points_beyond_the_reach_do_not_count() -> None:
    scans, _ = exact(0.0, 0.0)
    _, turn, *_ = turned(scans, msgspec.structs.replace(SCANNER, reach=2.0))
    assert turn is not None
    assert len(turn.cloud.points) > FEWEST
    assert 1.8 < np.hypot(*(turn.cloud.points - (SCANNER.x, 0.0)).T).max() <= 2.0


def test_what_may_be_the_robots_own_does_not_count_where_nobody_has_looked_for_it() -> None:
    scans, _ = exact(0.0, 0.0)
    near = [replace(scan, ranges=seen(scan, 100, 400)) for scan in scans]
    turns = [turned(near, replace(SCANNER, own=own))[1] for own in ((), None)]
    counts = [len(turn.cloud.points) for turn in turns if turn is not None]
    assert counts[0] - counts[1] == RAYS - 100


@pytest.mark.parametrize(("every", "hz"), [(1, 10.0), (2, 12.5)])
def test_the_motion_within_a_turn_is_taken_out(every: int, hz: float) -> None:
    all_scans, poses = exact(0.4, 1.2, hz=hz)
    scans, truth = all_scans[::every], poses[::every]
    for number, turn in enumerate(turned(scans)[1:], 1):
        assert turn is not None
        assert off_the_walls(turn, truth[number]).max() < 0.015
        assert turn.odom == pytest.approx(truth[number], abs=1e-6)
    scan = scans[-1]
    ranges, angles = np.array(scan.rays(), float) / 1000.0, scan.bearing + scan.step * np.arange(RAYS, dtype=float)
    as_if_at_rest = np.add(points_of(angles, ranges), (SCANNER.x, 0.0))
    assert np.quantile(wall_error(home("living_room"), as_if_at_rest, truth[-1]), 0.9) > 0.05


def moved(robot: tuple[float, float, float] | None, x: float) -> tuple[float, float, float]:
    assert robot is not None
    return robot[0] + x, robot[1], robot[2]


def later(tick: RobotTime | None, seconds: float, epoch: int = 1) -> RobotTime:
    assert tick is not None
    return RobotTime(epoch, tick.robot_ns + round(seconds * 1e9))


def seen(scan: LaserScan, number: int, other: int) -> bytes:
    """Return rays of which so many have an echo; of the others there is `other`."""
    return packed(array("H", [*scan.rays()[:number], *[other] * (RAYS - number)]))


replace: Final = msgspec.structs.replace


def restarted(scan: LaserScan) -> LaserScan:
    """Return a sample of after another start of base; the first one of them has no pose."""
    return replace(scan, tick=later(scan.tick, 0.0, 2), odom=None if scan.seq == 2 else scan.odom)


CHANGES: Final[dict[str, tuple[str, Callable[[LaserScan], LaserScan], bool]]] = {
    "nothing": ("-tttt", lambda scan: scan, True),
    "a gap": ("-t-tt", lambda scan: replace(scan, tick=later(scan.tick, 0.5)), True),
    "a leap of odometry": ("-t-lt", lambda scan: replace(scan, odom=moved(scan.odom, 0.5)), True),
    "another start of base": ("-t-lt", lambda scan: replace(scan, tick=later(scan.tick, 0.0, 2)), True),
    "a clock that was set back": ("-t-lt", lambda scan: replace(scan, tick=later(scan.tick, -0.11)), True),
    "a turn that failed": ("-tt-t", lambda scan: replace(scan, trouble=Trouble("its motor is held", "free it")), False),
    "a pose not known": ("-t-tt", lambda scan: replace(scan, odom=None), False),
    "a time not known": ("-t-tt", lambda scan: replace(scan, tick=None), False),
    "a pose not known before another start": ("-t--l", restarted, True),
    "few echoes": ("-tt-t", lambda scan: replace(scan, ranges=seen(scan, FEWEST - 1, NO_ECHO)), False),
    "enough echoes": ("-tttt", lambda scan: replace(scan, ranges=seen(scan, FEWEST, NO_ECHO)), False),
    "the robot's own parts": ("-tt-t", lambda scan: replace(scan, ranges=seen(scan, FEWEST - 1, OWN + 900)), False),
    "dirt": ("-tt-t", lambda scan: replace(scan, ranges=seen(scan, FEWEST - 1, NEAREST - 1)), False),
}
"""Turns that come of five scans at rest, the third one changed, or all from the third on: `l` is one that leapt."""


@pytest.mark.parametrize("name", CHANGES)
def test_no_turn_comes_where_its_motion_is_not_known(name: str) -> None:
    told, change, stays = CHANGES[name]
    scans, _ = exact(0.0, 0.0)
    changed = [change(scan) if number == 2 or (stays and number > 2) else scan for number, scan in enumerate(scans[:5])]
    assert "".join("-" if turn is None else "tl"[turn.leapt] for turn in turned(changed)) == told


def test_a_drive_whose_scanner_and_odometry_err_shows_the_walls_from_its_true_poses() -> None:
    found = drive(home("living_room"), 1, hz=5.0, route=[(1.5, 2.2), (1.5, 1.4), (3.0, 1.4), (4.65, 1.2), (3.6, 2.9)])
    turns = turned(found.scans)
    off = np.concatenate([off_the_walls(turn, found.truth[number]) for number, turn in enumerate(turns) if turn])
    assert len(turns) - 1 == sum(turn is not None for turn in turns)
    assert (np.median(off) < 0.015, np.quantile(off, 0.95) < 0.04) == (True, True), np.quantile(off, [0.5, 0.95])
    odom = [Pose(*scan.odom) for scan in found.scans if scan.odom]
    assert math.dist(odom[-1][:2], found.truth[-1][:2]) > 0.2
    assert pose_error(found.truth, odom).worst > 0.1


def test_poses_that_are_only_given_in_another_frame_have_no_error() -> None:
    truth = [Pose(math.cos(part), 2.0 * math.sin(part), part) for part in (0.0, 0.5, 1.2, 2.0)]
    frame = Pose(3.0, -1.0, 2.2)
    error = pose_error(truth, [pose.seen_from(frame) for pose in truth])
    assert (error.mean, error.worst) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert error.alignment == pytest.approx(frame, abs=1e-9)

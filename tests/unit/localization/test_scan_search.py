"""A robot with a laser scanner: found by its scans, and never in a wrong place."""

import copy
import math
import statistics
from array import array
from functools import cache
from itertools import pairwise
from typing import Any, Final

import msgspec
import numpy as np
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_localization.policy import LocalizationPolicy
from giraff_maps.floor_plan import FloorPlan
from giraff_maps.room_file import Point
from giraff_maps.scan.plan_walls import PlanWalls
from giraff_schemas.codec import encode
from giraff_schemas.localization import LocalizationGlobal, LocalizationSetPose, LocalizationState
from giraff_schemas.messages import RobotTime
from giraff_schemas.scan import NO_ECHO, RAYS, packed
from giraff_schemas.trouble import Trouble
from tests.support.scan_drives import SCANNER, Unit, scanned
from tests.support.scan_drives import driven as way_of
from tests.support.scan_worlds import home
from tests.unit.localization.rooms import ROOM, outline
from tests.unit.localization.scanned import FLAT, SCANNED, Follower, Said, built, driven, moved, scanned_floor

FOUND: Final = 50
"""Scans of the drive through the flat after which it is known where the robot is."""
_TWIN: Final = ((1.0, 2.6), (1.0, 1.4), (2.4, 1.4), (2.65, 3.2), (2.65, 5.3), (1.1, 5.3), (3.5, 5.3))
"""Round one of two equal rooms, and out of it."""
_KITCHEN: Final = ((6.1, 1.6), (7.4, 1.6), (7.2, 2.4), (5.9, 2.4))
_TURNED: Final = ((-1.2, 0.5), (-1.3, -0.9), (-1.5, 1.2), (-2.55, 1.6), (-3.2, 0.4))
_CELL: Final = FloorPlan("cell", outline((0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0)))


def told(policy: LocalizationPolicy, pose: Pose, sd: float = 0.3, id_: int = 1) -> None:
    answer = policy.on_set_pose(
        LocalizationSetPose(by="test", id=id_, x=pose.x, y=pose.y, yaw=pose.yaw, position_sd=sd, yaw_sd=sd)
    )
    assert answer.done, answer.reason


def states(said: list[Said]) -> set[LocalizationState]:
    return {each.pose.state for each in said}


@cache
def _found() -> tuple[Follower, list[Said]]:
    follower = Follower(scanned_floor("flat"))
    return follower, follower.follow(driven("flat", FLAT), 0, FOUND)


@pytest.fixture
def found() -> Follower:
    """One that knows where the robot is, after `FOUND` scans of the drive through the flat."""
    floor = scanned_floor("flat")
    return copy.deepcopy(_found()[0], {id(floor): floor, id(floor.walls): floor.walls})


def test_it_is_found_after_a_metre_and_right(found: Follower) -> None:
    said = _found()[1] + found.follow(driven("flat", FLAT), FOUND)
    known = [each for each in said if each.pose.state == "localized"]
    assert known[0].way <= 1.2
    assert len(known) == len(said) - said.index(known[0]), "and is not lost again"
    assert statistics.median(each.error for each in known) < 0.1
    assert max(each.error for each in known) < 0.15
    assert [each.has_transform for each in said] == [each.pose.state == "localized" for each in said]
    last = known[-1].pose
    assert last.explained > 0.9
    assert all(sd >= least for sd, least in zip(last.standard_deviations, (0.01, 0.01, math.radians(0.3)), strict=True))
    assert max(last.standard_deviations) < 0.05
    assert (last.way, last.candidates, last.particles, bool(last.reason)) == (0.0, (), 1, False)
    assert type(last.explained) is float
    assert encode(last)


def test_in_one_of_two_equal_rooms_it_is_ambiguous_until_it_leaves() -> None:
    said = Follower(scanned_floor("twins")).follow(driven("twins", _TWIN))
    inside = [each for each in said[2:] if each.true.y < 3.4]
    assert states(inside) == {"ambiguous"}
    assert all(each.is_listed for each in inside)
    assert said[-1].pose.state == "localized"
    assert all(each.error < 0.15 for each in said if each.pose.state == "localized")


def test_a_home_that_is_the_same_after_half_a_turn_is_ambiguous_all_the_way() -> None:
    said = Follower(scanned_floor("turned")).follow(driven("turned", _TURNED))[2:]
    assert states(said) == {"ambiguous"}
    assert all(each.is_listed and len(each.pose.candidates) == 2 for each in said)
    assert sum(each.belief for each in said[-1].pose.candidates) == pytest.approx(1.0)
    assert "places fit" in str(said[-1].pose.reason)


def test_a_robot_that_was_carried_away_is_missed_within_half_a_metre_and_found_anew() -> None:
    drive = driven("flat", FLAT[:4], carried=True)
    steps = [math.dist(one[:2], other[:2]) for one, other in pairwise(drive.truth)]
    lifted = steps.index(max(steps))
    said = Follower(scanned_floor("flat")).follow(drive)
    assert said[lifted].pose.state == "localized"
    after = said[lifted + 1 :]
    lost = next(each for each in after if each.pose.state != "localized")
    assert lost.way - after[0].way < 0.5
    assert not lost.has_transform
    again = after[after.index(lost) :]
    assert again[-1].pose.state == "localized"
    assert all(each.error < 0.15 for each in again if each.pose.state == "localized")


def test_a_plan_of_another_home_fits_badly() -> None:
    said = Follower(built(_CELL)).follow(driven("flat", FLAT), 0, 80)
    assert "localized" not in states(said)
    badly = [each for each in said if "fits this plan badly" in str(each.pose.reason)]
    assert badly
    assert all(each.pose.state == "lost" and each.pose.explained < 0.5 and each.pose.way > 2.0 for each in badly)
    assert "giraff map make --onto" in str(badly[0].pose.reason)


def test_a_place_that_was_told_is_found_about_there_and_confirmed() -> None:
    drive = driven("turned", _TURNED)
    follower = Follower(scanned_floor("turned"))
    follower.follow(drive, 0, 1)
    told(follower.policy, Pose(drive.truth[0].x + 0.2, drive.truth[0].y - 0.2, drive.truth[0].yaw + 0.15))
    assert follower.policy.pose().state == "told"
    assert follower.policy.pose().standard_deviations == pytest.approx((0.3, 0.3, 0.3))
    said = follower.follow(drive, 1, 80)
    assert said[2].error < 0.1, "before it has moved"
    assert states(said) == {"told", "localized"}
    first = next(each for each in said if each.pose.state == "localized")
    assert 0.6 < first.way <= 1.2
    assert all(each.error < 0.15 for each in said[2:])


@pytest.mark.parametrize(
    ("route", "wrong"),
    [(FLAT, Pose(0.0, 0.0, 2.0)), (_KITCHEN, Pose(3.9, 0.0, 0.0))],
    ids=["explains little", "is a room that is much alike"],
)
def test_a_wrong_place_that_was_told_is_contradicted(route: tuple[Point, ...], wrong: Pose) -> None:
    drive = driven("flat", route)
    follower = Follower(scanned_floor("flat"))
    follower.follow(drive, 0, 1)
    told(follower.policy, Pose(*(one + other for one, other in zip(drive.truth[0], wrong, strict=True))), 0.0)
    said = follower.follow(drive, 1, 60)
    assert "told" not in states([each for each in said if each.way > 0.9])
    assert "lost" in states(said), "it is looked for anywhere then"
    assert all(each.error < 0.15 for each in said if each.pose.state == "localized")


def test_who_is_unsure_by_metres_has_told_no_place() -> None:
    follower = Follower(scanned_floor("turned"))
    drive = driven("turned", _TURNED)
    follower.follow(drive, 0, 1)
    told(follower.policy, drive.truth[0], 1.0)
    assert follower.policy.pose().state == "lost"
    said = follower.follow(drive, 1, 60)
    assert states(said[2:]) <= {"lost", "ambiguous"}
    assert all(each.is_listed for each in said[2:])


def test_it_looks_anywhere_when_asked(found: Follower) -> None:
    assert found.policy.on_global(LocalizationGlobal(by="test", id=5)).done
    assert (found.policy.pose().state, found.policy.transform(), found.policy.pose().particles) == ("lost", None, 0)
    found.parts = 0
    said = found.follow(driven("flat", FLAT), FOUND, FOUND + 50)
    assert said[-1].pose.state == "localized"
    assert said[-1].error < 0.1
    assert found.parts > 80, "each place that is matched is a part of its own"


def test_a_scanner_that_is_silent_for_metres_leaves_nothing_known(found: Follower) -> None:
    drive = driven("flat", FLAT)
    states = []
    for scan in drive.scans[FOUND:]:
        found.policy.on_odometry(moved(scan))
        found.work()
        states.append(found.policy.pose().state)
    assert states[10] == "localized"
    assert states[-1] == "lost"
    assert "giraff_scan" in str(found.policy.pose().reason)
    assert found.policy.transform() is None


@pytest.mark.parametrize("change", ["no echo", "fault", "another scanner", "another epoch", "no tick"])
def test_a_scan_that_says_nothing_counts_for_nothing(found: Follower, change: str) -> None:
    changes: dict[str, dict[str, Any]] = {
        "no echo": {"ranges": packed(array("H", [NO_ECHO] * RAYS))},
        "fault": {"trouble": Trouble("its motor is held")},
        "another scanner": {"sensor": "top"},
        "another epoch": {"tick": RobotTime(epoch=99, robot_ns=1)},
        "no tick": {"tick": None},
    }
    before = found.policy.pose()
    for scan in driven("flat", FLAT).scans[FOUND : FOUND + 10]:
        found.policy.on_odometry(moved(scan))
        found.policy.on_sample(msgspec.structs.replace(scan, **changes[change]))
        found.work()
    after = found.policy.pose()
    assert (after.state, after.explained, after.covariance) == (before.state, before.explained, before.covariance)


def test_a_pose_that_was_set_in_odom_moves_the_frame_and_not_the_robot(found: Follower) -> None:
    drive = driven("flat", FLAT)
    for scan, true in list(zip(drive.scans, drive.truth, strict=True))[FOUND:]:
        assert scan.odom is not None
        x, y, yaw = Pose(*scan.odom).placed_in(Pose(40.0, -7.0, 2.0))
        leapt = msgspec.structs.replace(scan, odom=(x, y, math.remainder(yaw, math.tau)))
        found.policy.on_odometry(moved(leapt, jumps=1))
        found.policy.on_sample(leapt)
        found.work()
        said = found.policy.pose()
        assert said.state == "localized"
        assert math.dist((said.x, said.y), true[:2]) < 0.15


def test_a_robot_that_stops_is_matched_once_more_where_it_stands(found: Follower) -> None:
    drive = driven("flat", FLAT)
    stopped = FOUND
    while off(found) < 0.03:
        found.follow(drive, stopped, stopped + 1)
        stopped += 1
    stopped -= 1
    scan = drive.scans[stopped]
    assert scan.tick is not None
    for tenths in (1, 2, 3, 4):
        tick = RobotTime(scan.tick.epoch, scan.tick.robot_ns + tenths * 100_000_000)
        found.follow(drive._replace(scans=[msgspec.structs.replace(scan, tick=tick)], truth=[drive.truth[stopped]]))
    assert off(found) < 0.02


def off(found: Follower) -> float:
    """Return m from the newest update."""
    search = found.policy._search
    assert search is not None
    return math.dist(search.updated_at[:2], found.policy._track.pose[:2])


def test_odometry_that_was_gone_for_long_leaves_nothing_known(found: Follower) -> None:
    scan = driven("flat", FLAT).scans[FOUND]
    assert scan.tick is not None
    late = msgspec.structs.replace(scan, tick=RobotTime(scan.tick.epoch, scan.tick.robot_ns + 10**10))
    found.policy.on_odometry(moved(late, instance="two"))
    found.work()
    assert (found.policy.pose().state, found.policy.transform()) == ("lost", None)


def test_a_scanner_may_hang_upside_down() -> None:
    hangs = msgspec.structs.replace(SCANNER, upside_down=True)
    drive = scanned(home("flat"), way_of(home("flat"), 1, route=FLAT[:2]), Unit(1, hangs), hangs)
    follower = Follower(scanned_floor("flat"), msgspec.structs.replace(SCANNED, sensors={"laser": hangs}))
    said = follower.follow(drive)
    assert said[-1].pose.state == "localized"
    assert said[-1].error < 0.1


def test_a_wall_of_one_line_has_two_faces_and_one_of_two_lines_has_outer_ones() -> None:
    thick = outline((2.0, 1.0), (2.1, 1.0), (2.1, 2.0), (2.0, 2.0))
    walls = PlanWalls(FloorPlan("room", (*ROOM.walls, *thick)))
    assert list(walls.build())[-1] == 1.0

    def met(x: float, y: float, normal: tuple[float, float]) -> list[float] | None:
        [at], [found], [known] = walls.alike(np.array([(x, y)]), np.array([normal]))
        assert not known or tuple(found) == pytest.approx(normal, abs=1e-9)
        return at.round(3).tolist() if known else None

    assert met(0.05, 1.5, (1.0, 0.0)) == pytest.approx([0.0, 1.5], abs=0.03)
    assert met(0.05, 1.5, (-1.0, 0.0)) == pytest.approx([0.0, 1.5], abs=0.03), "it is drawn as one line"
    assert met(2.08, 1.5, (-1.0, 0.0)) == pytest.approx([2.0, 1.5], abs=0.03), "not the nearer line's inner face"
    assert met(2.08, 1.5, (1.0, 0.0)) == pytest.approx([2.1, 1.5], abs=0.03)
    assert met(2.5, 1.5, (1.0, 0.0)) is None
    assert walls.explained(np.array([(0.1, 1.5), (0.2, 1.5), (2.05, 1.5), (1.0, 1.5)])) == 0.5

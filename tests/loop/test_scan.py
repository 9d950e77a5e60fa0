"""A robot with a laser scanner keeps from what stands about it, and stops or creeps by a fault of it."""

import math
from typing import Final

import pytest

from giraff_core.senses import Sense
from giraff_schemas.scan import NO_ECHO, OWN, RAYS, LaserScan
from giraff_sim.world.room import Pose, Room
from giraff_sim.world.sonar import SonarFault
from tests.loop.loops import FULL_TILT, SETTINGS, hold
from tests.loop.scan_faults import BOUND, CREEP, FAULTS, react
from tests.loop.scanning import Scanned, drive_at_post, drive_wildly, scanned, touches
from tests.support.robots import ROBOT, ULTRASONIC

MARGIN: Final = SETTINGS.guard.margin
SONARS: Final[dict[str, Sense]] = {**ULTRASONIC}
_SLACK_NS: Final = 15_000_000
"""What a turn may be wrong about when its rays were measured."""


def hall(ahead: float, behind: float) -> Room:
    """Walls so far from the robot's middle, and two at its sides."""
    room = Room("hall", Pose(0.0, 0.0, 0.0))
    room.add_wall("walls", [(ahead, 1.5), (-behind, 1.5), (-behind, -1.5), (ahead, -1.5)], closed=True)
    return room


def drive_straight(robot: Scanned, x: float, seconds: float) -> float:
    """Hold the joystick like that; return the highest speed, m/s. Nothing may be touched."""
    hold(robot.loop, x)
    fastest = 0.0
    for _ in range(round(seconds / 0.1)):
        assert not [*touches(robot, 0.1)]
        fastest = max(fastest, abs(robot.plant.speed))
    return fastest


def reason(robot: Scanned, sign: float = 1.0) -> str:
    """Return why the robot may drive no faster forward, or backward."""
    guard = robot.loop.newest["guard"]
    return str((guard.forward if sign > 0.0 else guard.backward).reason)


def test_it_reaches_full_speed_and_stops_at_the_margin_before_a_wall_both_ways() -> None:
    with scanned(hall(ahead=1.35, behind=0.9)) as robot:
        for sign, seconds in ((1.0, 2.4), (-1.0, 3.0)):
            assert drive_straight(robot, sign * FULL_TILT, seconds) > 0.97 * ROBOT.max_wheel_speed
            assert MARGIN - 0.03 <= robot.plant.clearance < MARGIN + 0.1
            assert reason(robot, sign).startswith("laser sees something")
            assert abs(robot.plant.speed) < 0.1


def test_the_stricter_of_scan_and_sonars_holds() -> None:
    with scanned(hall(ahead=0.9, behind=2.0), sensors=SONARS) as robot:
        for sonar in robot.loop.simulation.world.sonars.values():
            sonar.fault = SonarFault.DEAF
        drive_straight(robot, FULL_TILT, 1.9)
        assert MARGIN - 0.03 <= robot.plant.clearance < MARGIN + 0.1
        assert reason(robot).startswith("laser")
    room = hall(ahead=3.0, behind=2.0)
    room.add_wall("board", [(0.5, -0.4), (0.5, 0.4)])
    with scanned(room, sensors=SONARS) as robot:
        for sonar in robot.loop.simulation.world.sonars.values():
            sonar.fault = SonarFault.FROZEN
        room.remove("board")
        drive_straight(robot, FULL_TILT, 0.6)
        assert min(ahead(robot.turns[-1])) > 2.8
        assert reason(robot).startswith("front")
        assert robot.plant.pose.x == 0.0


def test_nothing_that_was_measured_before_a_standstill_of_the_service_counts_after_it() -> None:
    room = hall(ahead=2.5, behind=2.5)
    with scanned(room) as robot:
        loop, plant, process = robot.loop, robot.plant, robot.loop.processes["scan"]
        for sign, stops_s in ((1.0, 0.1), (-1.0, 0.3), (1.0, 2.0)):
            drive_straight(robot, sign * FULL_TILT, 0.9)
            assert abs(robot.plant.speed) > 0.3
            if "door" in room.names:
                room.remove("door")
                drive_straight(robot, sign * FULL_TILT, 0.2)
            begun_ns, said, process.paused = loop.robot_ns, len(robot.turns), True
            room.add_wall("door", [(plant.pose.x + sign * 1.0, -0.6), (plant.pose.x + sign * 1.0, 0.6)])
            assert not [*touches(robot, stops_s)]
            process.paused = False
            process.go_on()
            drive_straight(robot, sign * FULL_TILT, 0.8)
            assert reason(robot, sign).startswith("laser sees something")
            turns = robot.turns[said:]
            assert len(turns) > 3
            told = [each for turn in turns for each in ahead(turn, sign, since_ns=begun_ns + _SLACK_NS)]
            assert max(told) < 1.1
            assert len(told) > 50


def ahead(turn: LaserScan, sign: float = 1.0, since_ns: int = 0) -> list[float]:
    """Return m of the rays about the way that is driven, if they say that they were measured after `since_ns`."""
    begun_ns = 0 if turn.tick is None else turn.tick.robot_ns + round(turn.since_tick * 1e9)
    return [
        mm / 1000
        for ray, mm in enumerate(turn.rays())
        if NO_ECHO < mm < OWN
        and sign * math.cos(turn.bearing + ray * turn.step) > 0.96
        and begun_ns + round(turn.duration * 1e9 * ray / RAYS) > since_ns
    ]


@pytest.mark.parametrize("seed", [0, 3])
def test_a_thin_post_in_the_way_is_not_touched(seed: int) -> None:
    drive = drive_at_post(seed, 2.2, farthest=1.2)
    assert not drive.is_hard
    assert drive.nearest < 0.4


@pytest.mark.parametrize("seed", [1, 2])
def test_a_wild_drive_touches_no_furniture(seed: int) -> None:
    drive = drive_wildly(seed, 4.0)
    assert not drive.is_hard
    assert drive.way > 0.5


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_of_the_scanner_stops_the_robot_or_slows_it(name: str) -> None:
    reaction = react(name, seed=1, after=0.5)
    assert reaction.steady > CREEP, "it was slow before"
    assert reaction.blind == 0
    assert reaction.seconds <= BOUND

"""Doctor, why and watch go by the robot that is there: one without ultrasonic sensors, one with a slower board."""

from typing import Final

import msgspec
import pytest

from giraff_cli.doctor.findings import findings
from giraff_cli.doctor.robot import CountedTelemetry, rates_of
from giraff_cli.watch.screen import missing
from giraff_core.senses import Bumper, LaserScanner
from giraff_schemas import topics
from giraff_schemas.messages import GuardState, SensorState
from tests.unit.cli.samples import (
    BUMPERS,
    MS,
    Network,
    base,
    bump,
    guard,
    odometry,
    reading,
    verdict,
    wheels,
    with_bumpers,
)
from tests.unit.cli.scenes import HAND, Scene, blocked, command
from tests.unit.cli.test_findings import HEALTHY, ROBOT

STOCK: Final = guard(verdict())
BLIND: Final = msgspec.structs.replace(STOCK, sensors={})
BUMPED: Final = msgspec.structs.replace(BLIND, sensors={"front": SensorState(type=Bumper.type_name())})
SCANNED: Final = msgspec.structs.replace(BLIND, sensors={"laser": SensorState(type=LaserScanner.type_name())})
FULL: Final = with_bumpers(verdict())
ALL: Final = ("range/front_left", "range/front_right", "range/rear", "bumper/front", "bumper/back")
OLD_BOARD: Final = "the ranger board tells nothing of bumpers; flash it"
MISSED: Final = "giraff_ranger is not running, or hangs: the robot is blind, and guard stops it"
NO_SCAN: Final = "giraff_scan is not running, or hangs: the robot does not see all round, and guard stops it"


def silent(*keys: str) -> list[str]:
    return [f"{key} is silent, though giraff_ranger says it is well" for key in keys]


def ranger_link(chain: Scene) -> tuple[str, str]:
    return next((link.status, link.text) for link in chain.diagnosis().links if link.name == "ranger")


def examined(
    sensors: GuardState, report_ms: int, told_ms: int, *, ranger: bool, heard: tuple[str, ...] = ()
) -> tuple[list[str], bool]:
    """Return what doctor finds in 1.5 s of a robot, and whether watch misses the ranger.

    `heard`: names of the sensors that say something.
    """
    listener, board = CountedTelemetry(), msgspec.structs.replace(base().board, report_ms=told_ms)
    network, services = Network(listener), ROBOT.services | {"ranger": int(ranger)}
    for service in ("ranger",) if ranger else ():
        listener.on_liveliness(service, "r", present=True)
    for now in range(0, 1500 * MS, report_ms * MS):
        network.send(topics.WHEELS, wheels(now), now)
        network.send(topics.ODOM, odometry(now, 0.0), now)
        network.send(topics.BASE, msgspec.structs.replace(base(), board=board), now)
        network.send(topics.GUARD, sensors, now)
        for name in heard:
            topic, sample = (topics.BUMPER, bump(name)) if name in BUMPERS else (topics.RANGE, reading(name, 1.0))
            network.send(topic, sample, now, name=name)
    seen = listener.snapshot(1500 * MS)
    answers = tuple(each for each in ROBOT.answers if ranger or each.health.service != "ranger")
    rates = tuple(each for each in rates_of(listener, seen) if each.key in ("wheels", "odom", *ALL))
    robot = msgspec.structs.replace(ROBOT, services=services, answers=answers, unused=seen.unused, rates=rates)
    found = findings(msgspec.structs.replace(HEALTHY, robot=robot))
    return [each.what for each in found], "ranger" in missing(seen)


@pytest.mark.parametrize(
    ("sensors", "pace", "ranger", "told"),
    [
        (BLIND, (10, 10), False, []),
        (BLIND, (15, 15), False, []),
        (BLIND, (15, 10), False, ["wheels comes at 67 Hz instead of 100", "odom comes at 67 Hz instead of 100"]),
        (BLIND, (30, 15), False, ["wheels comes at 33 Hz instead of 67", "odom comes at 33 Hz instead of 67"]),
        (BUMPED, (10, 10), True, silent("bumper/front")),
        (BUMPED, (10, 10), False, [MISSED]),
        (STOCK, (10, 10), False, [MISSED]),
        (SCANNED, (10, 10), False, [NO_SCAN]),
        (STOCK, (10, 10), True, silent("range/front_left", "range/front_right", "range/rear")),
    ],
)
def test_doctor_and_watch_miss_what_the_robot_has(
    sensors: GuardState, pace: tuple[int, int], ranger: bool, told: list[str]
) -> None:
    assert examined(sensors, *pace, ranger=ranger) == (told, MISSED in told)


def test_doctor_names_a_sensor_that_is_silent_beside_others() -> None:
    heard = ("front_left", "rear", "front")
    assert examined(FULL, 10, 10, ranger=True, heard=heard)[0] == silent("range/front_right", "bumper/back")


@pytest.mark.parametrize(
    ("sensors", "ends", "blamed"), [(BLIND, True, ""), (BUMPED, False, "ranger"), (BUMPED, True, "ranger")]
)
def test_why_blames_no_sensor_that_the_robot_has_not(sensors: GuardState, ends: bool, blamed: str) -> None:
    chain = Scene().drop(topics.RANGE)
    if ends:
        chain.end("ranger")
    assert chain.put(topics.GUARD, sensors, "g").diagnosis().stopped_by == blamed


def test_why_has_a_line_for_a_scanner_that_the_guard_knows() -> None:
    chain = Scene().put(topics.GUARD, SCANNED, "g").diagnosis()
    assert (chain.stopped_by, next(link.status for link in chain.links if link.name == "scan")) == ("scan", "missing")


def test_why_says_what_a_bumper_does_and_which_is_not_heard() -> None:
    chain = Scene().put(topics.GUARD, FULL, "g")
    chain.put(topics.BUMPER, bump("front", pressed=True), "r", "front")
    chain.put(topics.BUMPER, bump("back"), "r", "back")
    ranges = "front_left 1.50 m, front_right 1.50 m, rear 1.50 m"
    assert ranger_link(chain) == ("ok", f"back free, front pushed, {ranges}")
    chain.drop(topics.BUMPER).put(topics.BUMPER, bump("front"), "r", "front")
    deaf = msgspec.structs.replace(FULL, backward=blocked("back", "back was never heard"))
    chain.put(topics.GUARD, deaf, "g")
    assert ranger_link(chain) == ("limits", "back: not heard; check giraff_ranger")
    chain.complain("ranger", OLD_BOARD).put(topics.OPERATOR_CMD_VEL, command(-0.3), HAND, "joystick")
    assert ranger_link(chain) == ("STOPS", f"back: not heard; check giraff_ranger; {OLD_BOARD}")
    assert chain.diagnosis().stopped_by == "ranger"


def test_why_blames_no_sensor_while_nobody_tells_which_there_are() -> None:
    assert Scene().end("ranger").end("guard").diagnosis().stopped_by == "guard"

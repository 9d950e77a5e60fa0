"""Doctor, why and watch go by the robot that is there: one without ultrasonic sensors, one with a slower board."""

from typing import Final

import msgspec
import pytest

from giraff_cli.doctor.findings import findings
from giraff_cli.doctor.robot import CountedTelemetry, rates_of
from giraff_cli.watch.screen import missing
from giraff_core.senses import Bumper
from giraff_schemas import topics
from giraff_schemas.messages import GuardState, SensorState
from tests.unit.cli.samples import MS, Network, base, guard, odometry, verdict, wheels
from tests.unit.cli.scenes import Scene
from tests.unit.cli.test_findings import HEALTHY, ROBOT

STOCK: Final = guard(verdict())
BLIND: Final = msgspec.structs.replace(STOCK, sensors={})
BUMPED: Final = msgspec.structs.replace(BLIND, sensors={"front": SensorState(type=Bumper.type_name())})
MISSED: Final = "giraff_ranger is not running, or hangs: the robot is blind, and guard stops it"


def examined(sensors: GuardState, report_ms: int, told_ms: int, *, ranger: bool) -> tuple[list[str], bool]:
    """Return what doctor finds in 1.5 s of a robot that says no range, and whether watch misses the ranger."""
    listener, board = CountedTelemetry(), msgspec.structs.replace(base().board, report_ms=told_ms)
    network, services = Network(listener), ROBOT.services | {"ranger": int(ranger)}
    for service in ("ranger",) if ranger else ():
        listener.on_liveliness(service, "r", present=True)
    for now in range(0, 1500 * MS, report_ms * MS):
        network.send(topics.WHEELS, wheels(now), now)
        network.send(topics.ODOM, odometry(now, 0.0), now)
        network.send(topics.BASE, msgspec.structs.replace(base(), board=board), now)
        network.send(topics.GUARD, sensors, now)
    seen = listener.snapshot(1500 * MS)
    answers = tuple(each for each in ROBOT.answers if ranger or each.health.service != "ranger")
    rates = tuple(each for each in rates_of(listener, seen) if each.key in ("wheels", "odom", "range/*", "bumper/*"))
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
        (BUMPED, (10, 10), True, ["bumper/* is silent, though giraff_ranger says it is well"]),
        (BUMPED, (10, 10), False, [MISSED]),
        (STOCK, (10, 10), False, [MISSED]),
        (STOCK, (10, 10), True, ["range/* is silent, though giraff_ranger says it is well"]),
    ],
)
def test_doctor_and_watch_miss_what_the_robot_has(
    sensors: GuardState, pace: tuple[int, int], ranger: bool, told: list[str]
) -> None:
    assert examined(sensors, *pace, ranger=ranger) == (told, MISSED in told)


@pytest.mark.parametrize(
    ("sensors", "ends", "blamed"), [(BLIND, True, ""), (BUMPED, False, ""), (BUMPED, True, "ranger")]
)
def test_why_blames_no_sensor_that_the_robot_has_not(sensors: GuardState, ends: bool, blamed: str) -> None:
    chain = Scene().drop(topics.RANGE)
    if ends:
        chain.end("ranger")
    assert chain.put(topics.GUARD, sensors, "g").diagnosis().stopped_by == blamed


def test_why_blames_no_sensor_while_nobody_tells_which_there_are() -> None:
    assert Scene().end("ranger").end("guard").diagnosis().stopped_by == "guard"

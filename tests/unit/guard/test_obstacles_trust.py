"""What makes a sensor worth believing: proof that it hears, readings that follow the robot's motion."""

import math
import random

import msgspec
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_core.live import Live
from giraff_core.senses import Ultrasonic
from giraff_guard.senses.ultrasonic.sensor import Sensor
from giraff_guard.senses.ultrasonic.silence_trust import Ping
from giraff_schemas.trouble import NO_TROUBLE
from tests.support.robots import ULTRASONIC
from tests.unit.guard.senses import CONFIG, CYCLE, FAR, ROBOT, Senses, echoes_of, opened


def test_silence_of_a_sensor_that_proved_nothing_is_worth_little() -> None:
    senses = Senses()
    senses.cycle(None, cycles=20)
    for way, sensor in (("forward", "front_left"), ("backward", "rear")):
        judged = senses.verdict(way)
        assert judged.allowed == pytest.approx(CONFIG.untrusted_speed)
        assert (judged.clearance, judged.sensor) == ("slow", sensor)
        assert "has not proved lately that it hears" in judged.reason.what
        assert judged.reason.remedy == "face a wall within 4 m"
    assert "has not proved" in str(senses.troubles()["rear"])


@pytest.mark.parametrize("bounded_by", ["its own table", "[guard]"])
def test_silence_of_a_proven_sensor_counts_for_its_reach(senses: Senses, bounded_by: str) -> None:
    senses.cycle(None, cycles=5)
    assert senses.verdict().clearance == "free"
    robot, config = ROBOT, msgspec.structs.replace(CONFIG, silent_range=0.1)
    if bounded_by == "[guard]":
        config = msgspec.structs.replace(config, reach=0.5)
    else:
        sensors = {name: msgspec.structs.replace(each, reach=0.5) for name, each in ULTRASONIC.items()}
        robot = msgspec.structs.replace(ROBOT, sensors=sensors)
    short = opened(robot, config, distance=0.45)
    short.cycle(None, cycles=5)
    assert short.verdict().clearance in ("slow", "creep")
    assert "0.50 m" in str(short.verdict().reason)


def test_echoes_that_do_not_follow_from_each_other_prove_nothing() -> None:
    senses = Senses()
    for distance in (3.0, 1.2, None, 2.0, None, 3.5, 1.2, None):
        senses.cycle(distance)
    senses.cycle(None, cycles=2)
    assert senses.allowed() == pytest.approx(CONFIG.untrusted_speed)


def test_a_new_epoch_voids_it_all(senses: Senses) -> None:
    senses.obstacles.forget()
    assert senses.verdict().clearance == "blocked"
    assert "not been heard yet" in str(senses.verdict().reason)
    senses.cycle(None, cycles=20)
    assert senses.allowed() == pytest.approx(CONFIG.untrusted_speed)


def test_the_same_echo_again_and_again_while_the_robot_drives_is_frozen(senses: Senses) -> None:
    senses.linear = 0.3
    senses.cycle(FAR, cycles=5)
    judged = senses.verdict()
    assert judged.clearance == "blocked"
    assert "frozen" in judged.reason.what
    assert judged.reason.remedy
    assert "frozen" in str(senses.troubles()["front_left"])
    assert senses.passes(0.0, 1.0) == (0.0, 1.0)
    # Backward too, by the rear sensor: it repeats itself as well.
    assert senses.verdict("backward").clearance == "blocked"


def test_it_is_trusted_again_when_it_changes(senses: Senses) -> None:
    senses.linear = 0.3
    senses.cycle(FAR, cycles=5)
    senses.linear = 0.0
    senses.cycle(FAR, cycles=5)
    assert "frozen" in str(senses.verdict().reason)
    senses.cycle(FAR - 0.1, cycles=8)
    assert senses.verdict().clearance == "free"


def test_at_rest_the_same_echo_is_right(senses: Senses) -> None:
    senses.cycle(FAR, cycles=100)
    assert senses.verdict().clearance == "free"


def test_there_and_back_is_the_same_place(senses: Senses) -> None:
    for velocity in (0.3, -0.3) * 3:
        senses.linear = velocity
        senses.cycle(FAR, cycles=2)
    assert senses.troubles()["front_left"] == NO_TROUBLE


def test_turning_does_not_freeze_it(senses: Senses) -> None:
    senses.angular = 1.0
    senses.cycle(FAR, cycles=40)
    assert senses.troubles()["front_left"] == NO_TROUBLE


def test_silence_does_not_freeze_it(senses: Senses) -> None:
    senses.linear = 0.3
    senses.cycle(None, cycles=20)
    assert senses.verdict().clearance == "free"


def test_a_wall_that_comes_nearer_as_the_robot_does_is_no_frozen_echo(senses: Senses) -> None:
    senses.linear = 0.3
    distance = FAR
    for _ in range(30):
        distance -= 0.3 * CYCLE
        senses.cycle({"front_left": distance, "front_right": distance, "rear": 6.0 - distance})
    assert senses.verdict().clearance == "free"
    assert senses.troubles() == dict.fromkeys(senses.robot.sensors, NO_TROUBLE)


def test_any_range_at_all_is_worth_creeping_at_most() -> None:
    choose = random.Random(1)
    senses = opened()
    most = []
    for number in range(200):
        senses.cycle({"front_left": choose.uniform(0.02, 4.0)})
        if number >= 30:
            most.append(senses.allowed())
            assert "jumps as no surface does" in str(senses.troubles()["front_left"])
    assert max(most) == pytest.approx(0.1)
    senses.cycle(cycles=25)
    assert senses.verdict().clearance == "free"


def test_some_wild_readings_are_not_held_against_a_sensor() -> None:
    choose = random.Random(2)
    senses = opened()
    for _ in range(400):
        wild = choose.random() < 0.05
        senses.cycle({"front_left": (choose.uniform(0.02, 4.0) if choose.random() < 0.5 else None) if wild else FAR})
        assert senses.troubles()["front_left"] == NO_TROUBLE


def test_a_wall_so_slanted_that_it_is_heard_now_and_then_is_not_held_against_a_sensor() -> None:
    choose = random.Random(3)
    senses = opened()
    held_against = 0
    for _ in range(500):
        heard = choose.random()
        distance = 1.5 if heard < 0.2 else None if heard < 0.6 else 1.5 * choose.uniform(1.3, 2.6)
        senses.cycle({"front_left": distance})
        held_against += senses.troubles()["front_left"] != NO_TROUBLE
    assert held_against < 25


def test_where_the_wheels_are_not_heard_no_sensor_is_called_frozen(senses: Senses) -> None:
    senses.asked = (0.5, 0.0)
    for _ in range(10):
        senses.wait(CYCLE, wheels=False)
        senses.hear(FAR)
    assert senses.troubles()["front_left"] == NO_TROUBLE


def test_a_wrapped_counter_is_no_leap(senses: Senses) -> None:
    senses._left = senses._right = (2**31 - 100) / senses.robot.ticks_per_metre
    senses.report(boot_id=2)
    breaks = senses.obstacles._motion.breaks
    at = senses.obstacles._motion.place
    senses.linear = 0.5
    for _ in range(50):
        senses.robot_ns += 20_000_000
        senses._left += 0.01
        senses._right += 0.01
        senses.report(boot_id=2)
    assert senses.obstacles._motion.breaks == breaks
    assert senses.obstacles._motion.place.x - at.x == pytest.approx(0.5, abs=0.002)


@pytest.mark.parametrize(("left", "right"), [(1.0, 1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
def test_a_leap_of_a_wheel_moves_nothing(senses: Senses, left: float, right: float) -> None:
    """A metre in 20 ms, of either wheel or of both."""
    at = senses.obstacles._motion.place
    senses._left += left
    senses._right += right
    senses.robot_ns += 20_000_000
    senses.report()
    assert senses.obstacles._motion.place == at
    assert senses.obstacles._motion.breaks == 1


@pytest.mark.parametrize(("linear", "angular"), [(0.5, 0.0), (-0.5, 0.0), (0.0, 1.0), (0.4, -0.8)])
def test_between_two_reports_the_robot_goes_on_as_it_did(senses: Senses, linear: float, angular: float) -> None:
    senses.linear, senses.angular = linear, angular
    senses.report()
    senses.robot_ns += 100_000_000
    senses.judge()
    place = senses.obstacles._motion.place
    assert place.yaw == pytest.approx(0.1 * angular)
    assert (place.x, place.y) == pytest.approx(
        (0.1 * linear * math.cos(0.05 * angular), 0.1 * linear * math.sin(0.05 * angular)), abs=1e-3
    )


def test_a_command_that_ended_still_drives_for_the_reaction_time(senses: Senses) -> None:
    """Where the wheels are not heard; and where they are, one that has just begun does not drive yet."""
    senses.asked = (0.4, 0.0)
    senses.wait(0.06)
    assert senses.obstacles._motion.speed(1.0) == 0.0
    senses.wait(0.14)
    assert senses.obstacles._motion.speed(1.0) == pytest.approx(0.4)
    for _ in range(3):
        senses.hear(FAR)
        senses.wait(0.18, wheels=False)
    senses.hear(FAR)
    senses.asked = (0.0, 0.0)
    senses.wait(0.06, wheels=False)
    assert not senses.obstacles._motion.heard
    assert senses.obstacles._motion.speed(1.0) == pytest.approx(0.4)
    senses.wait(0.1, wheels=False)
    assert senses.obstacles._motion.speed(1.0) == 0.0


@pytest.mark.parametrize("kind", ["boot", "leap"])
def test_counters_that_cannot_be_followed_move_nothing(senses: Senses, kind: str) -> None:
    at = senses.obstacles._motion.place
    senses._left += 30.0
    senses._right += 30.0
    senses.robot_ns += 20_000_000
    senses.report(boot_id=2 if kind == "boot" else 1)
    assert senses.obstacles._motion.place == at
    assert senses.obstacles._motion.breaks == 1


def test_the_place_at_a_reading_is_found_between_two_reports(senses: Senses) -> None:
    began = senses.robot_ns
    senses.linear, senses.angular = 0.5, 1.5
    senses.wait(1.0)
    motion = senses.obstacles._motion
    for milliseconds in (500, 505, 510, 515):
        at = motion.place_at(began + milliseconds * 1_000_000)
        yaw = 1.5e-3 * milliseconds
        assert at.yaw == pytest.approx(yaw, abs=0.003)
        # The chord of the arc, whose radius is 1/3 m.
        assert math.hypot(at.x, at.y) == pytest.approx(2 / 3 * math.sin(yaw / 2), abs=0.002)
        assert math.atan2(at.y, at.x) == pytest.approx(yaw / 2, abs=0.01)


@pytest.mark.parametrize("heading", [0.0, 1.0, -2.5])
@pytest.mark.parametrize("axis", [0.0, 0.5, -2.0, math.pi])
def test_ahead_is_the_part_of_the_way_along_an_axis(heading: float, axis: float) -> None:
    here = Pose(0.3, -0.2, heading)
    assert here.ahead(here.moved(0.5, 0.0), axis) == pytest.approx(0.5 * math.cos(axis))
    beside = Pose(here.x - 0.5 * math.sin(heading), here.y + 0.5 * math.cos(heading), heading)
    assert here.ahead(beside, axis) == pytest.approx(0.5 * math.sin(axis))


def test_without_wheels_what_is_passed_on_now_counts_as_driven(senses: Senses) -> None:
    motion = senses.obstacles._motion
    senses.asked = (0.3, 0.0)
    for _ in range(4):
        senses.hear(FAR)
        senses.wait(0.18, wheels=False)
    assert not motion.heard
    assert motion.travel > 0.05
    senses.hear(FAR)
    senses.asked = (0.0, 0.0)
    senses.wait(0.02, wheels=False)
    stopped = motion.place
    senses.wait(0.08, wheels=False)
    assert motion.place == stopped


def test_wheels_that_are_heard_again_say_where_the_robot_is(senses: Senses) -> None:
    """Meanwhile what was passed on counted as driven."""
    senses.asked = (0.1, 0.0)
    senses.wait(1.0, wheels=False)
    assert not senses.obstacles._motion.heard
    assert senses.obstacles._motion.place.x > 0.02
    senses.report()
    motion = senses.obstacles._motion
    assert motion.heard is True
    assert motion.place.x == pytest.approx(0.0, abs=0.001)


@pytest.mark.parametrize("age", [-1.0, -1e-6])
def test_a_report_from_the_future_moves_nothing(senses: Senses, age: float) -> None:
    senses._left = senses._right = 0.01
    senses.report(age=age)
    assert senses.obstacles._motion.place.x == pytest.approx(0.0, abs=1e-9)


def test_what_is_remembered_has_an_end(senses: Senses) -> None:
    choose = random.Random(4)
    for _ in range(2000):
        senses.hear(choose.uniform(0.02, 1.0), "front_left")
    assert len(echoes_of(senses)._echoes) <= 65


@pytest.mark.parametrize("yaw", [0.0, math.pi])
def test_a_reading_follows_from_the_one_before_along_its_sensors_axis(yaw: float) -> None:
    """The robot has driven 0.5 m forward: towards what is ahead, and away from what is behind."""
    sensor = Sensor("only", Ultrasonic(index=0, x=0.0, y=0.0, yaw=yaw), Live(CONFIG))
    before = Ping(0, 1.5, True, Pose(0.0, 0.0, 0.0))
    expected = 1.0 if yaw == 0.0 else 2.0
    compared = [
        sensor._compare(before, Ping(1, expected + more, True, Pose(0.5, 0.0, 0.0))) for more in (-0.2, 0.0, 0.2)
    ]
    assert compared == [-1, 0, 1]


@pytest.mark.parametrize("turned", [0.2, -0.2])
def test_a_slanted_wall_may_come_nearer_or_go_while_the_robot_turns(turned: float) -> None:
    sensor = Sensor("only", Ultrasonic(index=0, x=0.0, y=0.0, yaw=0.0), Live(CONFIG))
    before = Ping(0, 2.0, True, Pose(0.0, 0.0, 0.0))
    for distance, nearer_or_farther in ((1.7, -1), (2.3, 1)):
        assert sensor._compare(before, Ping(1, distance, True, Pose(0.0, 0.0, 0.0))) == nearer_or_farther
        assert sensor._compare(before, Ping(1, distance, True, Pose(0.0, 0.0, turned))) == 0


def test_the_newest_echo_before_the_loss_tells_whether_it_nearly_touched() -> None:
    for distances, lost in (((0.12, 0.09), True), ((0.09, 0.12), False)):
        senses = opened()
        for distance in (*distances, None):
            senses.cycle({"front_left": distance})
        assert ("lost something" in str(senses.verdict().reason)) is lost

"""Ranges of a body that leans: levelled by the attitude, and what may be the floor is no obstacle and no proof."""

import math

import msgspec
import pytest

from giraff_core.senses import Ultrasonic
from giraff_guard.motion import LEVEL, Lean, RecentTravel
from giraff_guard.senses.ultrasonic.silence_trust import Ping
from giraff_guard.senses.ultrasonic.source import UltrasonicSource
from tests.unit.guard.rig import Rig
from tests.unit.guard.senses import CONFIG, HEIGHT, PIVOT, ROBOT, SIDES, Senses, attitude, raised

TALL = raised(ROBOT)
LEAN = math.radians(8.0)


def heard(senses: Senses, sensor: str = "front_left") -> Ping:
    (source,) = senses.obstacles._sources
    assert isinstance(source, UltrasonicSource)
    ping = source._sensors[sensor].newest
    assert ping is not None
    return ping


def leaning(angle: float, distance: float | None) -> Senses:
    """At rest, each sensor heard often enough."""
    senses = Senses(TALL)
    for _ in range(20):
        senses.lean(angle)
        senses.cycle(distance)
    senses.lean(angle)
    senses.hear(distance)
    return senses


@pytest.mark.parametrize("way", SIDES)
@pytest.mark.parametrize("angle", [LEAN, -LEAN])
def test_a_range_is_the_level_way_from_where_the_sensor_is_on_an_upright_robot(way: str, angle: float) -> None:
    """A wall 0.8 m before it; the sensor is nearer or farther, and looks along a slanted axis."""
    sensor = SIDES[way][0]
    forward = 1.0 if way == "forward" else -1.0
    shift = (HEIGHT - PIVOT) * math.sin(angle) * forward
    senses = leaning(angle, (0.8 - shift) / math.cos(angle))
    assert heard(senses, sensor).distance == pytest.approx(0.8, abs=1e-9)
    assert heard(senses, sensor).echo


def test_what_may_be_the_floor_is_no_obstacle_and_no_proof() -> None:
    sensor = TALL.of(Ultrasonic)["front_left"]
    height = PIVOT + (HEIGHT - PIVOT) * math.cos(LEAN) - sensor.x * math.sin(LEAN)
    floor = height / math.sin(LEAN + math.radians(7.5))
    for distance in (floor + 0.01, None):
        ping = heard(leaning(LEAN, distance))
        assert not ping.echo
        assert ping.distance == pytest.approx(floor * math.cos(LEAN) + (HEIGHT - PIVOT) * math.sin(LEAN))
    assert heard(leaning(LEAN, floor - 0.01)).echo
    assert heard(leaning(math.radians(2.9), 3.9)).echo, "a robot that hardly leans hears walls far away"
    senses = leaning(LEAN, floor + 0.01)
    assert "has not proved lately that it hears" in str(senses.verdict().reason)
    assert senses.allowed() == pytest.approx(CONFIG.untrusted_speed)


def test_a_lean_that_is_not_told_any_more_blinds() -> None:
    senses = leaning(0.0, 3.0)
    assert senses.verdict().clearance == "free"
    senses.cycle(3.0, cycles=2)
    assert senses.verdict().clearance == "free", "up to range_budget a lean counts"
    senses.cycle(3.0, cycles=2)
    judged = senses.verdict()
    assert (judged.clearance, judged.allowed) == ("blocked", 0.0)
    assert str(judged.reason).startswith("front_left looks along a body whose lean is not known")


def test_the_height_of_a_sensor_on_a_body_that_leans_has_to_be_known() -> None:
    senses = Senses(ROBOT)
    senses.lean(0.0)
    senses.cycle(3.0, cycles=2)
    assert "its height is not known; set its z" in str(senses.verdict().reason)


def test_the_lean_is_that_of_the_ping() -> None:
    senses = Senses(TALL)
    motion: RecentTravel = senses.obstacles._motion
    assert motion.lean_at(senses.robot_ns) is LEVEL
    senses.lean(0.1, age=0.1)
    senses.lean(0.2, age=0.0)
    between = motion.lean_at(senses.ago(0.05).robot_ns)
    assert between is not None
    assert between == pytest.approx(Lean(0.15, PIVOT))
    assert motion.lean_at(senses.ago(0.2).robot_ns) == Lean(0.1, PIVOT)
    assert motion.lean_at(senses.ago(0.6).robot_ns) is None


def test_an_attitude_counts_by_base_alone_and_while_it_is_fresh() -> None:
    rig = Rig(TALL)
    for seq, (base, age, counts) in enumerate([("base-8", 0.0, False), ("base-7", 0.6, False), ("base-7", 0.0, True)]):
        rig.guard.on_attitude(attitude(0.1, rig.ago(age), seq=seq, instance=base), rig.robot_ns)
        found = rig.guard._obstacles._motion.lean_at(rig.robot_ns)
        assert (found is not LEVEL) is counts


def test_a_robot_that_runs_on_is_blind_before_it_tells_its_lean() -> None:
    senses = Senses(TALL, msgspec.structs.replace(CONFIG, run_on=0.12))
    senses.hear(1.0)
    assert "whose lean is not known" in str(senses.judge().forward.reason)

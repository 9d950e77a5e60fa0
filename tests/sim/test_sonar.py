"""The HC-SR04: what it hears, and what it cannot."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from giraff_core.senses import Ultrasonic
from giraff_sim.config import SimConfig
from giraff_sim.world.room import Pose, Room
from giraff_sim.world.sonar import NO_ECHO_US, SILENT_US, STUCK_US, Lean, Sonar, SonarFault, sonars
from tests.sim.robots import EXACT, ORIGIN, empty_room, room_with_wall
from tests.support.robots import ULTRASONIC

AHEAD = Ultrasonic(index=0, x=0.0, y=0.0, yaw=0.0)


def sonar_in(
    room: Room, sim: SimConfig = EXACT, mount: Ultrasonic = AHEAD, seed: str = "seed", noise: float = 0.0
) -> Sonar:
    return Sonar(mount, room, sim, seed, noise)


def pinged(sonar: Sonar) -> float | None:
    """m that a ping measures; None: it finds nothing."""
    echo_us = sonar.echo_us(ORIGIN)
    return None if echo_us == NO_ECHO_US else echo_us / 5800.0


@given(st.floats(0.02, 3.999))
def test_the_echo_of_a_wall_ahead_lasts_58_us_a_centimetre(distance: float) -> None:
    assert sonar_in(room_with_wall(distance)).echo_us(ORIGIN) == pytest.approx(distance * 5800.0)


def test_beyond_4_metres_nothing_answers() -> None:
    for room in (empty_room(), room_with_wall(4.1), room_with_wall(-1.0)):
        sonar = sonar_in(room)
        assert sonar.heard(ORIGIN) is None
        assert sonar.echo_us(ORIGIN) == NO_ECHO_US


def test_nearer_than_2_centimetres_reads_2() -> None:
    assert sonar_in(room_with_wall(0.005)).echo_us(ORIGIN) == pytest.approx(116.0)


def test_the_mount_counts() -> None:
    room = room_with_wall(2.0)
    heard = {number: sonar.heard(ORIGIN) for number, sonar in sonars(ULTRASONIC, room, EXACT, 1).items()}
    assert heard == {0: pytest.approx(1.75), 1: pytest.approx(1.75), 2: None}
    turned = Pose(0.0, 0.0, math.pi)
    assert sonars(ULTRASONIC, room, EXACT, 1)[2].heard(turned) == pytest.approx(1.75)


def test_on_a_body_that_leans_it_looks_along_a_slanted_axis_and_may_hear_the_floor() -> None:
    """0.3 m up and 0.125 m above the axle, at 8 degrees: it looks at the floor from 2.2 m on."""
    lean, mount = Lean(math.radians(8.0), 0.175), Ultrasonic(index=0, x=0.0, y=0.0, z=0.3, yaw=0.0)
    sin, cos = math.sin(lean.angle), math.cos(lean.angle)
    wall = sonar_in(room_with_wall(1.0), mount=mount)
    assert wall.echo_us(ORIGIN, lean) / 5800.0 == pytest.approx((1.0 - 0.125 * sin) / cos)
    assert wall.must_have_heard is not None
    assert wall.must_have_heard[1] is not None
    hall = sonar_in(empty_room(), mount=mount)
    told = [hall.echo_us(ORIGIN, lean) / 5800.0 for _ in range(500)]
    floor = [value for value in told if value == pytest.approx((0.175 + 0.125 * cos) / sin)]
    assert len(floor) / len(told) == pytest.approx(0.2, abs=0.05)
    assert hall.must_have_heard == (ORIGIN, None, 0)
    assert hall.echo_us(ORIGIN, Lean(-lean.angle, 0.175)) == NO_ECHO_US, "leaning back it looks up"


@pytest.mark.parametrize("degrees", [0, 5, 10, 15, 20, 24.9])
def test_a_wall_up_to_25_degrees_is_always_heard_at_its_nearest_point_in_the_cone(degrees: float) -> None:
    slant = math.radians(degrees)
    room = empty_room()
    along = (-math.sin(slant), math.cos(slant))
    room.add_wall("slant", [(2 - 5 * along[0], -5 * along[1]), (2 + 5 * along[0], 5 * along[1])])
    outside = max(0.0, slant - math.radians(7.5))
    expected = 2.0 * math.cos(slant) / math.cos(outside)
    sonar = sonar_in(room)
    assert sonar.heard(ORIGIN) == pytest.approx(expected, abs=1e-9)
    for _ in range(50):
        assert pinged(sonar) == pytest.approx(expected, abs=1e-9)


def test_a_wall_beyond_30_degrees_is_mostly_missed_or_far_too_long() -> None:
    slant = math.radians(40.0)
    room = empty_room()
    along = (-math.sin(slant), math.cos(slant))
    room.add_wall("slant", [(1 - 5 * along[0], -5 * along[1]), (1 + 5 * along[0], 5 * along[1])])
    sonar = sonar_in(room)
    heard = [pinged(sonar) for _ in range(2000)]
    true = [value for value in heard if value is not None and value < 1.0]
    wild = [value for value in heard if value is not None and value >= 1.0]
    missed = [value for value in heard if value is None]
    assert 0.58 < (len(wild) + len(missed)) / len(heard) < 1.0
    assert len(true) > 100
    assert len(wild) > 400
    assert len(missed) > 400


def test_between_25_and_30_degrees_some_pings_are_lost() -> None:
    slant = math.radians(27.5)
    room = empty_room()
    along = (-math.sin(slant), math.cos(slant))
    room.add_wall("slant", [(1 - 5 * along[0], -5 * along[1]), (1 + 5 * along[0], 5 * along[1])])
    sonar = sonar_in(room)
    lost = sum((heard := pinged(sonar)) is None or heard > 1.0 for _ in range(2000))
    assert 400 < lost < 1200


def test_the_cone_is_15_degrees_wide() -> None:
    for degrees, is_heard in ((0.0, True), (7.4, True), (-7.4, True), (9.0, False), (-9.0, False)):
        room = empty_room()
        room.add_post("pole", 2.0 * math.cos(math.radians(degrees)), 2.0 * math.sin(math.radians(degrees)), 0.01)
        heard = sonar_in(room).heard(ORIGIN)
        assert heard == (pytest.approx(1.99) if is_heard else None)


def test_what_stands_in_front_hides_what_is_behind() -> None:
    room = room_with_wall(3.0)
    room.add_wall("screen", [(1.0, -1.0), (1.0, 1.0)])
    sonar = sonar_in(room)
    assert sonar.heard(ORIGIN) == pytest.approx(1.0)
    room.remove("screen")
    assert sonar.heard(ORIGIN) == pytest.approx(3.0)


def test_noise_is_small_and_the_seeds() -> None:
    first = [sonar_in(room_with_wall(1.0), noise=0.003).echo_us(ORIGIN) for _ in range(3)]
    assert first[0] == first[1] == first[2]
    sonar = sonar_in(room_with_wall(1.0), noise=0.003)
    many = [sonar.echo_us(ORIGIN) / 5800.0 for _ in range(2000)]
    assert sum(many) / len(many) == pytest.approx(1.0, abs=5e-4)
    assert max(abs(value - 1.0) for value in many) < 0.02
    assert sonar_in(room_with_wall(1.0), seed="other", noise=0.003).echo_us(ORIGIN) != first[0]


def test_crosstalk_is_a_range_that_is_too_short() -> None:
    sonar = sonar_in(room_with_wall(2.0), SimConfig(sonar_crosstalk=0.25))
    ranges = [sonar.echo_us(ORIGIN) / 5800.0 for _ in range(2000)]
    short = [value for value in ranges if value < 1.999]
    assert 0.2 < len(short) / len(ranges) < 0.3
    assert max(ranges) == pytest.approx(2.0)


def wild_pings(share: float, count: int) -> list[float]:
    sonar = sonar_in(room_with_wall(1.0))
    sonar.fault, sonar.wild_share = SonarFault.WILD_SOME, share
    return [sonar.echo_us(ORIGIN) / 5800.0 for _ in range(count)]


def test_a_share_of_the_pings_can_be_wild_half_of_them_without_an_echo() -> None:
    pings = wild_pings(0.05, 20_000)
    wild = [value for value in pings if value != pytest.approx(1.0)]
    ranges = [value for value in wild if value < 4.0]
    assert len(wild) / len(pings) == pytest.approx(0.05, abs=0.005)
    assert len(ranges) / len(wild) == pytest.approx(0.5, abs=0.05)
    assert set(wild) - set(ranges) == {NO_ECHO_US / 5800.0}
    assert 0.02 <= min(ranges) < 0.1
    assert 3.9 < max(ranges) <= 4.0
    assert sum(ranges) / len(ranges) == pytest.approx(2.01, abs=0.15)


def test_wild_pings_are_independent_the_seeds_and_leave_the_others_as_they_were() -> None:
    pings = wild_pings(0.5, 4000)
    assert pings == wild_pings(0.5, 4000)
    is_wild = [value != pytest.approx(1.0) for value in pings]
    follows = sum(is_wild[at] and is_wild[at - 1] for at in range(1, len(is_wild)))
    assert follows / len(is_wild) == pytest.approx(0.25, abs=0.03)
    assert set(wild_pings(0.0, 100)) == {1.0}
    calm, disturbed = sonar_in(room_with_wall(1.0), noise=0.003), sonar_in(room_with_wall(1.0), noise=0.003)
    disturbed.fault, disturbed.wild_share = SonarFault.WILD_SOME, 0.5
    honest = [calm.echo_us(ORIGIN) for _ in range(500)]
    told = [disturbed.echo_us(ORIGIN) for _ in range(500)]
    assert [echo for echo in told if echo in honest] == honest[: sum(echo in honest for echo in told)]


def test_only_a_sound_ping_has_measured_something() -> None:
    sonar = sonar_in(room_with_wall(1.0), noise=0.003)
    told = sonar.echo_us(ORIGIN)
    assert sonar.measured == told / 5800.0
    for fault in set(SonarFault) - {SonarFault.NONE, SonarFault.WILD_SOME}:
        sonar.fault = fault
        sonar.echo_us(ORIGIN)
        assert sonar.measured is None
    sonar.fault, sonar.wild_share = SonarFault.WILD_SOME, 0.5
    pings = [(sonar.echo_us(ORIGIN) / 5800.0, sonar.measured) for _ in range(100)]
    assert all(measured == (told if abs(told - 1.0) < 0.02 else None) for told, measured in pings)
    assert {measured is None for _, measured in pings} == {True, False}


def test_faults() -> None:
    room = room_with_wall(1.0)
    sonar = sonar_in(room)
    assert sonar.echo_us(ORIGIN) == pytest.approx(5800.0)
    sonar.fault = SonarFault.DEAD
    assert sonar.echo_us(ORIGIN) == SILENT_US
    sonar.fault = SonarFault.STUCK
    assert sonar.echo_us(ORIGIN) == STUCK_US
    sonar.fault = SonarFault.DEAF
    assert sonar.echo_us(ORIGIN) == NO_ECHO_US
    sonar.fault = SonarFault.FROZEN
    room.remove("wall")
    assert sonar.echo_us(ORIGIN) == pytest.approx(5800.0)
    sonar.fault = SonarFault.WILD
    assert len({sonar.echo_us(ORIGIN) for _ in range(50)}) == 50
    sonar.fault = SonarFault.NONE
    assert sonar.echo_us(ORIGIN) == NO_ECHO_US
    assert sonar.pings == 56

"""What is true of all senses, by one that tells points and knows no rule of its own."""

import math
from typing import Any, Final

import msgspec
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import Bumper
from giraff_guard import obstacles
from giraff_guard.geometry import View
from giraff_guard.limits import SIGN, DriveDirection
from giraff_guard.motion import RecentTravel
from giraff_guard.registry import sources_of
from giraff_guard.source import Beam, Points, Reading, Sight, Source
from giraff_schemas.bumper import Bump
from giraff_schemas.messages import RobotTime, Sample
from giraff_schemas.trouble import NO_TROUBLE, Trouble
from tests.unit.guard.senses import CONFIG, ROBOT, Senses

BLIND: Final = msgspec.structs.replace(ROBOT, sensors={})
TURN_S: Final = 0.1


class Sweep(Sample, frozen=True, kw_only=True):
    """Points in `base_link`, all round."""

    sensor: str = "eye"
    points: tuple[tuple[float, float], ...] = ()
    tick: RobotTime | None = None


class Eye(Source):
    """Tells each way what its newest sweep has seen."""

    sees_ahead = True

    def __init__(self) -> None:
        self.names, self.takes, self.service = ["eye"], Sweep, "scan"
        self.points: Points | None = None
        self.reach = 4.0

    def covers(self, way: DriveDirection) -> list[str]:
        del way
        return ["eye"]

    def on_sample(self, sample: Sweep, motion: RecentTravel, now: RobotTime) -> list[Beam]:
        del now
        assert sample.tick is not None
        place = motion.place_at(sample.tick.robot_ns)
        mount = Pose(0.0, 0.0, 0.0)
        seen = [View(mount, place).point(math.hypot(x, y), math.atan2(y, x)) for x, y in sample.points]
        self.points = Points(seen, 0.0, self.reach, place)
        return []

    def sight(self, sensor: str, way: DriveDirection, motion: RecentTravel, now: RobotTime) -> Sight:
        del way, motion, now
        return Sight(sensor, points=self.points)

    def trouble(self, sensor: str, motion: RecentTravel, now: RobotTime) -> Trouble:
        del sensor, motion, now
        return NO_TROUBLE

    def forget(self) -> None:
        self.points = None


@pytest.fixture
def eye(monkeypatch: pytest.MonkeyPatch) -> Senses:
    """A robot with that sense alone, which has seen nothing for a second."""
    monkeypatch.setattr(obstacles, "sources_of", lambda *_: [Eye()])
    senses = Senses(BLIND)
    look(senses, seconds=1.0)
    return senses


def look(senses: Senses, *points: tuple[float, float], seconds: float = TURN_S) -> None:
    for _ in range(round(seconds / TURN_S)):
        senses.wait(TURN_S)
        senses.obstacles.on_sensed(Sweep(points=points, tick=senses.now), senses.now)
        senses.judge()


def test_it_stops_at_the_margin_before_a_wall_after_full_speed(eye: Senses) -> None:
    wall, came, fastest = 2.5, 0.0, 0.0
    for _ in range(400):
        wait, eye.linear = TURN_S / 5.0, eye.passes(9.0)[0]
        came, fastest = came + eye.linear * wait, max(fastest, eye.linear)
        eye.wait(wait)
        points = tuple((wall - came, y / 10.0) for y in range(-5, 6))
        eye.obstacles.on_sensed(Sweep(points=points, tick=eye.now), eye.now)
    assert fastest == ROBOT.max_wheel_speed
    assert (eye.linear, eye.allowed()) == (0.0, 0.0)
    assert CONFIG.margin - 0.01 <= wall - came - ROBOT.footprint_radius < CONFIG.margin + 0.1


def test_it_drives_no_faster_than_it_sees_far(eye: Senses) -> None:
    [source] = eye.obstacles._sources
    assert isinstance(source, Eye)
    source.reach = ROBOT.footprint_radius + CONFIG.margin + 0.04
    look(eye)
    assert 0.0 < eye.allowed() < 0.25
    assert eye.verdict().reason.what == "eye sees no farther than 0.29 m"
    source.reach = ROBOT.footprint_radius + CONFIG.margin
    look(eye)
    assert eye.allowed() == 0.0


def test_a_point_beside_the_way_bends_no_straight_line_and_slows_the_curve_that_sweeps_it(eye: Senses) -> None:
    look(eye, (0.4, 0.4))
    assert eye.allowed() == ROBOT.max_wheel_speed
    linear, angular = eye.passes(0.5, 1.0)
    assert 0.0 < linear < 0.4
    assert angular == pytest.approx(2.0 * linear)
    assert eye.passes(0.5, -1.0) == (0.5, -1.0)


def test_what_touches_its_side_is_turned_past_slowly(eye: Senses) -> None:
    look(eye, (0.0, ROBOT.footprint_radius + CONFIG.memory_margin - 0.01))
    assert eye.allowed("turn_left") == CONFIG.creep_angular
    look(eye, (0.0, ROBOT.footprint_radius + CONFIG.memory_margin + 0.01))
    assert eye.allowed("turn_left") == ROBOT.max_angular_speed


def test_one_that_falls_silent_blocks_every_way_that_it_covers(eye: Senses) -> None:
    eye.wait(CONFIG.range_budget + 0.1)
    assert [eye.verdict(way).reason.what[:12] for way in SIGN] == ["eye is stale"] * 2
    assert "giraff_scan" in eye.verdict().reason.remedy


NOWHERE: Final = Pose(0.0, 0.0, 0.0)
FREE: Final = Reading(9.0, 0.0, 9.0)


@pytest.mark.parametrize(
    ("sight", "why"),
    [
        (Sight("eye"), "tells nothing of this way"),
        (Sight("eye", readings=[FREE, Reading(math.nan, 0.0, 1.0)]), "is no number"),
        (Sight("eye", readings=[FREE], doubt=Trouble("doubted"), doubtful_speed=math.nan), "is no number"),
        (Sight("eye", points=Points([(3.0, 0.0), (math.nan, 0.0)], 0.0, 4.0, NOWHERE)), "is no number"),
        (Sight("eye", points=Points([], math.nan, 4.0, NOWHERE)), "is no number"),
        (Sight("eye", points=Points([], 0.0, math.nan, NOWHERE)), "is no number"),
    ],
)
def test_one_that_tells_nothing_or_no_number_blocks(
    eye: Senses, monkeypatch: pytest.MonkeyPatch, sight: Sight, why: str
) -> None:
    monkeypatch.setattr(Eye, "sight", lambda *_: sight)
    assert eye.allowed() == 0.0
    assert why in eye.verdict().reason.what


def test_one_that_is_good_before_the_first_decision_opens_its_way(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(obstacles, "sources_of", lambda *_: [Eye()])
    senses = Senses(BLIND)
    senses.obstacles.on_sensed(Sweep(tick=senses.now), senses.now)
    look(senses, seconds=1.0)
    assert senses.allowed() == ROBOT.max_wheel_speed


def test_many_looks_open_a_blocked_way_no_sooner_than_ten_a_second(eye: Senses) -> None:
    look(eye, (0.4, 0.0))
    assert eye.allowed() == 0.0
    regained = []
    for _ in range(200):
        eye.robot_ns += 1_000_000
        eye.obstacles.on_sensed(Sweep(tick=eye.now), eye.now)
        regained.append(eye.allowed() - CONFIG.creep_linear)
    assert regained[-1] == pytest.approx(2 * CONFIG.recovery_step)


def test_a_robot_that_only_feels_creeps() -> None:
    senses = Senses(msgspec.structs.replace(BLIND, sensors={"front": Bumper(index=0, way="forward")}))
    for _ in range(20):
        senses.wait(TURN_S)
        senses.obstacles.on_sensed(Bump(sensor="front", pressed=False, tick=senses.now), senses.now)
    assert (senses.allowed(), senses.verdict().reason.what) == (CONFIG.creep_linear, "no sensor looks forward")


def test_the_stricter_of_two_senses_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    both: Any = sources_of
    monkeypatch.setattr(obstacles, "sources_of", lambda *given: [*both(*given), Eye()])
    senses = Senses(ROBOT)
    for _ in range(12):
        senses.cycle()
        look(senses)
    assert senses.allowed() == ROBOT.max_wheel_speed
    look(senses, (0.7, 0.0))
    assert (senses.verdict().sensor, senses.allowed() < ROBOT.max_wheel_speed) == ("eye", True)
    senses.cycle(0.1, cycles=2)
    look(senses)
    assert senses.verdict().sensor == "front_left"
    assert senses.allowed() == 0.0

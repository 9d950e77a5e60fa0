"""A laser scanner as a sense: stops and slows all round, by each ray from where the robot was."""

import math
from array import array
from typing import Any, Final

import msgspec
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_core.senses import LaserScanner
from giraff_guard.config import GuardConfig
from giraff_guard.senses.laser_scanner import LaserScannerSource
from giraff_schemas.scan import NOT_MEASURED, OWN, RAYS, SECTORS, LaserScan, packed
from giraff_schemas.trouble import Trouble
from giraff_sim.world.room import Pose as Start
from giraff_sim.world.room import Room
from tests.unit.guard.senses import CONFIG, ROBOT, Senses

TURN_S: Final = 0.1
SLICES: Final = 5
LASER: Final = LaserScanner(x=-0.115, y=0.02, yaw=0.3, own=())
RADIUS: Final = ROBOT.footprint_radius
STILL: Final = Trouble("laser: its motor makes 0.0 turns a second")


class Scanned(Senses):
    """A robot with a scanner alone, in a room whose origin is where it starts."""

    def __init__(self, mount: LaserScanner = LASER, post: tuple[float, ...] = (), config: GuardConfig = CONFIG) -> None:
        super().__init__(msgspec.structs.replace(ROBOT, sensors={"laser": mount}), config)
        self.mount, self.pose = mount, Pose(0.0, 0.0, 0.0)
        self.room = Room("test", Start(0.0, 0.0, 0.0))
        self.room.add_wall("all round", [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)], closed=True)
        if post:
            self.room.add_post("post", *post)
        self.hidden = set[int]()
        """Sectors whose rays are not measured."""

    def wall(self, x: float) -> None:
        self.room.add_wall("wall", [(x, -9.0), (x, 9.0)])

    def turn(self, seconds: float = TURN_S, **told: Any) -> None:
        """Make turns of the scanner while the robot drives on; `told`: fields of the samples."""
        for _ in range(round(seconds / TURN_S)):
            tick, rays = self.now, array("H")
            for _ in range(SLICES):
                begun = self.pose
                for each in range(RAYS // SLICES):
                    share = TURN_S / SLICES * each / (RAYS // SLICES)
                    rays.append(self._mm(begun.moved(self.linear * share, self.angular * share), len(rays)))
                self.pose = begun.moved(self.linear * TURN_S / SLICES, self.angular * TURN_S / SLICES)
                self.wait(TURN_S / SLICES)
            step = math.tau / RAYS * (1.0 if self.mount.upside_down else -1.0)
            fields: dict[str, Any] = {"ranges": packed(rays), "blind": tuple(self.hidden)} | told
            place: dict[str, Any] = {
                "bearing": self.mount.yaw,
                "step": step,
                "duration": TURN_S,
                "since_tick": 0.0,
                "tick": tick,
            }
            scan = LaserScan(sensor="laser", **place | fields)
            self.obstacles.on_sensed(scan, self.now)
            self.judge()

    def _mm(self, pose: Pose, ray: int) -> int:
        if ray * SECTORS // RAYS in self.hidden:
            return NOT_MEASURED
        bearing = self.mount.yaw + ray * math.tau / RAYS * (1.0 if self.mount.upside_down else -1.0)
        cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
        x, y = (
            pose.x + cos * self.mount.x - sin * self.mount.y,
            pose.y + sin * self.mount.x + cos * self.mount.y,
        )
        hit = self.room.ray(x, y, pose.yaw + bearing, 12.0)
        mm = 0 if hit is None else round(hit.distance * 1000)
        return mm | OWN if self.mount.hides(bearing) else mm

    def points(self) -> list[tuple[float, float]]:
        [source] = self.obstacles._sources
        assert isinstance(source, LaserScannerSource)
        told = source.sight("laser", "forward", self.obstacles._motion, self.now).points
        assert told is not None
        return list(told.xy)


def sector(mount: LaserScanner, degrees: float) -> int:
    """Return the number of the sector that looks there: degrees to the left of the robot's heading."""
    sense = 1.0 if mount.upside_down else -1.0
    return int((math.radians(degrees) - mount.yaw) * sense % math.tau / math.tau * SECTORS)


def opened(mount: LaserScanner = LASER, **room: Any) -> Scanned:
    senses = Scanned(mount, **room)
    senses.turn(1.0)
    return senses


@pytest.mark.parametrize(("way", "upside_down"), [(1.0, False), (-1.0, True)])
def test_it_stops_at_the_margin_before_a_wall_after_full_speed(way: float, upside_down: bool) -> None:
    senses, fastest = opened(msgspec.structs.replace(LASER, upside_down=upside_down)), 0.0
    senses.wall(2.2 * way)
    for _ in range(60):
        senses.linear = senses.passes(9.0 * way)[0]
        fastest = max(fastest, abs(senses.linear))
        senses.turn()
    assert fastest == ROBOT.max_wheel_speed
    assert senses.linear == 0.0
    assert CONFIG.margin - 0.03 <= 2.2 - abs(senses.pose.x) - RADIUS < CONFIG.margin + 0.1


def test_points_are_where_the_walls_are_while_the_robot_drives_and_turns() -> None:
    senses = opened()
    senses.wall(1.2)
    senses.linear, senses.angular = 0.3, 1.5
    worst = []
    for _ in range(12):
        senses.turn()
        worst += [abs(x - 1.2) for x, _ in senses.points()]
    assert len(worst) > 100
    assert max(worst) < 0.03


def test_a_leg_that_one_turn_has_met_counts_for_three() -> None:
    senses = opened()
    senses.room.add_post("leg", 0.75, 0.0, 0.012)
    senses.turn()
    senses.room.remove("leg")
    slowed = []
    for _ in range(5):
        slowed.append(senses.allowed() < ROBOT.max_wheel_speed)
        senses.turn()
    assert slowed == [True, True, True, False, False]


@pytest.mark.parametrize("upside_down", [False, True])
@pytest.mark.parametrize(
    ("degrees", "creeps"), [(0.0, (1, 0)), (40.0, (1, 0)), (-40.0, (1, 0)), (90.0, (0, 0)), (180.0, (0, 1))]
)
def test_it_creeps_where_a_part_of_the_way_is_blind(degrees: float, creeps: tuple[int, int], upside_down: bool) -> None:
    mount = msgspec.structs.replace(LASER, upside_down=upside_down)
    senses = opened(mount)
    senses.hidden = {sector(mount, degrees)}
    senses.turn()
    allowed = [senses.allowed(way) for way in ("forward", "backward")]
    assert allowed == [CONFIG.creep_linear if each else ROBOT.max_wheel_speed for each in creeps]
    assert not senses.troubles()["laser"]
    senses.hidden = set()
    senses.turn()
    assert senses.allowed() == ROBOT.max_wheel_speed


def test_what_stood_in_a_sector_before_it_became_blind_counts_on() -> None:
    senses = opened(config=msgspec.structs.replace(CONFIG, silent_time=2.0))
    senses.wall(RADIUS + 0.2)
    senses.turn(0.3)
    assert senses.allowed() == 0.0
    senses.hidden = set(range(SECTORS))
    senses.turn(1.8)
    assert senses.allowed() == 0.0
    senses.turn(0.5)
    assert senses.allowed() == CONFIG.creep_linear


def test_it_creeps_until_somebody_has_looked_for_what_the_robot_hides() -> None:
    senses = opened(msgspec.structs.replace(LASER, own=None), post=(0.1, 0.0, 0.02))
    assert [senses.allowed(way) for way in ("forward", "backward")] == [CONFIG.creep_linear] * 2
    assert "giraff calibrate scan" in senses.verdict().reason.remedy
    senses.wall(RADIUS + CONFIG.margin - 0.02)
    senses.turn()
    assert senses.allowed() == 0.0


def test_it_creeps_where_the_robot_hides_a_part_of_the_way_whose_parts_are_no_obstacle() -> None:
    at = math.atan2(-0.02, 0.215) - LASER.yaw
    senses = opened(msgspec.structs.replace(LASER, own=((at - 0.1, at + 0.1),)), post=(0.1, 0.0, 0.02))
    assert senses.allowed("forward") == CONFIG.creep_linear
    assert senses.allowed("backward") == ROBOT.max_wheel_speed
    assert senses.verdict().reason.what == "laser: the robot itself hides a part of the way forward"


def test_a_robot_that_balances_creeps_since_its_scanner_leans() -> None:
    senses = opened(config=msgspec.structs.replace(CONFIG, run_on=0.1))
    assert (senses.allowed(), "leans" in senses.verdict().reason.what) == (CONFIG.creep_linear, True)


def test_a_fault_of_the_scanner_blocks_every_way_at_once_and_two_turns_end_it() -> None:
    senses = opened()
    senses.turn(trouble=STILL)
    assert [senses.verdict(way).reason.what for way in ("forward", "backward")] == [STILL.what] * 2
    assert senses.troubles()["laser"] == STILL
    senses.turn()
    assert senses.allowed() == 0.0
    assert "needs two" in senses.verdict().reason.what
    senses.turn()
    assert senses.allowed() > 0.0


@pytest.mark.parametrize("told", [{"bearing": LASER.yaw + 0.2}, {"step": math.tau / RAYS}])
def test_a_scan_by_another_robot_file_blocks(told: dict[str, float]) -> None:
    senses = opened()
    senses.turn(0.3, **told)
    assert senses.allowed() == 0.0
    assert "another robot file" in senses.verdict().reason.what


def test_after_a_silence_it_needs_two_turns_and_nothing_of_before_counts() -> None:
    senses = opened()
    senses.room.add_post("leg", 0.5, 0.0, 0.05)
    senses.turn(0.2)
    senses.wait(CONFIG.range_budget + 0.1)
    assert "is stale" in senses.verdict().reason.what
    senses.room.remove("leg")
    senses.turn()
    assert "needs two" in senses.verdict().reason.what
    senses.turn()
    assert senses.allowed() == CONFIG.creep_linear


def test_it_sees_what_touches_its_side_and_what_a_curve_sweeps() -> None:
    senses = opened(post=(0.0, RADIUS + CONFIG.memory_margin, 0.02))
    assert senses.allowed("turn_left") == CONFIG.creep_angular
    senses = opened(post=(0.4, 0.45, 0.03))
    assert senses.allowed() == ROBOT.max_wheel_speed
    assert 0.0 < senses.passes(0.5, 1.0)[0] < 0.4
    assert senses.passes(0.5, -1.0) == (0.5, -1.0)


def test_a_break_of_the_wheels_or_another_epoch_forgets_where_things_were() -> None:
    senses = opened()
    senses.report(boot_id=2)
    assert senses.allowed() == 0.0
    senses.turn(0.2)
    senses.obstacles.forget()
    assert senses.allowed() == 0.0

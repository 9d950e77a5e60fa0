"""What localization answers and tells, whatever it is given."""

import math
from typing import Any

import msgspec
import numpy as np
import pytest

from giraff_core.kinematics.pose import Pose
from giraff_localization.beams.range_table import CLEAR
from giraff_localization.filter import Filter
from giraff_localization.floor import Floor
from giraff_localization.policy import LocalizationPolicy
from giraff_maps.floor_plan import FloorPlan
from giraff_schemas.localization import LocalizationGlobal, LocalizationSetPose, MapPose
from giraff_schemas.messages import Range, RobotTime
from giraff_schemas.trouble import Trouble
from tests.support.robots import ROBOT, ULTRASONIC
from tests.unit.localization.rooms import CONFIG, ROOM, echo, floor, odometry

ORIGIN = Pose(0.0, 0.0, 0.0)
NO_MAP = Trouble("no map is given", "set one")


def policy(plan: FloorPlan | Floor | Trouble | None = None, *, seed: int = 1) -> LocalizationPolicy:
    """One that has computed all that it can."""
    made = LocalizationPolicy(CONFIG, ROBOT, floor() if plan is None else plan, seed)
    work(made)
    return made


def work(made: LocalizationPolicy) -> None:
    while made.work():
        pass


def set_pose(made: LocalizationPolicy, **changes: Any) -> str:
    """Why not; empty: done."""
    request: dict[str, Any] = {"by": "test", "id": 1, "x": 1.0, "y": 1.5, "yaw": 0.0, "position_sd": 0.1, "yaw_sd": 0.1}
    answer = made.on_set_pose(LocalizationSetPose(**(request | changes)))
    assert answer.done is not bool(answer.reason)
    return str(answer.reason)


class Robot:
    """Drives through the room of 5 m by 3 m, and hears its walls."""

    def __init__(self, made: LocalizationPolicy, start: Pose, odom: Pose = ORIGIN) -> None:
        self.policy, self.pose, self.odom = made, start, odom
        self.seconds, self.jumps, self.instance = 1.0, 0, "one"
        self.hears = True

    def drive(self, metres: float, turn: float = 0.0) -> None:
        """rad for each m; where it is in `odom`, odometry tells without an error."""
        steps = round(metres / 0.02)
        for step in range(steps):
            self.seconds += 0.05
            self.pose = self.pose.moved(0.02, 0.02 * turn)
            self.odom = self.odom.moved(0.02, 0.02 * turn)
            self.tell()
            if self.hears and step % 2 == 0:
                for sensor, mount in ULTRASONIC.items():
                    place = Pose(mount.x, mount.y, mount.yaw).placed_in(self.pose)
                    self.policy.on_sample(echo(sensor, self.seconds, heard(place)))
            work(self.policy)

    def tell(self) -> None:
        x, y, yaw = self.odom
        self.policy.on_odometry(
            odometry(self.seconds, x, y, math.remainder(yaw, math.tau), jumps=self.jumps, instance=self.instance)
        )
        work(self.policy)

    @property
    def error(self) -> float:
        said = self.policy.pose()
        return math.dist((said.x, said.y), self.pose[:2])


def heard(place: Pose) -> float | None:
    x, y, yaw = np.array(place, np.float32)[:, None]
    expected = int(floor().sonars.models[0].table.expected(x, y, yaw)[0])
    return expected * floor().sonars.models[0].table.bin if expected < CLEAR else None


@pytest.fixture
def robot() -> Robot:
    """One that was told where it starts, and has driven on."""
    made = policy()
    robot = Robot(made, Pose(1.0, 1.5, 0.0), Pose(7.0, -3.0, 2.0))
    robot.tell()
    assert set_pose(made) == ""
    robot.drive(2.3)
    assert made.pose().state == "localized"
    return robot


@pytest.fixture
def lost() -> LocalizationPolicy:
    """It has computed all that it can, and was told nothing."""
    return policy()


def test_without_a_map_it_says_so_and_how_to_give_one() -> None:
    made = policy(NO_MAP)
    robot = Robot(made, Pose(1.0, 1.5, 0.0))
    robot.hears = False
    robot.drive(1.0)
    said = made.pose()
    assert (said.state, said.reason, said.map, said.particles) == ("no_map", NO_MAP, "", 0)
    assert made.transform() is None
    assert not made.particles().x
    assert not made.walls().walls
    assert set_pose(made) == str(NO_MAP)
    assert made.on_global(LocalizationGlobal(by="test", id=2)).reason == NO_MAP


def test_while_the_map_is_read_it_says_so_and_takes_what_it_is_told_later() -> None:
    made = LocalizationPolicy(CONFIG, ROBOT, ROOM)
    made.work()
    assert made.pose().state == "no_map"
    assert "is being read" in str(made.pose().reason)
    assert not made.no_map
    assert "is being read" in set_pose(made)
    work(made)
    assert made.pose().state == "lost"
    assert set_pose(made) == ""


def test_a_map_of_another_scale_is_none() -> None:
    scaled = FloorPlan("room", tuple((a * 1000.0, b * 1000.0, c * 1000.0, d * 1000.0) for a, b, c, d in ROOM.walls))
    made = policy(scaled)
    assert made.pose().state == "no_map"
    assert "is it in metres?" in str(made.pose().reason)
    assert str(made.no_map) == str(made.pose().reason)


def test_it_begins_lost_with_particles_all_over() -> None:
    said = policy().pose()
    assert (said.state, said.map, said.particles, said.tick) == ("lost", "room", CONFIG.most_particles, None)
    assert said.reason


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"x": 0.05}, "in a wall, too near one, or off the map"),
        ({"x": -40.0}, "in a wall, too near one, or off the map"),
        ({"x": 1e300}, "in a wall, too near one, or off the map"),
        ({"position_sd": 21.0}, "position_sd"),
        ({"yaw_sd": 90.0}, "degrees"),
    ],
)
def test_a_place_where_it_cannot_be_is_refused(lost: LocalizationPolicy, wrong: dict[str, float], words: str) -> None:
    assert words in set_pose(lost, **wrong)
    assert lost.pose().particles == CONFIG.most_particles, "and nothing has changed"


def test_a_yaw_of_any_number_of_turns_is_one(lost: LocalizationPolicy) -> None:
    assert set_pose(lost, yaw=1.0 + 8.0 * math.pi) == ""
    assert lost.pose().yaw == pytest.approx(1.0, abs=0.02)
    assert set_pose(lost, yaw=1e308, id=2) == ""
    assert abs(lost.pose().yaw) <= math.pi
    Robot(lost, Pose(1.0, 1.5, 0.0)).drive(0.5)


def test_who_is_unsure_by_metres_has_told_no_place(lost: LocalizationPolicy) -> None:
    """It then takes what any other search takes: three metres, and a restart cloud that agrees."""
    robot = Robot(lost, Pose(1.0, 1.5, 0.0))
    robot.tell()
    assert set_pose(lost, position_sd=3.0, yaw_sd=1.0) == ""
    assert lost.pose().state == "lost"
    robot.drive(2.5)
    assert lost.pose().state != "localized"


def test_a_robot_that_is_lost_says_how_unsure_it_is(lost: LocalizationPolicy) -> None:
    x, y, yaw = lost.pose().standard_deviations
    assert (x, y, yaw) == pytest.approx(
        (4.4 / math.sqrt(12.0), 2.4 / math.sqrt(12.0), math.tau / math.sqrt(12.0)), rel=0.1
    )
    assert (lost.pose().x, lost.pose().y) == pytest.approx((2.5, 1.5), abs=0.2)


def test_without_readings_it_does_not_stay_known(robot: Robot) -> None:
    robot.hears = False
    robot.drive(1.5)
    assert robot.policy.pose().state == "localized"
    robot.pose = Pose(1.0, 1.5, 0.0)
    robot.drive(2.0)
    assert robot.policy.pose().state == "lost"
    assert "giraff_ranger" in str(robot.policy.pose().reason)


def test_while_odometry_is_silent_nobody_knows_where_the_robot_goes(robot: Robot) -> None:
    robot.policy.on_silence()
    assert robot.policy.pose().state == "lost"
    assert "giraff_odometry" in str(robot.policy.pose().reason)
    assert robot.policy.transform() is None
    robot.tell()
    assert robot.policy.pose().state == "localized"
    assert robot.policy.transform() is not None


def test_a_number_of_another_count_does_not_make_it_deaf(robot: Robot) -> None:
    said = odometry(robot.seconds, *robot.odom[:2])
    robot.policy.on_odometry(msgspec.structs.replace(said, seq=2**62))
    before = robot.policy.pose()
    robot.drive(0.3)
    assert robot.policy.pose().tick != before.tick


def test_what_odometry_has_missed_has_a_bound(robot: Robot) -> None:
    lost = odometry(robot.seconds + 0.01, *robot.odom[:2], math.remainder(robot.odom.yaw, math.tau))
    robot.policy.on_odometry(msgspec.structs.replace(lost, covariance=(1e30, 0.0, 0.0, 1e30, 0.0, 1e30), breaks=1))
    work(robot.policy)
    said = robot.policy.pose()
    assert said.state == "lost"
    assert all(math.isfinite(value) for value in said.covariance)


def test_one_id_is_a_wish_of_its_own_for_each_query(lost: LocalizationPolicy) -> None:
    assert lost.on_global(LocalizationGlobal(by="test", id=1)).done
    assert set_pose(lost, id=1) == ""
    assert lost.pose().x == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_what_is_no_number_is_no_request(value: float) -> None:
    with pytest.raises(ValueError, match="not a finite number"):
        LocalizationSetPose(by="test", id=1, x=value, y=0.0, yaw=0.0)


def test_told_where_it_is_it_checks_that_before_it_says_so(lost: LocalizationPolicy) -> None:
    robot = Robot(lost, Pose(1.0, 1.5, 0.0))
    robot.tell()
    assert set_pose(lost) == ""
    said = lost.pose()
    assert (said.state, lost.transform()) == ("told", None)
    assert (said.x, said.y) == pytest.approx((1.0, 1.5), abs=0.02)
    assert said.standard_deviations == pytest.approx((0.1, 0.1, 0.1), rel=0.2)
    assert "checked" in str(said.reason)
    robot.drive(2.3)
    assert (lost.pose().state, str(lost.pose().reason)) == ("localized", "")
    assert robot.error < 0.1


def test_told_a_place_where_it_is_not_it_does_not_say_that_it_is_there(lost: LocalizationPolicy) -> None:
    robot = Robot(lost, Pose(1.0, 1.5, 0.0))
    robot.tell()
    assert set_pose(lost, x=3.5, y=1.0, yaw=2.0) == ""
    robot.drive(1.5)
    assert lost.pose().state not in ("told", "localized")


def test_one_wish_is_met_once(robot: Robot) -> None:
    assert set_pose(robot.policy, x=4.0) == ""
    assert robot.error < 0.1, "the id was met before"
    assert set_pose(robot.policy, x=4.0, id=9) == ""
    assert robot.policy.pose().x == pytest.approx(4.0, abs=0.02)


def test_it_is_where_odometry_has_brought_it_since_the_last_update(robot: Robot) -> None:
    before = robot.policy.pose()
    robot.odom = robot.odom.moved(0.05, 0.0)
    robot.seconds += 0.01
    robot.tell()
    after = robot.policy.pose()
    assert math.dist((before.x, before.y), (after.x, after.y)) == pytest.approx(0.05, abs=1e-6)
    assert (after.odom.x, after.odom.y, after.odom.yaw) == pytest.approx(
        (before.odom.x, before.odom.y, before.odom.yaw)
    )


def test_odom_is_in_the_map_where_it_takes_the_robot_to_be(robot: Robot) -> None:
    said, transform = robot.policy.pose(), robot.policy.transform()
    assert transform is not None
    assert (transform.parent, transform.child) == ("map", "odom")
    assert (transform.x, transform.y, transform.yaw) == pytest.approx((said.odom.x, said.odom.y, said.odom.yaw))
    here = robot.odom.placed_in(Pose(said.odom.x, said.odom.y, said.odom.yaw))
    assert here == pytest.approx((said.x, said.y, said.yaw))


def test_a_pose_that_was_set_in_odom_moves_odom_and_not_the_robot(robot: Robot) -> None:
    before = robot.policy.pose()
    robot.odom, robot.jumps = Pose(100.0, 50.0, -1.0), 1
    robot.seconds += 0.01
    robot.tell()
    after = robot.policy.pose()
    assert after.state == "localized"
    assert (after.x, after.y, after.yaw) == pytest.approx((before.x, before.y, before.yaw))
    transform = robot.policy.transform()
    assert transform is not None
    here = robot.odom.placed_in(Pose(transform.x, transform.y, transform.yaw))
    assert here == pytest.approx((after.x, after.y, after.yaw))
    robot.drive(1.0, turn=1.0)
    assert robot.error < 0.15


def test_odometry_that_was_started_again_goes_on_where_the_robot_was(robot: Robot) -> None:
    robot.odom, robot.instance = Pose(0.0, 0.0, 0.0), "two"
    robot.seconds += 0.5
    robot.tell()
    said = robot.policy.pose()
    assert robot.error < 0.3
    assert said.standard_deviations[0] > 0.1, "and is less sure of it"


def test_odometry_that_was_gone_for_long_leaves_it_in_doubt(robot: Robot) -> None:
    robot.odom, robot.instance = Pose(0.0, 0.0, 0.0), "two"
    robot.seconds += 60.0
    robot.tell()
    assert robot.policy.pose().state != "localized"
    assert robot.policy.transform() is None


def test_asked_to_look_anywhere_it_begins_anew(robot: Robot) -> None:
    assert robot.policy.on_global(LocalizationGlobal(by="test", id=3)).done
    said = robot.policy.pose()
    assert (said.state, said.particles) == ("lost", CONFIG.most_particles)
    assert robot.policy.transform() is None
    assert robot.policy.on_global(LocalizationGlobal(by="test", id=3)).done
    assert robot.policy.pose() == said


def test_a_robot_that_stands_learns_nothing(robot: Robot) -> None:
    before = robot.policy.pose()
    for _ in range(200):
        robot.seconds += 0.05
        robot.tell()
        robot.policy.on_sample(echo("rear", robot.seconds, 3.3))
    after = robot.policy.pose()
    assert (after.covariance, after.explained) == (before.covariance, before.explained)


@pytest.mark.parametrize("strange", ["fault", "no tick", "another sensor", "another start"])
def test_a_reading_that_says_nothing_counts_for_nothing(robot: Robot, strange: str) -> None:
    robot.hears = False
    reading = echo("rear", robot.seconds, 0.5)
    bad: dict[str, Range] = {
        "fault": msgspec.structs.replace(reading, state="fault", range=None, reason=Trouble("dead")),
        "no tick": msgspec.structs.replace(reading, tick=None),
        "another sensor": msgspec.structs.replace(reading, sensor="top"),
        "another start": msgspec.structs.replace(reading, tick=RobotTime(epoch=99, robot_ns=1)),
    }
    explained = robot.policy.pose().explained
    for _ in range(300):
        robot.policy.on_sample(bad[strange])
    robot.drive(0.2)
    assert robot.policy.pose().explained == explained


def test_memory_stays_flat(lost: LocalizationPolicy) -> None:
    """However long nothing else comes, and whatever comes."""
    for number in range(3000):
        lost.on_sample(echo("rear", 1e6 + number, 1.0))
    robot = Robot(lost, Pose(1.0, 1.5, 0.0))
    for number in range(500):
        robot.seconds += 0.01
        robot.tell()
        lost.on_sample(echo("rear", robot.seconds, 1.0))
        if number < 100:
            lost.on_global(LocalizationGlobal(by="test", id=number + 1))
    search = lost._search
    assert isinstance(search, Filter)
    assert len(search._readings._waiting) <= 100
    assert all(len(each) <= 12 for each in search._readings._heard.values())
    assert len(lost._track._moments) <= 400
    assert len(lost._granted) <= 64


def test_particles_are_shown_by_the_hundred(robot: Robot) -> None:
    shown = robot.policy.particles()
    assert len(shown.x) == 300
    assert policy().walls().walls == ROOM.walls


def test_the_same_seed_is_the_same_search() -> None:
    def said(seed: int) -> MapPose:
        robot = Robot(policy(seed=seed), Pose(1.0, 1.5, 0.0))
        robot.drive(1.0)
        return robot.policy.pose()

    assert said(1) == said(1) != said(2)

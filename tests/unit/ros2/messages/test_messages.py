"""ROS messages of samples: values worked out by hand, and random ones read back by a decoder of somebody else."""

import dataclasses
import math
from collections.abc import Callable, Mapping
from functools import cache
from itertools import pairwise
from operator import attrgetter
from random import Random
from types import MappingProxyType
from typing import Any, Final, NamedTuple
from unittest.mock import MagicMock
from xml.etree import ElementTree as ET

import msgspec
import numpy as np
import pytest
from mcap_ros2._dynamic import generate_dynamic
from rosbags.typesys import Stores, get_typestore

from giraff_core.kinematics.parts import PartPose
from giraff_core.latest import LatestSamples
from giraff_core.robot import RobotConfig
from giraff_core.senses import Bumper, Camera, Ultrasonic
from giraff_ros2.messages import pose, sensors
from giraff_ros2.messages.diagnostics import diagnostics
from giraff_ros2.messages.header import quaternion, stamp
from giraff_ros2.messages.occupancy import occupancy
from giraff_ros2.messages.urdf import urdf
from giraff_ros2.robot_in_ros import RobotInRos
from giraff_ros2.topics import PLAN
from giraff_schemas.bumper import Bump
from giraff_schemas.camera import Picture
from giraff_schemas.localization import MapPose, MapWalls, PlanarPose
from giraff_schemas.messages import (
    BaseState,
    Battery,
    BoardState,
    DirectionLimit,
    EStop,
    GuardState,
    Lease,
    Odometry,
    Range,
    RangeState,
    RobotTime,
    SensorState,
    Tilt,
)
from giraff_schemas.places import NO_ROUTE, Goal, RouteState
from giraff_schemas.trouble import Trouble

SAMPLES: Final = 200
"""Random samples of each type."""
TICK: Final = RobotTime(epoch=1, robot_ns=1)
AT: Final = 1_700_000_000_123_456_789
STORE: Final = get_typestore(Stores.ROS2_KILTED)
SINGLES: Final = {
    *("field_of_view", "min_range", "max_range", "range", "variance", "resolution", "voltage", "temperature"),
    *("current", "charge", "capacity", "design_capacity", "percentage"),
}
"""Fields of 32 bits."""
FRONT: Final = Ultrasonic(index=0, x=0.1, y=0.02, z=0.05, yaw=0.5, half_cone=0.25, reach=3.0)
ROBOT: Final = RobotConfig(
    name="r<1>",
    track_width=0.2,
    ticks_per_metre=1000.0,
    max_wheel_speed=0.5,
    max_angular_speed=2.0,
    footprint_radius=0.15,
    sensors={"front": FRONT, "head": Camera(x=0.05, z=0.2)},
    frames={"mast": PartPose(z=0.3), "tip": PartPose(parent="mast", x=0.1, yaw=math.pi / 2)},
)


def an_odometry(random: Random) -> Odometry:
    return Odometry(
        stamp_ns=random.randrange(2**60),
        x=random.uniform(-50.0, 50.0),
        y=random.uniform(-50.0, 50.0),
        yaw=random.uniform(-math.pi, math.pi),
        linear_x=random.gauss(0.0, 1.0),
        angular_z=random.gauss(0.0, 1.0),
        covariance=six(random),
        path=1.0,
        board_us=0,
        boot_id=1,
        tick=TICK,
    )


def a_map_pose(random: Random) -> MapPose:
    return MapPose(
        stamp_ns=random.randrange(2**60),
        state=random.choice(("localized", "told")),
        x=random.uniform(-50.0, 50.0),
        y=random.uniform(-50.0, 50.0),
        yaw=random.uniform(-math.pi, math.pi),
        covariance=six(random),
        odom=PlanarPose(x=random.gauss(0.0, 9.0), y=random.gauss(0.0, 9.0), yaw=random.uniform(-3.0, 3.0)),
        candidates=(),
        explained=1.0,
        way=0.0,
        particles=1,
        map="flat",
        tick=None,
    )


def six(random: Random) -> tuple[float, float, float, float, float, float]:
    first, second, third, fourth, fifth, sixth = (random.random() for _ in range(6))
    return first, second, third, fourth, fifth, sixth


def a_route(random: Random) -> RouteState:
    corners = tuple((random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0)) for _ in range(random.randrange(4)))
    return msgspec.structs.replace(NO_ROUTE, stamp_ns=random.randrange(2**60), corners=corners)


def a_range(random: Random) -> Range:
    states: tuple[RangeState, ...] = ("echo", "clear", "fault")
    state = random.choice(states)
    metres = random.uniform(0.02, 4.0) if state == "echo" else None
    moment = random.randrange(2**60)
    return Range(stamp_ns=moment, sensor="front", state=state, range=metres, echo_us=0, tick=None)


def a_tilt(random: Random) -> Tilt:
    x, y, z = (random.gauss(0.0, 9.0) for _ in range(3))
    return Tilt(stamp_ns=random.randrange(2**60), x=x, y=y, z=z, status="running", tick=None)


def a_battery(random: Random) -> Battery:
    return Battery(stamp_ns=random.randrange(2**60), voltage=random.uniform(0.0, 30.0))


def a_picture(random: Random) -> Picture:
    jpeg = random.randbytes(random.randrange(300))
    return Picture(stamp_ns=random.randrange(2**60), camera="head", jpeg=jpeg, width=1, height=1, tick=None)


def some_walls(random: Random) -> MapWalls:
    walls = tuple(tuple(random.uniform(-2.0, 2.0) for _ in range(4)) for _ in range(random.randrange(6)))
    return msgspec.convert({"map": "flat", "walls": walls, "stamp_ns": random.randrange(2**60)}, MapWalls)


def walls_message(walls: MapWalls) -> Any:
    return occupancy(walls, walls.stamp_ns)


class Case(NamedTuple):
    """A sample's type, its message, and where the decoded message has the sample's fields."""

    sample: Callable[[Random], Any]
    message: Callable[[Any], Any]
    type: str
    fields: Mapping[str, str] = MappingProxyType({})


CASES: Final = [
    Case(
        an_odometry,
        pose.odometry,
        "nav_msgs/msg/Odometry",
        {
            "pose.pose.position.x": "x",
            "pose.pose.position.y": "y",
            "twist.twist.linear.x": "linear_x",
            "twist.twist.angular.z": "angular_z",
        },
    ),
    Case(an_odometry, pose.odom_transform, "tf2_msgs/msg/TFMessage"),
    Case(a_map_pose, pose.map_transform, "tf2_msgs/msg/TFMessage"),
    Case(
        a_map_pose,
        pose.amcl_pose,
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        {"pose.pose.position.x": "x", "pose.pose.position.y": "y"},
    ),
    Case(a_route, pose.path, "nav_msgs/msg/Path"),
    Case(a_range, lambda sample: sensors.range_reading(sample, FRONT), "sensor_msgs/msg/Range"),
    Case(
        a_tilt,
        sensors.imu,
        "sensor_msgs/msg/Imu",
        {f"linear_acceleration.{axis}": axis for axis in "xyz"},
    ),
    Case(
        a_battery,
        sensors.battery,
        "sensor_msgs/msg/BatteryState",
    ),
    Case(a_picture, sensors.picture, "sensor_msgs/msg/CompressedImage", {"data": "jpeg"}),
    Case(some_walls, walls_message, "nav_msgs/msg/OccupancyGrid"),
]


@pytest.mark.parametrize("case", CASES, ids=[f"{case.sample.__name__}-{case.type}" for case in CASES])
def test_another_decoder_reads_every_value(case: Case) -> None:
    random = Random(case.type)
    for _ in range(SAMPLES):
        sample = case.sample(random)
        message = case.message(sample)
        read = decoded(message, case.type)
        assert_same(message, read)
        for place, field in case.fields.items():
            assert attrgetter(place)(read) == getattr(sample, field)
        if hasattr(read, "header"):
            assert read.header.stamp.sec * 10**9 + read.header.stamp.nanosec == sample.stamp_ns


def decoded(message: Any, type_name: str) -> Any:
    return decoder(type_name)(bytes(STORE.serialize_cdr(message, type_name)))


@cache
def decoder(type_name: str) -> Callable[[bytes], Any]:
    text, _ = STORE.generate_msgdef(type_name, ros_version=2)
    read: Callable[[bytes], Any] = generate_dynamic(type_name, text)[type_name]
    return read


def assert_same(ours: Any, theirs: Any, name: str = "") -> None:
    if dataclasses.is_dataclass(ours):
        for field in (each for each in dataclasses.fields(ours) if each.name.islower() and each.name[0] != "_"):
            assert_same(getattr(ours, field.name), getattr(theirs, field.name), field.name)
    elif isinstance(ours, list | np.ndarray):
        assert len(ours) == len(theirs), name
        for our, their in zip(ours, theirs, strict=True):
            assert_same(our, their, name)
    elif name in SINGLES:
        assert np.float32(ours) == np.float32(theirs) or (math.isnan(ours) and math.isnan(theirs)), name
    else:
        assert ours == theirs, name


def test_poses_by_hand() -> None:
    sample = msgspec.structs.replace(
        an_odometry(Random(1)), stamp_ns=AT, x=1.0, y=2.0, yaw=math.pi / 2, covariance=(1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    )
    message = pose.odometry(sample)
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1_700_000_000, 123_456_789)
    assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_link")
    turned = message.pose.pose.orientation
    assert (turned.x, turned.y, turned.z, turned.w) == pytest.approx((0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5)))
    expected = {0: 1.0, 1: 2.0, 5: 3.0, 6: 2.0, 7: 4.0, 11: 5.0, 30: 3.0, 31: 5.0, 35: 6.0}
    assert message.pose.covariance.tolist() == [expected.get(place, 0.0) for place in range(36)]
    (transform,) = pose.odom_transform(sample).transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_link")
    assert (transform.transform.translation.x, transform.transform.translation.y) == (1.0, 2.0)
    lost = msgspec.structs.replace(a_map_pose(Random(1)), state="lost")
    assert pose.map_transform(lost) is None
    assert pose.amcl_pose(lost) is None
    known = a_map_pose(Random(1))
    assert (odom := pose.map_transform(known)) is not None
    assert (odom.transforms[0].header.frame_id, odom.transforms[0].child_frame_id) == ("map", "odom")
    assert odom.transforms[0].transform.translation.x == known.odom.x
    assert (stamp(2**63).sec, stamp(-1).sec) == (2**31 - 1, 0)


def test_a_route_is_shown_where_it_changes_and_no_more_once_it_has_ended() -> None:
    port = MagicMock(**{"wall_ns.return_value": AT})
    shown, goal = RobotInRos(ROBOT, port, None, "ros2@desk"), Goal(x=2.0, y=2.0, yaw=math.pi)
    port.reset_mock()
    shown.on_sample(NO_ROUTE, 0.0)
    route = msgspec.structs.replace(NO_ROUTE, stage="moving", goal=goal, corners=((0.0, 0.0), (2.0, 0.0), (2.0, 2.0)))
    for stage in ("moving", "waiting", "ended", "ended"):
        shown.on_sample(msgspec.structs.replace(route, stage=stage), 0.0)
    (way, cleared) = (call.args[1] for call in port.publish.call_args_list if call.args[0] == PLAN)
    assert way.header.frame_id == "map"
    assert [(each.pose.position.x, each.pose.position.y) for each in way.poses] == [*route.corners]
    assert [each.pose.orientation.z for each in way.poses] == pytest.approx([0.0, math.sqrt(0.5), 1.0])
    assert cleared.poses == []


def test_optical_frame_looks_along_z() -> None:
    parts = {each.child_frame_id: each for each in pose.static_transforms(ROBOT, AT).transforms}
    optical = parts["camera_head_optical_frame"]
    assert optical.header.frame_id == "camera_head_link"
    turned = optical.transform.rotation
    # Its z is the camera's x, its x the camera's -y, its y the camera's -z: a turn of 120 degrees about (-1, 1, -1).
    assert (turned.x, turned.y, turned.z, turned.w) == pytest.approx((-0.5, 0.5, -0.5, 0.5))
    roll = quaternion(0.2, 0.0, 0.0)
    assert (roll.x, roll.w) == pytest.approx((math.sin(0.1), math.cos(0.1)))


def test_readings_by_hand() -> None:
    echo = msgspec.structs.replace(a_range(Random(1)), state="echo", range=1.5)
    message = sensors.range_reading(echo, FRONT)
    assert (message.header.frame_id, message.radiation_type, message.range) == ("range_front_link", 0, 1.5)
    assert (message.field_of_view, message.min_range, message.max_range) == (0.5, 0.02, 3.0)
    clear = msgspec.structs.replace(echo, state="clear", range=None)
    assert sensors.range_reading(clear, FRONT).range == math.inf
    assert math.isnan(sensors.range_reading(msgspec.structs.replace(clear, state="fault"), FRONT).range)
    tilt = Tilt(x=0.0, y=1.0, z=9.8, status="running", tick=None)
    assert (hand := sensors.imu(tilt)) is not None
    assert hand.header.frame_id == "hand_link"
    assert (hand.orientation_covariance[0], hand.angular_velocity_covariance[0]) == (-1.0, -1.0)
    assert sensors.imu(msgspec.structs.replace(tilt, status="bus_fault")) is None
    charge = sensors.battery(Battery(voltage=7.4))
    assert (charge.voltage, charge.present, math.isnan(charge.percentage)) == (7.4, True, True)
    huge = sensors.battery(Battery(voltage=1e300))  # a number beyond 32 bits ends no service
    assert decoded(huge, "sensor_msgs/msg/BatteryState").voltage == math.inf


def test_grid_by_hand() -> None:
    corners = [(0.0, 0.0), (0.2, 0.0), (0.2, 0.15), (0.0, 0.15), (0.0, 0.0)]
    walls = tuple((*begin, *end) for begin, end in pairwise(corners))
    grid = occupancy(MapWalls(map="flat", walls=walls), AT)
    assert (grid.info.width, grid.info.height, grid.info.resolution) == (9, 8, 0.05)
    assert (grid.info.origin.position.x, grid.info.origin.position.y) == pytest.approx((-0.125, -0.125))
    rows = ["".join({100: "#", 0: ".", -1: " "}[int(cell)] for cell in row) for row in grid.data.reshape(8, 9)]
    assert [row.strip() for row in rows] == ["", "", "#####", "#...#", "#...#", "#####", "", ""]
    opened = occupancy(MapWalls(map="flat", walls=walls[:3]), AT)
    assert 0 not in opened.data.tolist()  # a room without one of its walls has no inside
    assert occupancy(MapWalls(map="flat", walls=()), AT).info.width == 0
    hall = occupancy(MapWalls(map="flat", walls=((-150.0, -150.0, 150.0, 150.0), (0.0, 0.0, 1e300, 0.0))), AT)
    assert hall.info.width * hall.info.height <= 250_000
    assert hall.info.resolution == 0.8  # 300 m are 375 cells then; the wall beyond all homes is left out
    tips = [(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
    slanted = occupancy(MapWalls(map="flat", walls=tuple((*begin, *end) for begin, end in pairwise(tips))), AT)
    cells = slanted.data.reshape(slanted.info.height, slanted.info.width)
    assert (cells[22, 22], cells[22, 5], cells[2, 2]) == (0, 0, -1)  # its middle, just inside a tip, a corner


def test_description_has_the_frames_of_the_transforms() -> None:
    root = ET.fromstring(urdf(ROBOT))  # noqa: S314
    assert root.get("name") == "r<1>"
    fixed = pose.static_transforms(ROBOT, AT).transforms
    joints = []
    for joint in root.iter("joint"):
        (parent,), (child,), (origin,) = joint.iter("parent"), joint.iter("child"), joint.iter("origin")
        assert joint.get("type") == "fixed"
        turned = quaternion(*map(float, origin.attrib["rpy"].split()))
        joints.append((parent.get("link"), child.get("link"), [*map(float, origin.attrib["xyz"].split())], turned))
    assert joints == [
        (each.header.frame_id, each.child_frame_id, [at.x, at.y, at.z], each.transform.rotation)
        for each in fixed
        for at in [each.transform.translation]
    ]
    links = [link.get("name") for link in root.iter("link")]
    assert links == ["base_link", *(each.child_frame_id for each in fixed)]
    assert len({*links}) == len(links)
    wheels = [each.attrib["xyz"] for each in root.findall("link[@name='base_link']/visual/origin")][1:]
    assert wheels == ["0 0.1 0.033", "0 -0.1 0.033"]


def test_diagnostics_by_hand() -> None:
    newest = LatestSamples()
    newest.add(EStop(engaged=True, id=1, by="web", reason=Trouble("pressed; reset it")), 9.8)
    newest.add(Lease(holder="a", operator="keyboard", counter=3), 9.5)
    newest.add(Battery(voltage=7.4), 2.0)
    board = BoardState(
        connected=True, boot_id=1, drive_state="", latch="", last_refusal="", accepted=0, refused=0, line_errors=0
    )
    base = BaseState(armed=False, driving=False, guard="", round_trip=None, budget_left=0.25, board=board)
    newest.add(base, 9.9)
    newest.add(
        deaf := Range(
            sensor="front", state="fault", range=None, echo_us=0, reason=Trouble("no echo; look at its plug"), tick=None
        ),
        9.9,
    )
    newest.add(Bump(sensor="rim", pressed=True, tick=None), 9.9)
    free = DirectionLimit(allowed=0.5, clearance="free", sensor="")
    newest.add(
        GuardState(
            forward=free,
            backward=free,
            turn_left=free,
            turn_right=free,
            operator="a",
            reason=Trouble("a wall is near"),
            sensors={
                "front": SensorState(type=Ultrasonic.type_name()),
                "rim": SensorState(type=Bumper.type_name()),
                "rear": SensorState(type=Ultrasonic.type_name(), trouble=Trouble("it is deaf", "clean it")),
            },
        ),
        9.9,
    )
    told = diagnostics(AT, "r1", newest, 10_000_000_000)
    assert {each.name: (each.level, each.message) for each in told.status} == {
        "r1: base": (0, "not armed"),
        "r1: guard": (1, "a wall is near"),
        "r1: emergency stop": (2, "pressed; reset it"),
        "r1: lease": (0, "keyboard drives"),
        "r1: battery": (3, "nothing was heard of it for 8 s; run `giraff doctor` on the robot"),
        "r1: sensor front": (2, str(deaf.reason)),
        "r1: sensor rim": (0, "pushed"),
        "r1: sensor rear": (1, "it is deaf; clean it"),
    }
    assert {each.hardware_id for each in told.status} == {"r1"}
    values = {value.key: value.value for value in told.status[0].values}
    assert (values["armed"], values["round trip (s)"], values["budget left (s)"]) == ("no", "unknown", "0.250")
    assert_same(told, decoded(told, "diagnostic_msgs/msg/DiagnosticArray"))
    silent = diagnostics(AT, "r1", LatestSamples(), 0)
    assert {each.level for each in silent.status} == {3}

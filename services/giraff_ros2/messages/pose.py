"""Places of the robot and its parts as ROS messages."""

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Point as Point
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Pose as Pose
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__PoseStamped as StampedPlace
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__PoseWithCovariance as PoseWithCovariance
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__PoseWithCovarianceStamped as StampedPose
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Transform as RosTransform
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__TransformStamped as TransformStamped
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Twist as Twist
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__TwistWithCovariance as TwistWithCovariance
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Vector3 as Vector3
from rosbags.typesys.stores.ros2_kilted import nav_msgs__msg__Odometry as RosOdometry
from rosbags.typesys.stores.ros2_kilted import nav_msgs__msg__Path as Path
from rosbags.typesys.stores.ros2_kilted import tf2_msgs__msg__TFMessage as TFMessage

from giraff_core.robot import RobotConfig
from giraff_core.senses import Camera
from giraff_ros2.messages.header import header, quaternion
from giraff_schemas.frames import BASE_FRAME, MAP_FRAME, ODOM_FRAME, Transform, camera_frame
from giraff_schemas.localization import MapPose
from giraff_schemas.messages import Odometry
from giraff_schemas.places import RouteState

if TYPE_CHECKING:
    from numpy.typing import NDArray

_KNOWN: Final = ("localized", "told")
_X, _Y, _YAW = 0, 1, 5  # rows of ROS's covariance of x, y, z, roll, pitch, yaw
_OPTICAL: Final = (-math.pi / 2, 0.0, -math.pi / 2)
"""Roll, pitch and yaw (rad) of an optical frame in its camera's: z ahead, x to the right, y down (REP-103)."""

_UNKNOWN: Final = np.zeros(36)


def optical_frame(camera: str) -> str:
    """Return the frame of a camera's pictures."""
    return f"camera_{camera}_optical_frame"


def odometry(sample: Odometry) -> RosOdometry:
    """Return the pose in `odom`, and the twist in `base_link`.

    The covariance of the twist is zero, which stands for unknown: the robot computes none.
    """
    twist = Twist(Vector3(sample.linear_x, 0.0, 0.0), Vector3(0.0, 0.0, sample.angular_z))
    return RosOdometry(
        header(sample.stamp_ns, ODOM_FRAME),
        BASE_FRAME,
        _pose(sample),
        TwistWithCovariance(twist, _UNKNOWN),
    )


def odom_transform(sample: Odometry) -> TFMessage:
    """Return where `base_link` is in `odom`."""
    return _planar(sample.stamp_ns, ODOM_FRAME, BASE_FRAME, (sample.x, sample.y, sample.yaw))


def map_transform(pose: MapPose) -> TFMessage | None:
    """Return where `odom` is in `map`; None while the robot's place is not known."""
    if pose.state not in _KNOWN:
        return None
    return _planar(pose.stamp_ns, MAP_FRAME, ODOM_FRAME, (pose.odom.x, pose.odom.y, pose.odom.yaw))


def amcl_pose(pose: MapPose) -> StampedPose | None:
    """Return where `base_link` is in `map`; None while that is not known."""
    return StampedPose(header(pose.stamp_ns, MAP_FRAME), _pose(pose)) if pose.state in _KNOWN else None


def corners_ahead(route: RouteState) -> tuple[tuple[float, float], ...]:
    """Return the corners of a route; none once it has ended."""
    return () if route.stage == "ended" else route.corners


def path(route: RouteState) -> Path:
    """Return the corners of a route, each turned along the leg from it, and the last one as the goal has it."""
    corners = corners_ahead(route)
    yaws = [math.atan2(end[1] - begin[1], end[0] - begin[0]) for begin, end in pairwise(corners)] or [0.0]
    yaws.append(yaws[-1] if route.goal is None or route.goal.yaw is None else route.goal.yaw)
    head = header(route.stamp_ns, MAP_FRAME)
    places = (Pose(Point(x, y, 0.0), quaternion(0.0, 0.0, yaw)) for (x, y), yaw in zip(corners, yaws, strict=False))
    return Path(head, [StampedPlace(head, place) for place in places])


def fixed_parts(robot: RobotConfig) -> list[Transform]:
    """Return where the robot's parts are: sensors, cameras and their optical frames, `[robot.frames]`."""
    parts = [*robot.sensor_transforms.values()]
    for name in robot.of(Camera):
        if optical_frame(name) not in robot.frames:  # a robot file that has one means it
            roll, pitch, yaw = _OPTICAL
            parent, child = camera_frame(name), optical_frame(name)
            parts.append(
                Transform(parent=parent, child=child, x=0.0, y=0.0, roll=roll, pitch=pitch, yaw=yaw, fixed=True)
            )
    return parts + [part.transform(name) for name, part in robot.frames.items()]


def static_transforms(robot: RobotConfig, stamp_ns: int) -> TFMessage:
    """Return where the robot's parts are."""
    return TFMessage([_stamped(stamp_ns, part) for part in fixed_parts(robot)])


def _planar(stamp_ns: int, parent: str, child: str, pose: tuple[float, float, float]) -> TFMessage:
    x, y, yaw = pose
    return TFMessage([_stamped(stamp_ns, Transform(parent=parent, child=child, x=x, y=y, yaw=yaw, fixed=False))])


def _stamped(stamp_ns: int, part: Transform) -> TransformStamped:
    place = RosTransform(Vector3(part.x, part.y, part.z), quaternion(part.roll, part.pitch, part.yaw))
    return TransformStamped(header(stamp_ns, part.parent), part.child, place)


def _pose(sample: Odometry | MapPose) -> PoseWithCovariance:
    place = Pose(Point(sample.x, sample.y, 0.0), quaternion(0.0, 0.0, sample.yaw))
    return PoseWithCovariance(place, _covariance(sample.covariance))


def _covariance(planar: tuple[float, float, float, float, float, float]) -> "NDArray[np.float64]":
    """Return ROS's covariance of six axes, row by row.

    That of z, roll and pitch is zero: by definition they are zero on the floor. amcl writes the same, and rviz draws a
    flat ellipse by it. A large number would become a column of that height there.
    """
    full = np.zeros((6, 6))
    full[_X, _X], full[_X, _Y], full[_X, _YAW], full[_Y, _Y], full[_Y, _YAW], full[_YAW, _YAW] = planar
    full[_Y, _X], full[_YAW, _X], full[_YAW, _Y] = planar[1], planar[2], planar[4]
    return full.ravel()

"""Says to ROS what the robot says."""

from collections.abc import Callable
from typing import Any, Final

from rosbags.typesys.stores.ros2_kilted import std_msgs__msg__String as String

from giraff_core.latest import LatestSamples
from giraff_core.picture.receiver import OpenSource, PictureReceiver
from giraff_core.robot import RobotConfig
from giraff_core.senses import Camera, LaserScanner, Ultrasonic
from giraff_core.timer import Timer
from giraff_ros2 import topics as ros
from giraff_ros2.messages import pose, sensors
from giraff_ros2.messages.diagnostics import diagnostics
from giraff_ros2.messages.occupancy import occupancy
from giraff_ros2.messages.scan import laser_scan
from giraff_ros2.messages.urdf import urdf
from giraff_ros2.port import RosPort
from giraff_ros2.topics import RosTopic
from giraff_schemas.localization import MapPose, MapWalls
from giraff_schemas.messages import Battery, Odometry, Range, Sample, Tilt
from giraff_schemas.places import RouteState
from giraff_schemas.scan import LaserScan

_DIAGNOSTICS_HZ: Final = 1.0
_APART: Final = 1.0  # s between two starts to look at a camera


def published(robot: RobotConfig) -> tuple[RosTopic, ...]:
    """Return what this robot's node publishes, without a `*`."""
    names = {ros.RANGE: [*robot.of(Ultrasonic)], ros.SCAN: [*robot.of(LaserScanner)], ros.CAMERA: [*robot.of(Camera)]}
    return tuple(
        row
        for topic in ros.PUBLISHED
        for row in ([topic.at(name) for name in names[topic]] if topic in names else [topic])
    )


class RobotInRos:
    """Writes the topics of `PUBLISHED` but the emergency stop's. Times are monotonic, s."""

    def __init__(self, robot: RobotConfig, port: RosPort, open_source: OpenSource | None, by: str) -> None:
        """`open_source`: looks at a camera; None: ROS is shown no pictures. `by`: who looks, for people."""
        self._robot, self._ros = robot, port
        self._sensors, self._scanners, self._cameras = robot.of(Ultrasonic), robot.of(LaserScanner), robot.of(Camera)
        self._newest = LatestSamples()
        self._timer = Timer(_DIAGNOSTICS_HZ)
        self._pictures = PictureReceiver(open_source, by, _APART)
        self._walls: object = None
        self._corners: object = ()
        port.publish(ros.ROBOT_DESCRIPTION, String(urdf(robot)))
        port.publish(ros.TF_STATIC, pose.static_transforms(robot, port.wall_ns()))

    def on_sample(self, sample: Sample, now: float) -> None:
        """Say what the robot has said."""
        self._newest.add(sample, now)
        self._say(sample)

    def turn(self, now: float) -> None:
        """Say what is due by time: diagnostics, and pictures of the cameras that a ROS program subscribes to."""
        if self._timer.due(now):
            told = diagnostics(self._ros.wall_ns(), self._robot.name, self._newest, round(now * 1e9))
            self._ros.publish(ros.DIAGNOSTICS, told)
        for name in self._cameras:
            if not self._ros.is_wanted(topic := ros.CAMERA.at(name)):
                self._pictures.leave(name)
            elif (seen := self._pictures.ask(name, now)) is not None:
                self._ros.publish(topic, sensors.picture(seen))

    def close(self) -> None:
        """Look at no camera any more."""
        self._pictures.close()

    def _say(self, sample: Sample) -> None:
        match sample:
            case Odometry():
                self._put(ros.ODOM, pose.odometry, sample)
                self._put(ros.TF, pose.odom_transform, sample)
            case Range() if (sensor := self._sensors.get(sample.sensor)) is not None:
                self._ros.publish(ros.RANGE.at(sample.sensor), sensors.range_reading(sample, sensor))
            case LaserScan() if (scanner := self._scanners.get(sample.sensor)) is not None:
                self._ros.publish(ros.SCAN, laser_scan(sample, scanner))
            case Tilt():
                self._put(ros.HAND_IMU, sensors.imu, sample)
            case Battery():
                self._put(ros.BATTERY, sensors.battery, sample)
            case MapPose():
                self._put(ros.TF, pose.map_transform, sample)
                self._put(ros.POSE, pose.amcl_pose, sample)
            case RouteState() if (corners := pose.corners_ahead(sample)) != self._corners:
                self._corners = corners  # said five times a second, and changed where it is planned anew
                self._ros.publish(ros.PLAN, pose.path(sample))
            case MapWalls() if (sample.map, sample.walls) != self._walls:
                self._walls = sample.map, sample.walls  # said every five seconds, and computed once
                self._ros.publish(ros.MAP, occupancy(sample, sample.stamp_ns))

    def _put(self, topic: RosTopic, make: Callable[[Any], Any], sample: Sample) -> None:
        if (message := make(sample)) is not None:
            self._ros.publish(topic, message)

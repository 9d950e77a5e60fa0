"""The table of ROS topics: the only place where their names, types and QoS are written."""

from typing import Final, NamedTuple


class Qos(NamedTuple):
    """Quality of service, as ROS tools show it. Zenoh delivers whatever it is."""

    depth: int = 10
    is_reliable: bool = True
    is_latched: bool = False
    """Transient local: who comes later is given the newest ones."""


SENSOR: Final = Qos(depth=5, is_reliable=False)
LATCHED: Final = Qos(depth=1, is_latched=True)


class RosTopic(NamedTuple):
    """One row of the table. `*` in a name stands for one sensor or camera, given with `at`."""

    name: str
    """In the robot's namespace; with `~/` first, below the node's own name."""
    type: str
    """As ROS writes it: `nav_msgs/msg/Odometry`."""
    qos: Qos = Qos()

    def at(self, name: str) -> "RosTopic":
        """Return the row of one sensor or camera."""
        return self._replace(name=self.name.replace("*", name))


NODE: Final = "giraff"
"""Name of the robot's node."""

ODOM: Final = RosTopic("odom", "nav_msgs/msg/Odometry")
TF: Final = RosTopic("tf", "tf2_msgs/msg/TFMessage", Qos(depth=100))
TF_STATIC: Final = RosTopic("tf_static", "tf2_msgs/msg/TFMessage", LATCHED)
RANGE: Final = RosTopic("range/*", "sensor_msgs/msg/Range", SENSOR)
SCAN: Final = RosTopic("scan", "sensor_msgs/msg/LaserScan", SENSOR)
HAND_IMU: Final = RosTopic("hand/imu", "sensor_msgs/msg/Imu", SENSOR)
BATTERY: Final = RosTopic("battery_state", "sensor_msgs/msg/BatteryState")
DIAGNOSTICS: Final = RosTopic("diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
MAP: Final = RosTopic("map", "nav_msgs/msg/OccupancyGrid", LATCHED)
POSE: Final = RosTopic("amcl_pose", "geometry_msgs/msg/PoseWithCovarianceStamped", LATCHED)
PLAN: Final = RosTopic("plan", "nav_msgs/msg/Path", LATCHED)
CAMERA: Final = RosTopic("camera/*/compressed", "sensor_msgs/msg/CompressedImage", SENSOR)
ROBOT_DESCRIPTION: Final = RosTopic("robot_description", "std_msgs/msg/String", LATCHED)
ESTOP_ENGAGED: Final = RosTopic("~/estop_engaged", "std_msgs/msg/Bool", LATCHED)

PUBLISHED: Final = (
    *(ODOM, TF, TF_STATIC, RANGE, SCAN, HAND_IMU, BATTERY, DIAGNOSTICS),
    *(MAP, POSE, PLAN, CAMERA, ROBOT_DESCRIPTION, ESTOP_ENGAGED),
)

CMD_VEL: Final = RosTopic("cmd_vel", "geometry_msgs/msg/Twist")
CMD_VEL_STAMPED: Final = RosTopic("cmd_vel", "geometry_msgs/msg/TwistStamped")
GOAL_POSE: Final = RosTopic("goal_pose", "geometry_msgs/msg/PoseStamped")

SUBSCRIBED: Final = (CMD_VEL, CMD_VEL_STAMPED, GOAL_POSE)

ESTOP: Final = RosTopic("~/estop", "std_srvs/srv/Trigger")
"""A service."""

"""A real ROS node, told on standard input what to do; it answers in JSON lines. Runs in the venv of prepare.py.

`graph`: nodes, topics, services and the publishers of /odom. `read SECONDS`: what each topic says in that time, each
message as time of arrival, stamp in ns and values. `call`: /giraff/estop. `drive SPEED HZ`: publish on /cmd_vel, with
0 Hz one message. `goal X`: one /goal_pose at X m in odom.
"""

# Its modules are in the venv of prepare.py alone.
# mypy: disable-error-code="import-not-found"

import json
import os
import sys
import threading
import time
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import BatteryState, CompressedImage, Imu, Range
from std_msgs.msg import Bool, String
from std_srvs.srv import Trigger

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SENSOR = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
TOPICS: dict[str, tuple[Any, Any, Any]] = {
    "/odom": (Odometry, 10, lambda it: [it.pose.pose.position.x, it.pose.pose.position.y, it.twist.twist.linear.x]),
    "/range/front_left": (Range, SENSOR, lambda it: [it.range]),
    "/hand/imu": (Imu, SENSOR, lambda it: [getattr(it.linear_acceleration, axis) for axis in "xyz"]),
    "/map": (OccupancyGrid, LATCHED, lambda it: [it.info.width * it.info.height == len(it.data), max(it.data)]),
    "/camera/head/compressed": (CompressedImage, SENSOR, lambda it: [it.format, it.data[0], it.data[1]]),
    "/battery_state": (BatteryState, 10, lambda it: [it.voltage]),
    "/diagnostics": (DiagnosticArray, 10, lambda it: [len(it.status)]),
    "/robot_description": (String, LATCHED, lambda it: [it.data]),
    "/giraff/estop_engaged": (Bool, LATCHED, lambda it: [it.data]),
}


class Talker:
    def __init__(self) -> None:
        rclpy.init()
        self.node = rclpy.create_node("real_ros")
        self.publisher = self.node.create_publisher(Twist, "/cmd_vel", 10)
        self.goals = self.node.create_publisher(PoseStamped, "/goal_pose", 10)
        self.client = self.node.create_client(Trigger, "/giraff/estop")
        self.speed, self.hz = 0.0, 0.0
        threading.Thread(target=rclpy.spin, args=(self.node,), daemon=True).start()
        threading.Thread(target=self.stream, daemon=True).start()

    def stream(self) -> None:
        while True:
            if self.hz:
                self.publish()
            time.sleep(1.0 / (self.hz or 20.0))

    def publish(self) -> None:
        twist = Twist()
        twist.linear.x = self.speed
        self.publisher.publish(twist)

    def graph(self) -> dict[str, Any]:
        odom = self.node.get_publishers_info_by_topic("/odom")
        return {
            "nodes": self.node.get_node_names(),
            "topics": dict(self.node.get_topic_names_and_types()),
            "services": dict(self.node.get_service_names_and_types()),
            "odom": [
                [it.node_name, it.topic_type, str(it.topic_type_hash), it.qos_profile.reliability.name] for it in odom
            ],
        }

    def read(self, seconds: str) -> dict[str, Any]:
        heard: dict[str, list[Any]] = {name: [] for name in TOPICS}

        def keeper(name: str, values: Any) -> Any:
            def keep(message: Any) -> None:
                stamp = getattr(getattr(message, "header", None), "stamp", None)
                ns = stamp.sec * 1_000_000_000 + stamp.nanosec if stamp else 0
                heard[name].append([time.monotonic(), ns, values(message)])

            return keep

        made = [
            self.node.create_subscription(kind, name, keeper(name, values), qos)
            for name, (kind, qos, values) in TOPICS.items()
        ]
        time.sleep(float(seconds))
        for each in made:
            self.node.destroy_subscription(each)
        return heard

    def call(self) -> list[Any]:
        future = self.client.call_async(Trigger.Request())
        while not future.done():
            time.sleep(0.01)
        return [future.result().success, future.result().message]

    def drive(self, speed: str, hz: str) -> None:
        self.speed, self.hz = float(speed), float(hz)
        if not self.hz:
            self.publish()

    def goal(self, x: str) -> None:
        pose = PoseStamped()
        pose.header.frame_id = "odom"
        pose.pose.position.x = float(x)
        self.goals.publish(pose)


answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)  # whatever ROS's libraries say on standard output is no answer
talker = Talker()
for line in sys.stdin:
    word, *values = line.split()
    print(json.dumps(getattr(talker, word)(*values), default=int), file=answers, flush=True)

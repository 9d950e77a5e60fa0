"""A ROS process that publishes as bare Zenoh what it is told on its standard input: `stream.py PORT`.

A number: the speed, m/s, that it publishes on `/cmd_vel` 20 times a second; it says on its output how many it has sent.
`silent`: no more of them. `goal X`: one `/goal_pose` at X m in `odom`.
"""

import json
import sys
import threading
import time

import zenoh
from rosbags.typesys.stores.ros2_kilted import builtin_interfaces__msg__Time as Time
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Point as Point
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Pose as Pose
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__PoseStamped as PoseStamped
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Quaternion as Quaternion
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Twist as Twist
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Vector3 as Vector3
from rosbags.typesys.stores.ros2_kilted import std_msgs__msg__Header as Header

from giraff_ros2.rmw.definitions import Definitions
from giraff_ros2.rmw.names import Attachment, Entity, dds_type, gid_of, key_of, qos_text
from giraff_ros2.topics import CMD_VEL, GOAL_POSE, RosTopic

speed: float | None = 0.0


class Publisher:
    """A publisher of one topic, as rmw_zenoh declares it."""

    def __init__(self, session: zenoh.Session, topic: RosTopic, number: int) -> None:
        self._definitions, self._type = Definitions("kilted"), topic.type
        type_hash = self._definitions.hash_of(topic.type)
        entity = Entity(str(session.zid()), 0, number, "MP", "/", "teleop", f"/{topic.name}")
        token = entity._replace(type=dds_type(topic.type), type_hash=type_hash, qos=qos_text(topic.qos)).token(0)
        self._declared = session.liveliness().declare_token(token)
        self._publisher = session.declare_publisher(key_of(0, f"/{topic.name}", topic.type, type_hash))
        self._gid = gid_of(token)
        self.sent = 0

    def publish(self, message: object) -> None:
        self.sent += 1
        attachment = Attachment(self.sent, time.time_ns(), self._gid).encode()
        self._publisher.put(self._definitions.encode(message, self._type), attachment=attachment)


def obey(goals: Publisher) -> None:
    global speed  # noqa: PLW0603  read by the loop
    for line in sys.stdin:
        word, *x = line.split()
        if x:
            pose = Pose(Point(float(x[0]), 0.0, 0.0), Quaternion(0.0, 0.0, 0.0, 1.0))
            goals.publish(PoseStamped(Header(Time(0, 0), "odom"), pose))
        else:
            speed = None if word == "silent" else float(word)


def main() -> None:
    config = zenoh.Config()
    for name, value in {
        "mode": "peer",
        "connect/endpoints": [f"tcp/127.0.0.1:{sys.argv[1]}"],
        "listen/endpoints": ["tcp/127.0.0.1:0"],
        "scouting/multicast/enabled": False,
        "timestamping/enabled": True,
        "adminspace/enabled": True,
    }.items():
        config.insert_json5(name, json.dumps(value))
    session = zenoh.open(config)
    twists, goals = Publisher(session, CMD_VEL, 1), Publisher(session, GOAL_POSE, 2)
    threading.Thread(target=obey, args=(goals,), daemon=True).start()
    while True:
        if (asked := speed) is not None:
            twists.publish(Twist(Vector3(asked, 0.0, 0.0), Vector3(0.0, 0.0, 0.0)))
            print(twists.sent, asked, flush=True)
        time.sleep(0.05)


if __name__ == "__main__":
    main()

"""A ROS process that publishes `/cmd_vel` 20 times a second, as bare Zenoh: `stream.py PORT`.

It drives at the newest speed (m/s) on its standard input, and says on its output how many messages it has sent.
"""

from __future__ import annotations

import json
import sys
import threading
import time

import zenoh
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Twist as Twist
from rosbags.typesys.stores.ros2_kilted import geometry_msgs__msg__Vector3 as Vector3

from giraff_ros2.rmw.definitions import Definitions
from giraff_ros2.rmw.names import Attachment, Entity, dds_type, gid_of, key_of, qos_text
from giraff_ros2.topics import CMD_VEL

speed = 0.0


def obey() -> None:
    global speed  # noqa: PLW0603  read by the loop
    for line in sys.stdin:
        speed = float(line)


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
    definitions = Definitions("kilted")
    type_hash = definitions.hash_of(CMD_VEL.type)
    entity = Entity(str(session.zid()), 0, 1, "MP", "/", "teleop", "/cmd_vel")
    token = entity._replace(type=dds_type(CMD_VEL.type), type_hash=type_hash, qos=qos_text(CMD_VEL.qos)).token(0)
    _declared = session.liveliness().declare_token(token)
    publisher = session.declare_publisher(key_of(0, "/cmd_vel", CMD_VEL.type, type_hash))
    threading.Thread(target=obey, daemon=True).start()
    sent = 0
    while True:
        sent += 1
        payload = definitions.encode(Twist(Vector3(speed, 0.0, 0.0), Vector3(0.0, 0.0, 0.0)), CMD_VEL.type)
        publisher.put(payload, attachment=Attachment(sent, time.time_ns(), gid_of(token)).encode())
        print(sent, speed, flush=True)
        time.sleep(0.05)


if __name__ == "__main__":
    main()

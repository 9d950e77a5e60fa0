"""A ROS process by zenoh-ros2-sdk, which is not Giraff's: `reader.py PORT`.

It comes late, says as JSON lines what it has read, and after a line on its standard input calls `/giraff/estop`.
"""

import json
import sys
import threading
from typing import Any

from rosbags.typesys import Stores, get_typestore
from zenoh_ros2_sdk import ROS2ServiceClient, ROS2Subscriber
from zenoh_ros2_sdk.qos import QosDurability, QosProfile

STORE = get_typestore(Stores.ROS2_KILTED)
ODOMETRY = 20
"""Messages that are read."""
TRIGGER = "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f"


def say(**what: object) -> None:
    print(json.dumps(what), flush=True)


def subscribe(topic: str, type_name: str, qos: QosProfile, wanted: int) -> list[Any]:
    """Return that many messages."""
    read: list[Any] = []
    all_there = threading.Event()

    def on_message(message: Any) -> None:
        read.append(message)
        if len(read) >= wanted:
            all_there.set()

    definition, _ = STORE.generate_msgdef(type_name, ros_version=2)
    subscriber = ROS2Subscriber(
        topic,
        type_name,
        callback=on_message,
        msg_definition=definition,
        type_hash=STORE.hash_rihs01(type_name),
        router_port=int(sys.argv[1]),
        qos=qos,
    )
    all_there.wait(30.0)
    subscriber.close()
    return read


def main() -> None:
    latched = QosProfile(durability=QosDurability.TRANSIENT_LOCAL, history_depth=1)  # pyright: ignore[reportCallIssue]
    say(description=[each.data for each in subscribe("/robot_description", "std_msgs/msg/String", latched, 1)])
    read = subscribe("/odom", "nav_msgs/msg/Odometry", QosProfile(), ODOMETRY)
    say(odometry=[[each.header.stamp.sec, each.header.frame_id, each.pose.pose.position.x] for each in read])
    sys.stdin.readline()
    client = ROS2ServiceClient(
        "/giraff/estop",
        "std_srvs/srv/Trigger",
        request_definition="uint8 structure_needs_at_least_one_member\n",
        response_definition="bool success\nstring message\n",
        type_hash=TRIGGER,
        router_port=int(sys.argv[1]),
    )
    answer: Any = client.call(structure_needs_at_least_one_member=0)
    say(success=bool(answer.success), message=str(answer.message))


if __name__ == "__main__":
    main()

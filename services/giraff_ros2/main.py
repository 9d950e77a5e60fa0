"""giraff_ros2: the process."""

import gc
import sys
from collections.abc import Callable
from contextlib import closing
from functools import partial
from typing import TYPE_CHECKING, Final

from giraff_node import Node
from giraff_node.network.host_addresses import host_addresses
from giraff_node.picture_client import PictureClient
from giraff_node.process.libraries import missing_library
from giraff_ros2.config import Ros2Config, endpoint
from giraff_schemas.services import ROS2

if TYPE_CHECKING:
    from giraff_ros2.rmw.session import RosSession

_REFUSED: Final = 2
_ROS_OWN: Final = (("localhost", 7447), ("127.0.0.1", 7447))
"""Where ROS processes look for their router unless somebody says otherwise."""
_LOOPBACK: Final = ("127.0.0.1", "localhost", "::1")
_EVERY_ADDRESS: Final = ("0.0.0.0", "::")  # noqa: S104  it is only compared


def main() -> None:
    if why := missing_library(ROS2):
        print(f"giraff_ros2: {why}", file=sys.stderr)
        sys.exit(_REFUSED)
    with Node("ros2", Ros2Config) as node:
        run_ros2(node, lambda lines: node.log.info("in ROS's shell: %s", "; ".join(lines)))


def run_ros2(node: Node[Ros2Config], announce: Callable[[list[str]], None]) -> None:
    """Be the robot in ROS until the node's end. SystemExit with 2, after a line in the log, where that cannot be.

    `announce`: takes the lines that a shell needs whose ROS programs are to see the robot.
    """
    from giraff_ros2.rmw.node import RosNode  # noqa: PLC0415  its libraries may be missing
    from giraff_ros2.rmw.session import NoRosError  # noqa: PLC0415
    from giraff_ros2.robot_in_ros import published  # noqa: PLC0415
    from giraff_ros2.service import Ros2  # noqa: PLC0415

    try:
        ros = RosNode(node.config, published(node.robot))
    except NoRosError as error:
        node.log.error("%s", error)
        sys.exit(_REFUSED)
    with closing(ros):
        announce(shell_lines(node.config, ros.way))
        service = Ros2(node, node.config, node.robot, ros, partial(PictureClient, node.network, node.robot.name))
        gc.freeze()  # what stays, of which the ROS libraries have much, is not looked through again and again
        node.run(service, prompt=True)


def shell_lines(config: Ros2Config, way: "RosSession") -> list[str]:
    """Return what a shell must be told whose ROS programs are to meet this one."""
    lines = ["export RMW_IMPLEMENTATION=rmw_zenoh_cpp"]
    if config.domain:
        lines.append(f"export ROS_DOMAIN_ID={config.domain}")
    if (way.host, way.port) not in _ROS_OWN:
        host = min(host_addresses(), default="127.0.0.1") if way.host in _EVERY_ADDRESS else way.host
        # ROS programs listen on their own host's loopback alone, so those of another host hear all through the router.
        mode = "" if host in _LOOPBACK else 'mode="client";'
        lines.append(f"export ZENOH_CONFIG_OVERRIDE='{mode}connect/endpoints=[\"{endpoint(host, way.port)}\"]'")
    return lines

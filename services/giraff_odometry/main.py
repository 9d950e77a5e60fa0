"""giraff_odometry: the process."""

from giraff_node import Node
from giraff_odometry.config import OdometryConfig
from giraff_odometry.service import Odometry


def main() -> None:
    with Node("odometry", OdometryConfig) as node:
        node.run(Odometry(node, node.config, node.robot))

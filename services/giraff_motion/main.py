"""giraff_motion: the process."""

from giraff_motion.config import MotionConfig
from giraff_motion.service import Motion
from giraff_node import Node


def main() -> None:
    with Node("motion", MotionConfig) as node:
        node.run(Motion(node, node.config, node.robot))

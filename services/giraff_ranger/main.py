"""giraff_ranger: the process."""

from giraff_node import Node
from giraff_ranger.config import RangerConfig
from giraff_ranger.service import Ranger


def main() -> None:
    with Node("ranger", RangerConfig) as node:
        node.run(Ranger(node, node.config, node.robot))

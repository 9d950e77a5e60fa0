"""giraff_base: the process."""

from giraff_base.config import BaseConfig
from giraff_base.service import Base
from giraff_node import Node
from giraff_node.config.robot_file import read_known


def main() -> None:
    with Node("base", BaseConfig) as node:
        for each in read_known().moved:
            node.log.warning("%s", each)
        node.run(Base(node, node.config, node.robot))


if __name__ == "__main__":
    main()

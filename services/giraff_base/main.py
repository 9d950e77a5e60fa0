"""giraff_base: the process."""

from giraff_base.config import BaseConfig
from giraff_base.service import Base
from giraff_node import Node


def main() -> None:
    with Node("base", BaseConfig) as node:
        node.run(Base(node, node.config, node.robot))


if __name__ == "__main__":
    main()

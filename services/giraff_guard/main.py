"""giraff_guard: the process."""

from giraff_guard.config import GuardConfig
from giraff_guard.service import Guard
from giraff_node import Node


def main() -> None:
    with Node("guard", GuardConfig) as node:
        node.run(Guard(node, node.config, node.robot))


if __name__ == "__main__":
    main()

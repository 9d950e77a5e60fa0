"""The door: Zenoh does all of its work. It faces the network so that base, guard and ranger need not.

Whoever floods it, or ends it, keeps others out: the robot stops and drives on as before.
"""

from giraff_door.config import DoorConfig
from giraff_node import Node


def main() -> None:
    with Node("door", DoorConfig) as node:
        for _ in node.turns():
            pass

"""giraff_joystick: the process."""

from giraff_joystick.config import JoystickConfig
from giraff_joystick.service import Joystick
from giraff_node import Node


def main() -> None:
    with Node("joystick", JoystickConfig) as node:
        node.run(Joystick(node, node.config, node.robot))

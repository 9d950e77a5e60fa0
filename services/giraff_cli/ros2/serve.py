"""`giraff ros2`: finds the robot, asks it for its limits, and is giraff_ros2 in this terminal."""

import sys
from collections.abc import Mapping, Sequence
from typing import Any, Final

import msgspec

from giraff_node import Node
from giraff_node.config.robot_file import ConfigError, expects_robot_file, read
from giraff_node.config.settings import Settings
from giraff_node.network.discovery import CORRECT_IT
from giraff_node.network.hand import open_hand
from giraff_ros2.config import Ros2Config
from giraff_ros2.main import run_ros2
from giraff_schemas.services import ROS2
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.limits import ask_limits
from giraff_tools.terminal.output import discard_stdout

_DONE: Final = 0


def serve(robot: str | None, connect: Sequence[str], options: Mapping[str, Any]) -> int:
    """Be the robot in ROS until Ctrl-C; return the exit code. `options`: fields of [ros2] that were typed."""
    try:
        config = config_of(options)
    except ConfigError as error:
        return print_error(f"{error}; {CORRECT_IT}")
    except ValueError as error:
        return print_error(f"ros2: {error}")

    def act(connection: RobotConnection) -> int:
        settings = Settings(config, ask_limits(connection, "ros2"), connection.network)
        # The services' runtime from here on, with its signals: whatever ends it, the robot is told first.
        session = open_hand(connection.network, connection.robot, connection.session)
        with Node(ROS2.name, settings, session=session) as node:
            run_ros2(node, print_lines)
        return _DONE

    # It stays for days, as a page. Its stop must not be the simulation's when the robot has come.
    return run_with_robot(robot, connect, act, moves=True, stands_in=False)


def config_of(options: Mapping[str, Any]) -> Ros2Config:
    """Return what was typed, and what the robot file says else. Raises ConfigError, or ValueError of an option."""
    filed = read(with_file=expects_robot_file()).table(ROS2.name, Ros2Config)
    return msgspec.structs.replace(filed, **options)


def print_lines(lines: Sequence[str]) -> None:
    """Print what a shell must be told, so that all of it can be pasted there. A closed output ends nothing."""
    try:
        print("# In each ROS terminal:", *lines, sep="\n", flush=True)
    except OSError:
        discard_stdout()
        print("giraff ros2: the lines for ROS terminals could not be printed", file=sys.stderr)

"""`giraff drive`: finds the robot, asks it for its limits, and is giraff_keyboard without a robot file."""

import logging
import threading
from collections.abc import Sequence

from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.main import leave, run_keyboard, terminal_fault
from giraff_node import Node
from giraff_node.config.settings import Settings
from giraff_node.network.hand import open_hand
from giraff_node.network.tokens import Token, watch_tokens
from giraff_schemas.services import BASE, KEYBOARD
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.limits import ask_limits


def drive(robot: str | None, connect: Sequence[str]) -> int:
    """Until Ctrl-C, or the terminal is gone; the exit code."""
    if fault := terminal_fault():
        return print_error(f"drive: {fault}")

    def act(connection: RobotConnection) -> int:
        connection.ask_page()
        limits = ask_limits(connection, "drive")
        return _drive(connection, Settings(KeyboardConfig(), limits, connection.network))

    return run_with_robot(robot, connect, act, moves=True)


def _drive(connection: RobotConnection, settings: Settings[KeyboardConfig]) -> int:
    # The services' runtime from here on, with its signals: whatever ends it, the robot is told first.
    node = Node(KEYBOARD.name, settings, session=open_hand(connection.network, connection.robot, connection.session))
    node.log.setLevel(logging.ERROR)  # the screen tells the rest
    named, has_come = connection.stands_in_for, threading.Event()

    def on_token(token: Token, is_there: bool) -> None:
        if is_there and token.service == BASE.name:
            has_come.set()
            node.leave()

    with node:
        # A screen with a stop on it must not be the simulation's where the named robot is.
        watch = watch_tokens(node.session, named, on_token) if named else None
        unconfirmed, terminal = run_keyboard(node)
    del watch
    other = f"drive: {named} is heard now, and this was {connection.robot}; type it again to drive {named}"
    return leave(terminal, print_error, other if has_come.is_set() else "", unconfirmed)

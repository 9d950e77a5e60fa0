"""`giraff drive`: finds the robot, asks it for its limits, and is giraff_keyboard with a screen of its own."""

from __future__ import annotations

import logging
import os
import threading
from collections.abc import Sequence
from typing import Final

from giraff_cli.drive.terminal import DriveTerminal
from giraff_cli.drive.view import DriveView
from giraff_cli.network.command import print_error, run_with_robot
from giraff_cli.network.connection import RobotConnection
from giraff_cli.network.limits import ask_limits
from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.main import go_on_asking, in_terminal, run_keyboard
from giraff_node import Node
from giraff_node.network.hand import open_hand
from giraff_node.network.tokens import Token, watch_tokens
from giraff_node.node import Settings
from giraff_schemas.services import BASE, KEYBOARD

_PATIENCE: Final = 3.0  # s, for a robot to be found

_DONE: Final = 0
_NOT_CONFIRMED: Final = 1


def drive(robot: str | None, connect: Sequence[str]) -> int:
    """Until Ctrl-C, or the terminal is gone; the exit code."""
    if not in_terminal():
        return print_error("drive: reads keys from a terminal, and draws on it; start it in one, without a pipe")
    if os.environ.get("TERM", "dumb") == "dumb":
        return print_error("drive: cannot draw on this terminal, of which TERM says that it is dumb")

    def act(connection: RobotConnection) -> int:
        connection.ask_page()
        limits = ask_limits(connection, "drive")
        return _drive(connection, Settings(KeyboardConfig(), limits, connection.network))

    return run_with_robot(robot, connect, _PATIENCE, act, moves=True)


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
        with DriveTerminal(node.fail) as terminal:
            keyboard = run_keyboard(node, terminal, DriveView(connection.robot, tuple(settings.robot.sensors)))
        unconfirmed = go_on_asking(keyboard)
    del watch
    code = _NOT_CONFIRMED if unconfirmed or has_come.is_set() else _DONE
    if has_come.is_set():
        print_error(f"drive: {named} is heard now, and this was {connection.robot}; type it again to drive {named}")
    if terminal.is_stuck:
        os._exit(code)  # a word of why would wait, too, and so would Python for what is still to be written
    if unconfirmed:
        print_error(unconfirmed)
    return code

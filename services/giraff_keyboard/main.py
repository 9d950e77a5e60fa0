"""giraff_keyboard: the process, in a terminal."""

from __future__ import annotations

import logging
import sys
import time
from typing import Final, TypeVar

from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.service import Keyboard, Screen, View
from giraff_keyboard.status import StatusView
from giraff_keyboard.terminal import Terminal
from giraff_node import Node

PictureT = TypeVar("PictureT")

_LAST_REQUESTS: Final = 2.0  # s that a stop is still asked for after Ctrl-C


class StopNotConfirmedError(Exception):
    """The program ends, and base has not said that the robot is stopped."""


def main() -> int:
    if not in_terminal():
        print("giraff_keyboard: reads keys from a terminal; start it in one, without a pipe", file=sys.stderr)
        return 2
    with Node("keyboard", KeyboardConfig) as node:
        if sys.stderr.isatty():
            node.log.setLevel(logging.ERROR)  # the status lines tell the rest, on the same screen
        with Terminal() as terminal:
            keyboard = run_keyboard(node, terminal, StatusView())
        if terminal.is_gone:
            node.log.error("the terminal was closed")
        if unconfirmed := go_on_asking(keyboard):
            node.fail(StopNotConfirmedError(unconfirmed))
    return 0


def in_terminal() -> bool:
    """Whether a person can type here, and read."""
    return sys.stdin.isatty() and sys.stdout.isatty()


def run_keyboard(node: Node[KeyboardConfig], screen: Screen[PictureT], view: View[PictureT]) -> Keyboard[PictureT]:
    """Until its end; it may have asked for a stop that is not confirmed yet."""
    keyboard = Keyboard(node, node.config, node.robot, screen, view)
    node.run(keyboard)
    return keyboard


def go_on_asking(keyboard: Keyboard[PictureT]) -> str:
    """A stop that was asked for outlives the screen: what of it base has not confirmed; empty: nothing."""
    until = time.monotonic() + _LAST_REQUESTS
    stopping = keyboard.stopping
    while stopping.asked and (now := time.monotonic()) < until:
        keyboard.ask_on(now)
        time.sleep(0.01)
    return stopping.text if stopping.asked else ""

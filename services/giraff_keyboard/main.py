"""giraff_keyboard: the process, in a terminal."""

import logging
import sys
import time
from typing import Final

from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.estop_request import EStopRequest
from giraff_keyboard.service import Keyboard
from giraff_keyboard.terminal import Terminal
from giraff_node import Node

_LAST_REQUESTS: Final = 2.0  # s that a stop is still asked for after Ctrl-C


class StopNotConfirmedError(Exception):
    """The program ends, and base has not said that the robot is stopped."""


def main() -> int:
    if not (sys.stdin.isatty() and sys.stdout.isatty()):
        print("giraff_keyboard: reads keys from a terminal; start it in one, without a pipe", file=sys.stderr)
        return 2
    with Node("keyboard", KeyboardConfig) as node:
        if sys.stderr.isatty():
            node.log.setLevel(logging.ERROR)  # the status lines tell the rest, on the same screen
        with Terminal() as terminal:
            keyboard = Keyboard(node, node.config, node.robot, terminal)
            node.run(keyboard)
        if terminal.is_gone:
            node.log.error("the terminal was closed")
        _go_on_asking(keyboard.stopping)
        if keyboard.stopping.asked:
            node.fail(StopNotConfirmedError(keyboard.stopping.text))
    return 0


def _go_on_asking(stopping: EStopRequest) -> None:
    """A stop that was asked for and is not confirmed yet outlives the screen."""
    until = time.monotonic() + _LAST_REQUESTS
    while stopping.asked and (now := time.monotonic()) < until:
        stopping.poll(now)
        time.sleep(0.01)

"""giraff_keyboard: the process, in a terminal."""

import logging
import os
import sys
import time
from collections.abc import Callable
from typing import Final

from giraff_keyboard.config import KeyboardConfig
from giraff_keyboard.picture import DriveView
from giraff_keyboard.service import Keyboard
from giraff_keyboard.terminal import Terminal
from giraff_node import Node
from giraff_schemas.actions import KEYS

_LAST_REQUESTS: Final = 2.0  # s that a stop is still asked for after Ctrl-C


def main() -> int:
    """Return 1 where a stop was asked for that base has not confirmed, and 2 where there is no terminal."""
    if fault := terminal_fault():
        print(f"giraff_keyboard: {fault}", file=sys.stderr)
        return 2
    with Node("keyboard", KeyboardConfig) as node:
        if sys.stderr.isatty():
            node.log.setLevel(logging.ERROR)  # the picture tells the rest, on the same screen
        unconfirmed, terminal = run_keyboard(node)
        if terminal.is_gone:
            node.log.error("the terminal was closed")
    return leave(terminal, node.log.error, unconfirmed)


def terminal_fault() -> str:
    """Tell why a person can neither type nor read here; empty: he can."""
    if not in_terminal():
        return "reads keys from a terminal, and draws on it; start it in one, without a pipe"
    if os.environ.get("TERM", "dumb") == "dumb":
        return "cannot draw on this terminal, of which TERM says that it is dumb"
    return ""


def in_terminal() -> bool:
    """Whether a person can type here, and read."""
    return sys.stdin.isatty() and sys.stdout.isatty()


def run_keyboard(node: Node[KeyboardConfig]) -> tuple[str, Terminal]:
    """Drive until the end. Return which stop base has not confirmed, empty if none, and the terminal that was left."""
    with Terminal(DriveView(node.robot.name, node.robot.sensor_types), node.fail) as terminal:
        keyboard = Keyboard(node, node.config, node.robot, terminal)
        node.run(keyboard)
    return go_on_asking(keyboard), terminal


def leave(terminal: Terminal, say: Callable[[str], object], *problems: str) -> int:
    """Say what is wrong in the end; empty texts are nothing. Return the exit code."""
    told = [problem for problem in problems if problem]
    if terminal.is_stuck:
        os._exit(int(bool(told)))  # a word of why would wait, too, and so would Python for what is still to be written
    for problem in told:
        say(problem)
    return int(bool(told))


def go_on_asking(keyboard: Keyboard) -> str:
    """A stop that was asked for outlives the screen: what of it base has not confirmed; empty: nothing."""
    until = time.monotonic() + _LAST_REQUESTS
    stopping = keyboard.stopping
    while stopping.asked and (now := time.monotonic()) < until:
        keyboard.ask_on(now)
        time.sleep(0.01)
    return stopping.outcome.line(KEYS) if stopping.asked else ""

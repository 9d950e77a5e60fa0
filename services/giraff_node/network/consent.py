"""A person says which robot is meant, and that it may be moved. Nobody is asked where there is no terminal."""

import contextlib
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from typing import Final

from giraff_schemas.text import printable

_MOST_LISTED: Final = 10  # robots; on an open network anybody may declare a name


class NoRobotError(Exception):
    """No robot can be told. The message says why, and the way out."""


def ask_which(robots: Sequence[str], host_of: Callable[[str], str], *, asks: bool) -> str:
    """One of these by its number, where there `asks` anybody. `host_of`: a robot. Raises NoRobotError."""
    several = f"several robots are on the network; name one: {options(robots)} (or GIRAFF_ROBOT_NAME)"
    if not (asks and _is_terminal()) or len(robots) > _MOST_LISTED:
        raise NoRobotError(several)
    for number, name in enumerate(robots, 1):
        print_notice(f"{number}  {_placed(name, host_of(name))}")
    answer = _ask("which one? Type its number: ")
    if answer not in {str(number) for number in range(1, len(robots) + 1)}:
        raise NoRobotError(several)
    return robots[int(answer) - 1]


def confirm(robot: str, host: str, line: str) -> None:
    """A typed yes to a robot that is not this host's simulation, and that nobody has named. Raises NoRobotError."""
    whose = f"{_placed(robot, host)}, is not the simulation of this host, and nobody has named it"
    if not _is_terminal():
        raise NoRobotError(f"{whose}; if it is meant: {line}")
    print_notice(whose)
    if _ask(f"type yes if {robot} is meant: ").lower() != "yes":
        raise NoRobotError(f"nothing was done; if {robot} is meant: {line}")


def options(names: Sequence[str]) -> str:
    """Return the options that name these robots. Of a long list, it names only the first."""
    import shlex  # noqa: PLC0415  for a command with several robots; a service waits for no such module

    listed = ", ".join(f"--robot {shlex.quote(name)}" for name in names[:_MOST_LISTED])
    return listed + (f" and {len(names) - _MOST_LISTED} more" if len(names) > _MOST_LISTED else "")


def print_notice(text: str) -> None:
    """Print to standard error. A closed output ends no command, least of all a stop."""
    with contextlib.suppress(OSError):
        print(printable(f"giraff: {text}") + "\n", end="", file=sys.stderr, flush=True)  # two threads may tell


def _placed(name: str, host: str) -> str:
    return f"{name}, on {host or 'an unknown host'}"


def _is_terminal() -> bool:
    return sys.stdin.isatty() and sys.stderr.isatty()


def _ask(question: str) -> str:
    """What is typed; empty at the end of the input."""
    print(printable(f"giraff: {question}"), end="", file=sys.stderr, flush=True)
    in_main = threading.current_thread() is threading.main_thread()
    # A command that counts Ctrl-C instead of ending at it would wait here for ever.
    before = signal.signal(signal.SIGINT, signal.default_int_handler) if in_main else None
    try:
        return sys.stdin.readline().strip()
    except KeyboardInterrupt:
        print(file=sys.stderr)
        return ""
    finally:
        if in_main:
            signal.signal(signal.SIGINT, before)

"""Which robot a command is for, and the network that it is looked for on. Works on machines with no robot file."""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import msgspec
import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.config.misplaced import find_misplaced
from giraff_node.config.robot_file import ConfigError, RawSettings, expects_robot_file, read
from giraff_schemas.topics import alive_key, require_chunk

_ASK_AGAIN: Final = 0.1  # s
_SETTLED: Final = 0.5  # s after the first robot was found: the others of a network are met within some ten ms
_REPLY_WITHIN: Final = 0.5  # s

CORRECT_IT: Final = "correct it: without it nobody knows which robot is meant, or how it is reached"
"""The way out of a ConfigError of `resolve_target`."""


class NoRobotError(Exception):
    """No robot can be told. The message says why, and the way out."""


@dataclass(frozen=True)
class Target:
    """What is known before anything is heard."""

    robot: str
    """Empty: nobody has named one."""
    network: NetworkConfig
    warning: str = ""
    """What of robot file and environment did not count; empty: nothing."""


def resolve_target(robot: str | None, connect: Sequence[str], environment: Mapping[str, str] = os.environ) -> Target:
    """From the command line, the environment and the robot file, in this order.

    Raises ConfigError where the latter two may mean another network or another robot than would be found without what
    is wrong: a stranger's robot of the same name must not confirm a stop in the place of the one that drives on.
    Raises NoRobotError for what is wrong on the command line. What is wrong elsewhere is told and passed over: it is
    no reason not to stop a robot.
    """
    given = read(environment, with_file=expects_robot_file(environment))
    for doubt in find_misplaced(given, environment, is_named=bool(robot)):
        raise ConfigError(doubt.what)
    network = given.table("network", NetworkConfig)
    name = robot or name_of(given)
    return target_of(name, connect, network, "; ".join(strange.what for strange in given.strange))


def target_of(robot: str | None, connect: Sequence[str], network: NetworkConfig, warning: str = "") -> Target:
    """With what the command line says. Raises NoRobotError."""
    try:
        name = require_chunk(robot) if robot else ""
    except ValueError as error:
        raise NoRobotError(f"robot: {error}") from error
    try:
        return Target(name, msgspec.structs.replace(network, connect=(*network.connect, *connect)), warning)
    except ValueError as error:
        raise NoRobotError(f"--connect: {error}") from error


def name_of(given: RawSettings) -> str:
    """The robot's name, where one is given. Raises ConfigError."""
    name = given.tables.get("robot", {}).get("name")
    if name is None:
        return ""
    if not isinstance(name, str):
        raise ConfigError(f"{given.place('robot')}: name: give a text, not {name}")
    try:
        return require_chunk(name)
    except ValueError as error:
        raise ConfigError(f"{given.place('robot')}: name: {error}") from error


def list_robots(session: zenoh.Session) -> list[str]:
    """Names of the robots of which any service is on the network now."""
    replies = session.liveliness().get(alive_key("*"), timeout=_REPLY_WITHIN)
    return sorted({str(reply.ok.key_expr).split("/")[1] for reply in replies if reply.ok is not None})


class RobotMonitor:
    """The robots on the network, as their services come and go. It asks nobody, and so never waits."""

    def __init__(self, session: zenoh.Session) -> None:
        self._tokens: set[str] = set()
        self._news: deque[tuple[str, bool]] = deque()  # of Zenoh's threads
        self._found_at: float | None = None
        self._subscriber = session.liveliness().declare_subscriber(alive_key("*"), self._on_token, history=True)

    @property
    def names(self) -> list[str]:
        """Those of which any service is there now."""
        for _ in range(len(self._news)):
            token, present = self._news.popleft()
            (self._tokens.add if present else self._tokens.discard)(token)
        return sorted({token.split("/")[1] for token in self._tokens})

    @property
    def settled(self) -> list[str]:
        """The same, as soon as all that can be met at once have been."""
        names, now = self.names, time.monotonic()
        self._found_at = (self._found_at or now) if names else None
        return names if self._found_at is not None and now - self._found_at >= _SETTLED else []

    def _on_token(self, received: zenoh.Sample) -> None:
        self._news.append((str(received.key_expr), received.kind == zenoh.SampleKind.PUT))


def find_only_robot(session: zenoh.Session, patience: float) -> str:
    """The one robot on the network, where nobody has named one. Raises NoRobotError."""
    deadline = time.monotonic() + patience
    while not (found := list_robots(session)):
        if time.monotonic() > deadline:
            raise NoRobotError(f"no robot is heard on the network after {patience:g} s; {HOW_TO_REACH}")
        time.sleep(_ASK_AGAIN)
    time.sleep(_SETTLED)
    return only_one(sorted({*found, *list_robots(session)}))


def only_one(found: Sequence[str]) -> str:
    """The robot that is meant where nobody has named one and these, at least one, are there. Raises NoRobotError."""
    if len(found) > 1:
        raise NoRobotError(f"several robots are on the network; name one: {_options(found)}")
    return found[0]


HOW_TO_REACH: Final = "check that it is on and on this network; where multicast does not reach, give --connect ROBOT"


def others(session: zenoh.Session, robot: str) -> str:
    """A hint for one who has named a robot that is not there; empty when no other is."""
    return _instead(list_robots(session), robot)


def not_found_text(robot: str, found: Sequence[str]) -> str:
    """What to say of a robot that is not heard where these are; empty: nobody has named one."""
    whom = f"no robot called {robot}" if robot else "no robot"
    return f"{whom} is heard on the network; {HOW_TO_REACH}{_instead(found, robot) if robot else ''}"


def _instead(found: Sequence[str], robot: str) -> str:
    there = [name for name in found if name != robot]
    return f"; on the network: {_options(there)}" if there else ""


def _options(found: Sequence[str]) -> str:
    return ", ".join(f"--robot {name}" for name in found)

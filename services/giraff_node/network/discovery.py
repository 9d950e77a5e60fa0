"""Which robot a command is for, and the network that it is looked for on. Works on machines with no robot file.

Whoever only looks takes the robot that is there. Whoever moves one has named it, or starts with the simulation of this
very host; for any other a person says yes (`consent`).
"""

import os
import re
import socket
import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import msgspec
import zenoh

from giraff_core.network import NetworkConfig
from giraff_node.config.robot_file import DEFAULT_FILE, ConfigError, RawSettings, expects_robot_file, read
from giraff_node.config.typos import find_misplaced
from giraff_node.network import consent
from giraff_node.network.consent import NoRobotError
from giraff_node.network.replies import gather_answers
from giraff_node.network.tokens import REPLY_WITHIN, Token, list_robots, robots_of, watch_tokens
from giraff_schemas.health import Health
from giraff_schemas.services import BASE, PLAY
from giraff_schemas.text import meant
from giraff_schemas.topics import health_key, require_chunk

_ASK_AGAIN: Final = 0.1  # s
_SETTLED: Final = 0.5  # s after the first robot was found: the others of a network are met within some ten ms
_AT_A_DOOR: Final = 0.1  # s of the same for a client: the door has met the others before

CORRECT_IT: Final = "correct it: without it nobody knows which robot is meant, or how it is reached"
"""The way out of a ConfigError of `resolve_target`."""


@dataclass(frozen=True)
class Target:
    """What is known before anything is heard."""

    robot: str
    """Named by the command line, the environment, or the file of GIRAFF_CONFIG; empty: nobody has named one."""
    network: NetworkConfig
    warning: str = ""
    """What of robot file and environment did not count; empty: nothing."""
    filed: str = ""
    """The name in the robot file of the current folder, which nobody has asked for. It counts if it is heard."""
    named_by: str = ""
    """Path of the file of GIRAFF_CONFIG where it alone has named `robot`; empty: somebody has typed the name."""
    example: str = ""
    """The name in the robot file of the current folder, where that is still the source's example. `filed` is empty."""


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
    name, filed = named(given, robot, environment)
    way = target_of(name, connect, network, "; ".join(strange.what for strange in given.strange), filed)
    if given.is_example:  # its reader has not written it, and misses no robot that it names
        way = replace(way, filed="", example=filed)
    return way if not name or _is_typed(robot, given) else replace(way, named_by=given.where)


def named(given: RawSettings, robot: str | None, environment: Mapping[str, str]) -> tuple[str, str]:
    """Return `Target.robot` and `Target.filed`. Raises ConfigError."""
    name = robot or name_of(given)
    if environment.get("GIRAFF_CONFIG") or _is_typed(robot, given):
        return name, ""
    return "", name


def _is_typed(robot: str | None, given: RawSettings) -> bool:
    """Whether the command line or GIRAFF_ROBOT_NAME has named the robot."""
    return bool(robot) or "GIRAFF_ROBOT_NAME" in map(str.upper, given.variables)


def target_of(
    robot: str | None, connect: Sequence[str], network: NetworkConfig, warning: str = "", filed: str = ""
) -> Target:
    """With what the command line says. Raises NoRobotError."""
    try:
        name = require_chunk(robot) if robot else ""
    except ValueError as error:
        raise NoRobotError(f"robot: {error}") from error
    try:
        return Target(name, msgspec.structs.replace(network, connect=(*network.connect, *connect)), warning, filed)
    except ValueError as error:
        raise NoRobotError(f"--{error}") from error


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


class RobotMonitor:
    """The robots on the network, as their services come and go. It asks nobody, and so never waits."""

    def __init__(self, session: zenoh.Session) -> None:
        self._tokens: set[Token] = set()
        self._news: deque[tuple[Token, bool]] = deque()  # of Zenoh's threads
        self._found_at: float | None = None
        self._subscriber = watch_tokens(session, "*", lambda *news: self._news.append(news))

    @property
    def names(self) -> list[str]:
        """Those that are there now, as `robots_of` has it."""
        return robots_of(self._now())

    @property
    def all_names(self) -> list[str]:
        """Each name under which anything is there now, but for what is played from a recording."""
        return sorted({token.robot for token in self._now() if token.service != PLAY.name})

    @property
    def settled(self) -> list[str]:
        """The same, as soon as all that can be met at once have been."""
        names, now = self.names, time.monotonic()
        self._found_at = (self._found_at or now) if names else None
        return names if self._found_at is not None and now - self._found_at >= _SETTLED else []

    def _now(self) -> set[Token]:
        for _ in range(len(self._news)):
            token, present = self._news.popleft()
            (self._tokens.add if present else self._tokens.discard)(token)
        return self._tokens


def simulated_name(host: str) -> str:
    """The robot name of a simulation on this host, never that of a robot."""
    return "sim-" + (re.sub(r"[^A-Za-z0-9_-]+", "-", host).strip("-") or "host")


def is_simulated_here(robot: str) -> bool:
    """Whether it is the robot that `giraff run` simulates on this very host, by its robot file."""
    return robot == simulated_name(socket.gethostname())


class Choice(NamedTuple):
    """Which robot is meant where nobody has named one."""

    robot: str
    """Empty: it cannot be told."""
    remark: str = ""
    """What a person should know of it."""


def robot_for(found: Sequence[str], filed: str) -> Choice:
    """Of these, at least one, that are there: the one of the folder's robot file, else the only one."""
    if filed in found:
        return Choice(filed)
    remark = f"{filed}, which {DEFAULT_FILE} names, is not heard" if filed else ""
    return Choice(found[0] if len(found) == 1 else "", remark)


def stand_in(session: zenoh.Session, way: Target) -> str:
    """Return `way.robot`, or this host's simulation where only that is heard and no person has typed a name.

    Never for a stop. On a secured network a session may speak of the named robot alone.
    """
    simulated = simulated_name(socket.gethostname())
    if not way.named_by or way.network.mode == "secured":
        return way.robot
    for wait in (_SETTLED, 0.0):
        found = list_robots(session)
        if way.robot in found or simulated not in found:
            return way.robot
        time.sleep(wait)
    consent.print_notice(f"{way.robot}, which {way.named_by} names, is not heard; this is {simulated}")
    return simulated


def find_robot(session: zenoh.Session, filed: str, patience: float, *, at_door: bool = True) -> str:
    """The robot that is there, where nobody has named one. A person at a terminal is asked. Raises NoRobotError.

    `at_door`: the session is a door's client. Else all `patience` went by until one was given up.
    """
    deadline = time.monotonic() + (patience if at_door else 0.0)
    while not (found := list_robots(session)):
        if time.monotonic() > deadline:
            named = f"; {DEFAULT_FILE} names {filed}" if filed else ""
            raise NoRobotError(f"no robot is heard on the network after {patience:g} s; {how_to_reach()}{named}")
        time.sleep(_ASK_AGAIN)
    time.sleep(_AT_A_DOOR if at_door else _SETTLED)
    return select_robot(session, sorted({*found, *list_robots(session)}), filed)


def select_robot(session: zenoh.Session, found: Sequence[str], filed: str, *, asks: bool = True) -> str:
    """Which of these, at least one, that are there. Raises NoRobotError. `asks`: a person at a terminal."""
    robot, remark = robot_for(found, filed)
    if remark:
        consent.print_notice(f"{remark}; this is {robot}" if robot else remark)
    return robot or consent.ask_which(found, lambda name: host_of(session, name), asks=asks)


def require_consent(session: zenoh.Session, robot: str, line: str) -> None:
    """Before a robot that nobody has named is moved, released or set. Raises NoRobotError.

    `line`: what a person types to name it. Only the simulation of this very host starts by itself.
    """
    if not is_simulated_here(robot):
        consent.confirm(robot, host_of(session, robot), line)


def host_of(session: zenoh.Session, robot: str) -> str:
    """The host of its base, or of what else of it answers; empty: that is not known."""
    healths = gather_answers(session, health_key(robot), Health, REPLY_WITHIN)
    hosts = {health.service == BASE.name: health.host for health in healths}
    return hosts.get(True) or hosts.get(False) or ""


HOW_TO_REACH: Final = "check that it is on and on this network; where multicast does not reach, give --connect ROBOT"


def how_to_reach() -> str:
    """Return what to do where no robot is heard."""
    from giraff_node.network.host_addresses import loopback_fault  # noqa: PLC0415  for who hears none

    return str(loopback_fault()) or HOW_TO_REACH


def others(session: zenoh.Session, robot: str) -> str:
    """A hint for one who has named a robot that is not there; empty when no other is."""
    return _instead(list_robots(session), robot)


def not_found_text(robot: str, found: Sequence[str]) -> str:
    """What to say of a robot that is not heard where these are; empty: nobody has named one."""
    whom = f"no robot called {robot}" if robot else "no robot"
    instead = _instead(found, robot) if robot else ""
    return f"{whom} is heard on the network; {how_to_reach()}{instead}"


def _instead(found: Sequence[str], robot: str) -> str:
    there = [name for name in found if name != robot]
    return f"; {meant(robot, there)}on the network: {consent.options(there)}" if there else ""

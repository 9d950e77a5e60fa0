"""`giraff why`: listen for a moment, and say what stops the robot."""

import socket
import time
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Final

import msgspec
from rich.text import Text

from giraff_cli.why import checks as links
from giraff_cli.why.chain import ChainState, Link, LinkStatus, Observation
from giraff_core.senses import PUBLISHERS
from giraff_node import robot_now_ns
from giraff_node.network.discovery import not_found_text
from giraff_node.network.replies import ask_all
from giraff_node.network.tokens import list_robots
from giraff_node.process.version import version
from giraff_schemas.health import Health
from giraff_schemas.services import BASE, GUARD, HANDS, SERVICES
from giraff_schemas.text import printable
from giraff_schemas.topics import CAMERA_STATE, ROUTE, health_key
from giraff_telemetry.describe import seen_text, state_text
from giraff_tools.network.command import print_error
from giraff_tools.network.connection import RobotConnection
from giraff_tools.network.versions import version_trouble
from giraff_tools.terminal.page import print_table, print_trimmed
from giraff_tools.terminal.text import json_page

_DRIVES: Final = 0
_STOPPED: Final = 1
_FIRST_WITHIN: Final = 3.0  # s until the first word of a robot that is there
_LOOK_EVERY: Final = 0.05  # s
_BY_NAME_AFTER: Final = 0.5  # s without an answer to the question to all; then a service is asked by its own name
_HANGS_AFTER: Final = 2.0  # s without an answer to that
_JUDGED: Final = frozenset({BASE.name, GUARD.name, *links.SENSING, *HANDS})
"""Services of the chain. No other one is waited for."""
_MOST_ANSWERS: Final = 1000  # that are kept; on an open network anybody may answer
_STYLES: Final[dict[LinkStatus, str]] = {
    "ok": "green",
    "limits": "yellow",
    "idle": "cyan",
    "waits": "dim",
    "STOPS": "bold red",
    "missing": "bold red",
}
LINKS: Final = ("hand", "operator", "lease", *links.SENSING, "guard", "base", "e-stop", "board", "wheels")
"""From hand to wheel, as they are told."""

_EXTRA: Final = frozenset(service.name for service in SERVICES if service.extra_device)
"""Links of which nothing is told where the guard knows no sensor of theirs."""

_JUDGES: Final[dict[str, Callable[[ChainState], Link]]] = {
    "operator": links.operator,
    "hand": links.hand,
    "e-stop": links.estop,
    **{service: partial(links.sensors, service) for service in links.SENSING},
    "guard": links.guard,
    "board": links.board,
    "lease": links.lease,
    "base": links.base,
    "wheels": links.wheels,
}
"""In the order in which they are judged: a link that only suffers from another one waits for it and is not to blame."""


def explain(connection: RobotConnection, seconds: float, *, as_json: bool) -> int:
    """Listen for `seconds`, print what was found; the exit code."""
    observation = listen(connection, seconds)
    if observation.empty:
        return print_error(not_found_text(connection.robot, list_robots(connection.session)))
    diagnosis = diagnose(observation)
    if as_json:
        print(json_page(diagnosis))
    else:
        _show(diagnosis, connection.decode_errors)
    return _STOPPED if diagnosis.stopped_by else _DRIVES


def listen(connection: RobotConnection, seconds: float) -> Observation:
    """Return what is heard within `seconds` of the first word. A service that does not answer is waited for longer."""
    observation = Observation(connection.robot, socket.gethostname(), version())
    connection.subscribe_all()
    first_by = time.monotonic() + _FIRST_WITHIN
    while observation.empty and time.monotonic() < first_by:
        time.sleep(_LOOK_EVERY)
        connection.dispatch(observation)
    if observation.empty:
        return observation
    healths: deque[Health] = deque(maxlen=_MOST_ANSWERS)
    asked: dict[str, float] = {}  # by name: when
    now = time.monotonic()
    by_name_at, until = now + _BY_NAME_AFTER, now + seconds
    ask_all(connection.session, health_key(connection.robot), Health, healths.append, seconds + _HANGS_AFTER)
    while True:
        time.sleep(min(_LOOK_EVERY, until - now) if now < until else _LOOK_EVERY)
        now = time.monotonic()
        connection.dispatch(observation)
        observation.health = list(healths)
        silent = observation.unanswered & _JUDGED
        if now >= by_name_at:
            for service in silent - asked.keys():
                asked[service] = now
                key = health_key(connection.robot, service)
                ask_all(connection.session, key, Health, healths.append, _HANGS_AFTER)
        observation.hung = frozenset(each for each in silent if now - asked.get(each, now) >= _HANGS_AFTER)
        if now >= until and (silent == observation.hung or now >= until + _HANGS_AFTER):
            break
    observation.now_ns = robot_now_ns()
    return observation


def _show(diagnosis: "Diagnosis", unreadable: list[str]) -> None:
    print_table(
        (">", "", ">", ""),
        [
            (
                link.name,
                Text(link.status, style=_STYLES[link.status]),
                Text("" if link.age is None else f"{link.age * 1000.0:.0f} ms", style="dim"),
                link.text,
            )
            for link in diagnosis.links
        ],
    )
    versions = (diagnosis.versions,) if diagnosis.versions else ()
    strange = () if versions else (f"unreadable: {complaint}" for complaint in unreadable)  # one line says it of all
    routes = (diagnosis.route,) if diagnosis.route not in ("", diagnosis.conclusion) else ()
    for told in (*versions, *diagnosis.cameras, *routes, *strange):
        print_trimmed(Text(printable(told), style="yellow"))
    style = "bold red" if diagnosis.stopped_by else "bold green"
    print_trimmed(Text.assemble((f"{diagnosis.robot}: ", "bold"), (printable(diagnosis.conclusion), style)))


class Diagnosis(msgspec.Struct, frozen=True, kw_only=True):
    """The answer to `giraff why`."""

    robot: str
    drives: bool
    """It moves now."""
    stopped_by: str
    """The first link that stops it; empty: none does."""
    conclusion: str
    """What that is, and what to do."""
    links: tuple[Link, ...]
    cameras: tuple[str, ...] = ()
    """Who sees what the robot's cameras see, a line each that is on. It stops nothing."""
    route: str = ""
    """The route that waits, or has ended elsewhere than at its goal, and why; empty: none, or the robot drives.

    One that waits is the conclusion, where no link stops the robot.
    """
    versions: str = ""
    """Which versions run where; empty: all are the one of this command. Hosts of two formats do not hear each other."""


def diagnose(observation: Observation) -> Diagnosis:
    """The chain, and what to do."""
    state = ChainState(observation)
    for name, judge in _JUDGES.items():
        state.links[name] = judge(state)
    types = () if state.guard is None else state.guard.sample.sensor_types.values()
    unused = _EXTRA - {PUBLISHERS.get(kind, "") for kind in types}
    chain = tuple(state.links[name] for name in LINKS if name not in unused)
    broken = [link for link in chain if link.breaks]
    drives = state.base is not None and state.base.sample.driving
    waits, route = (False, "") if drives else _route(observation)
    return Diagnosis(
        robot=observation.robot,
        drives=drives,
        stopped_by=broken[0].name if broken else "",
        conclusion=route if waits and not broken else _conclude(chain, broken, drives),
        links=chain,
        versions=str(version_trouble(observation.host, observation.version, observation.health)),
        route=route,
        cameras=tuple(text for seen in observation.of(CAMERA_STATE) if (text := seen_text(seen.sample))),
    )


def _route(observation: Observation) -> tuple[bool, str]:
    """Return whether a route waits, and why it does or did not arrive; empty: neither."""
    heard = observation.newest(ROUTE)
    if heard is None or (state := heard.sample).stage not in ("waiting", "ended") or state.outcome == "arrived":
        return False, ""
    waits = state.stage == "waiting"
    return waits, f"{'route' if waits else 'last route'}: {state_text(state)}"


def _conclude(chain: tuple[Link, ...], broken: list[Link], drives: bool) -> str:
    if broken:
        first, *others = broken
        return f"{first.name}: {first.text}" + (f" (then: {', '.join(link.name for link in others)})" if others else "")
    if idle := next((link for link in chain if link.status == "idle"), None):
        operator = next(link for link in chain if link.name == "operator")
        return f"{idle.text}; {operator.text}" if operator.status == "limits" else idle.text
    limits = "; ".join(f"{link.name}: {link.text}" for link in chain if link.status == "limits")
    if drives:
        return "the robot drives" + (f", but {limits}" if limits else "")
    return "nothing stops the robot" + (f", but {limits}" if limits else ": it drives when the hand asks for it")

"""Asks giraff_places for a change, and shows what it tells."""

import secrets
import time
from collections.abc import Sequence
from typing import Final, NamedTuple

import msgspec

from giraff_core.latest import LatestSamples
from giraff_node import robot_now_ns
from giraff_node.network.discovery import others
from giraff_node.network.query_client import QueryClient
from giraff_schemas.places import PlaceAdd, PlaceChange, PlaceRemove, Places, PlacesSet
from giraff_schemas.text import printable
from giraff_schemas.topics import PLACES, PLACES_SET
from giraff_telemetry.localization import place_text
from giraff_tools.network.command import print_error, run_with_robot
from giraff_tools.network.connection import RobotConnection
from giraff_tools.terminal.page import print_json, print_table
from giraff_tools.terminal.program import user_at_host

DONE: Final = 0
REFUSED: Final = 1
UNANSWERED: Final = 2

_PATIENCE: Final = 3.0  # s, for an answer, and to hear the places, which are told once a second
_TURN: Final = 0.02  # s
_CHECK: Final = "check that giraff_places runs; `giraff run --localize` starts it beside a simulated robot"


class Result(NamedTuple):
    """Answer to a change, for people and for programs."""

    code: int
    text: str
    robot: str
    done: bool | None = None
    """None: nobody has answered."""
    name: str = ""
    """Name of the place or line."""


def set_places(robot: str | None, connect: Sequence[str], change: PlaceChange, *, as_json: bool) -> int:
    """Ask for a change; the exit code."""

    def act(connection: RobotConnection) -> int:
        result = ask(connection, change, _PATIENCE)
        if as_json:
            print_json(result._asdict())
        elif result.code:
            print_error(result.text)
        else:
            print(printable(result.text), flush=True)
        return result.code

    return run_with_robot(robot, connect, act, moves=True)


def ask(connection: RobotConnection, change: PlaceChange, timeout: float) -> Result:
    """Ask until giraff_places answers."""
    robot = connection.robot
    request = PlacesSet(by=user_at_host(), id=secrets.randbits(63), change=change)
    asking = QueryClient(connection.session, robot, PLACES_SET, request)
    answer = asking.wait(time.monotonic() + timeout)
    if answer is None:
        told = asking.not_confirmed(timeout, _CHECK) + others(connection.session, robot)
        return Result(UNANSWERED, told, robot)
    if not answer.done:
        return Result(REFUSED, f"places of {robot} refuses: {answer.reason}", robot, done=False)
    return Result(DONE, f"{robot}: {_said(change, answer.name)}", robot, done=True, name=answer.name)


def _said(change: PlaceChange, name: str) -> str:
    match change:
        case PlaceAdd(pose=pose):
            return f"{name} is {'where the robot is' if pose is None else f'at {place_text(pose.x, pose.y, pose.yaw)}'}"
        case PlaceRemove():
            return f"{name} is removed"
        case _:
            return f"{name} is a line that no route crosses"


def show(robot: str | None, connect: Sequence[str], *, as_json: bool) -> int:
    """Show all places and lines; the exit code."""

    def act(connection: RobotConnection) -> int:
        if (places := next_places(connection, _PATIENCE)) is None:
            there = others(connection.session, connection.robot)
            return print_error(f"no places of {connection.robot} are heard for {_PATIENCE:g} s; {_CHECK}{there}")
        if as_json:
            print_json({"robot": connection.robot, **msgspec.to_builtins(places)})
        else:
            print_places(connection.robot, places)
        return DONE

    return run_with_robot(robot, connect, act)


def next_places(connection: RobotConnection, seconds: float) -> Places | None:
    """Return the places as they are told next. None: they are not, for so long."""
    connection.subscribe(PLACES)
    heard, until = LatestSamples(), time.monotonic() + seconds
    while time.monotonic() < until:
        connection.dispatch(heard)
        if (newest := heard.latest(PLACES, robot_now_ns())) is not None:
            return newest.sample
        time.sleep(_TURN)
    return None


def print_places(robot: str, places: Places) -> None:
    """Print the plan's name, a row for each place and line, and why they do not count."""
    print(printable(f"{robot}: {f'floor plan {places.map}' if places.map else 'no floor plan'}"), flush=True)
    rows = [(place.name, place_text(place.x, place.y, place.yaw)) for place in places.places]
    rows += [
        (line.name, f"no-go line from {line.x:z.2f},{line.y:z.2f} to {line.end_x:z.2f},{line.end_y:z.2f} m")
        for line in places.no_go
    ]
    if rows:
        print_table(("", ""), rows)
    elif not places.reason:
        print("no places yet; `giraff place add NAME` gives one to where the robot is")
    if places.reason:
        print(printable(f"they do not count now: {places.reason}"), flush=True)
